// Virtual reality at the helm (WebXR): the head stands where the helm's eye is, and turns with the ship.
//
// Where a motion platform carries the viewer, trackers see its motion as the head's, and the sea would move twice. With
// "the viewer rides the platform" its pose is taken off: head in the room = platform x head on it, so what is drawn with
// is platform^-1 x head. The origin of the headset's space must be the platform's reference point at neutral.
const XR = {
  // The platform's pose (X forward, Y left, Z up; Rz Ry Rx) as a matrix in the headset's axes (x right, y up, -z ahead).
  platform([x, y, z, roll, pitch, yaw]) {
    const turn = (axis, angle) => { const h = 0.5 * angle; return [Math.cos(h), ...V.scale(axis, Math.sin(h))]; };
    const ahead = [0, 0, -1], left = [-1, 0, 0], up = [0, 1, 0];
    const about = (axis, angle) => M.pose(turn(axis, angle), [0, 0, 0]);
    const m = M.mul(M.mul(about(up, yaw), about(left, pitch)), about(ahead, roll)), at = V.add(V.add(V.scale(ahead, x), V.scale(left, y)), V.scale(up, z));
    [m[12], m[13], m[14]] = at;
    return m;
  },

  // From the headset's space to the world: at the helm, ahead towards the bow, level as the ship is.
  space(pose, helm, carried) {
    const back = [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, ...helm, 1];  // half a turn: its -z is the bow
    return M.mul(M.mul(pose, back), carried ? M.inverse(carried) : M.one());
  },

  async offer(begin) {
    if (!navigator.xr || !(await navigator.xr.isSessionSupported("immersive-vr").catch(() => false))) return;
    $("vr").hidden = false;
    $("vr").onclick = () => this.start(begin).catch((error) => say(`virtual reality: ${error.message}`, true));
  },

  async start(show) {
    const session = await navigator.xr.requestSession("immersive-vr", { optionalFeatures: ["local-floor"] });
    await gl.makeXRCompatible();
    const layer = new XRWebGLLayer(session, gl);
    session.updateRenderState({ baseLayer: layer, depthNear: 0.08, depthFar: 30000 });
    const space = await session.requestReferenceSpace("local");
    this.session = session;
    session.addEventListener("end", () => { this.session = null; state.dirty = true; });
    const frame = (now, moment) => {
      session.requestAnimationFrame(frame);
      const viewer = moment.getViewerPose(space), world = state.worlds[0];
      if (!viewer || !world?.ships.length || !world.after) return;
      show(now);
      this.steer(session, now);
      const ship = world.ships[camera.ship] || world.ships[0], carried = state.rides && world.legs ? this.platform(world.legs) : null;
      const from = this.space(ship.pose, ship.helm, carried);
      gl.bindFramebuffer(gl.FRAMEBUFFER, layer.framebuffer);
      gl.disable(gl.SCISSOR_TEST);
      gl.clear(gl.DEPTH_BUFFER_BIT | gl.COLOR_BUFFER_BIT);
      for (const view of viewer.views) {
        const box = layer.getViewport(view), eye = M.mul(from, [...view.transform.matrix]), projection = [...view.projectionMatrix];
        gl.viewport(box.x, box.y, box.width, box.height);
        world.draw({
          position: eye.slice(12, 15), view: M.inverse(eye), projection, framebuffer: layer.framebuffer,
          angle: 2 * Math.atan(1 / projection[5]), pixels: box.height, width: box.width,
        }, state.content, { lines: state.lines, mirror: false });
      }
      this.eye = from;
      this.drawn = (this.drawn || 0) + 1;
    };
    session.requestAnimationFrame(frame);
  },

  // Sticks or pads: throttle forward and back, wheel left and right.
  steer(session, now) {
    const seconds = Math.min((now - (this.before || now)) / 1000, 0.1);
    this.before = now;
    let ahead = 0, port = 0;
    for (const source of session.inputSources || []) {
      const axes = source.gamepad?.axes || [], [x, y] = axes.length >= 4 ? [axes[2], axes[3]] : axes;
      if (source.handedness === "left") port -= Math.abs(x) > 0.15 ? x : 0;
      else ahead -= Math.abs(y) > 0.15 ? y : 0;
    }
    if (ahead || port) steer(state.throttle + 0.7 * seconds * ahead, state.rudder + 0.5 * seconds * port);
  },
};
