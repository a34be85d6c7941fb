// Where the eye is: around the basin, around a ship, at the helm, or above.
const OUTSIDE = (35 * Math.PI) / 180, HELM = (62 * Math.PI) / 180;
const TURN_SECONDS = 0.8, QUARTER = 0.5;  // in which a camera turns after a ship; how far it stands off her stern

class Camera {
  constructor() {
    this.mode = "orbit";
    this.ship = 0;
    this.reset();
  }

  // Look at another world: over a sea off a bow of its ship, on the side where the sun's glint hides less of the water.
  face(world, sun) {
    const m = world.ships[0]?.pose, heading = m ? Math.atan2(m[8], m[10]) : 0, bright = Math.atan2(sun[0], sun[2]);
    const sides = [heading + 0.75, heading - 0.75].sort((a, b) => Math.cos(b - bright) - Math.cos(a - bright));
    this.home = world.sea ? sides[0] : 0.66;
    this.reset();
  }

  reset() {
    Object.assign(this, { azimuth: this.home ?? 0.66, facing: 0, height: 0.34, distance: 1, shift: [0, 0, 0], turn: 0, tilt: 0 });
  }

  drag(right, up) {
    if (this.mode === "helm") {
      this.turn = clamp(this.turn - 1.6 * right, -2.8, 2.8);
      this.tilt = clamp(this.tilt + 1.2 * up, -0.7, 0.7);
    } else {
      this.azimuth -= 3.2 * right;
      this.height = clamp(this.height + 2.2 * up, 0.03, 1.5);
    }
  }

  pan(right, up) {
    const s = Math.sin(this.facing), c = Math.cos(this.facing), reach = this.far || 10;
    this.shift = V.add(this.shift, V.scale([-c * right - s * up, 0, s * right - c * up], reach));
  }

  nearer(factor) { this.distance = clamp(this.distance * factor, 0.08, 6); }

  modes(world) {
    const flat = world.still.basin.flat;
    return flat ? ["orbit", "side"] : ["orbit", ...(world.ships.length ? ["follow"] : []), ...(world.ships.some((ship) => ship.steered) ? ["helm"] : []), "top", "side"];
  }

  // {position, view, projection, angle, pixels, width}; `free`: the shares of width and height that no panel hides.
  eye(world, width, height, free) {
    world.turning = false;  // whether the camera still turns after a ship
    const aspect = width / height, ship = world.ships[this.ship] || world.ships[0], pose = ship && world.poses[world.ships.indexOf(ship)];
    let mode = this.modes(world).includes(this.mode) ? this.mode : "orbit";
    if (mode === "helm" && pose && ship.steered) return this.helm(ship, width, height, free);
    const { size } = world, long = Math.max(size[0], size[2]), across = mode === "side" && !world.sea, follow = ["follow", "side"].includes(mode) && pose && !across;  // a tank is seen whole from its side
    let target = V.add(world.middleOf, [0, world.level, 0]), span = (world.sea ? 1 : 0.92) * Math.hypot(size[0], size[2] || world.ribbon);
    if (world.still.basin.flat) { span = Math.max(0.9 * size[0], -1.6 * world.bed); target[1] += 0.35 * world.bed; }
    const wide = world.sea && ship && long > 5 * ship.length && pose;
    if (follow || wide) {
      target = [pose.position[0], world.level + 0.08 * ship.length, pose.position[2]];
      span = (follow ? 2.6 : 4.5) * ship.length;
    }
    let azimuth = this.azimuth, rise = this.height;
    if (follow) {
      const m = ship.pose, heading = Math.atan2(m[8], m[10]);
      const last = world.heading ?? heading, now = performance.now() / 1000, behind = Math.atan2(Math.sin(heading - last), Math.cos(heading - last));
      world.heading = last + (1 - Math.exp(((world.turned ?? now) - now) / TURN_SECONDS)) * behind;
      world.turned = now;
      world.turning = Math.abs(behind) > 0.01;
      azimuth += world.heading + Math.PI - (this.home ?? 0.66) + QUARTER;
    }
    if (mode === "side") { azimuth = follow ? world.heading - 0.5 * Math.PI : size[0] < size[2] ? 0.5 * Math.PI : 0; rise = across ? 0.15 : 0.05; }
    const angle = aspect < 0.8 ? OUTSIDE * 1.35 : OUTSIDE, fit = Math.max(1, 1.12 / (aspect * free[0]), 0.8 / free[1]);
    const far = ((0.62 * span) / Math.tan(angle / 2)) * this.distance * Math.min(fit, follow || wide ? 2 : 3) * (mode === "top" ? 1.05 : 0.86);
    this.far = far;
    target = V.add(target, this.shift);
    let up = [0, 1, 0], towards;
    this.facing = azimuth;
    if (mode === "top") {  // over a sea as on a chart: north is up
      this.facing = world.sea ? Math.PI : 0;
      towards = [0, 1, 0];
      up = [0, 0, -Math.cos(this.facing)];
    } else {
      const flat = Math.cos(rise);
      towards = [flat * Math.sin(azimuth), Math.sin(rise), flat * Math.cos(azimuth)];
    }
    let position = V.add(target, V.scale(towards, far));
    const floor = world.heightAt(position[0], position[2]) + 0.35;
    if (world.sea && position[1] < floor) position[1] = floor;
    return {
      position, target, angle, width, pixels: height, view: M.look(position, target, up),
      projection: M.perspective(angle, aspect, Math.max(0.004 * far, 0.05), 30000),
    };
  }

  helm(ship, width, height, free) {
    const m = ship.pose, position = M.point(m, ship.helm), c = Math.cos(this.turn), s = Math.sin(this.turn);
    const ahead = M.turn(m, V.unit([s, -0.06 + Math.tan(this.tilt), c])), up = M.turn(m, [0, 1, 0]);
    const angle = 2 * Math.atan(Math.tan(0.5 * (width < height ? HELM * 1.2 : HELM)) * clamp(0.8 / free[1], 1, 3));  // the wheel is over the bars
    return {
      position, target: V.add(position, ahead), angle, width, pixels: height, view: M.look(position, V.add(position, ahead), up),
      projection: M.perspective(angle, width / height, 0.08, 30000),
    };
  }

  // Where a point of the picture (x, y from -1 to 1) meets the still water; null above the horizon.
  hit(eye, x, y, level) {
    const back = M.inverse(M.mul(eye.projection, eye.view)), w = (z) => back[3] * x + back[7] * y + back[11] * z + back[15];
    const near = V.scale(M.point(back, [x, y, -1]), 1 / w(-1)), far = V.scale(M.point(back, [x, y, 1]), 1 / w(1));
    const d = V.sub(far, near), s = (level - near[1]) / d[1];
    return s > 0 && s <= 1 ? V.add(near, V.scale(d, s)) : null;
  }
}
