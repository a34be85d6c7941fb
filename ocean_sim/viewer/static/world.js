const WHEEL_TURN = 130 / 35;  // angle of the wheel over that of the rudder: less than half a turn, so that its mark tells the side
const WAKE_SECONDS = 40;  // after which white water behind a ship is gone

// Distance from a hull's waterline at rest [m], negative inside, at a place in her axes, between the nodes of its map.
function gapAt({ near, far, map, shape: [cells] }, x, z) {
  const u = ((x - near[0]) / (far[0] - near[0])) * cells - 0.5, v = ((z - near[1]) / (far[1] - near[1])) * cells - 0.5;
  const a = clamp(Math.floor(u), 0, cells - 2), b = clamp(Math.floor(v), 0, cells - 2), p = clamp(u - a, 0, 1), q = clamp(v - b, 0, 1), o = b * cells + a;
  return (map[o] * (1 - p) + map[o + 1] * p) * (1 - q) + (map[o + cells] * (1 - p) + map[o + cells + 1] * p) * q;
}

// One simulation as it is drawn: what never changes is made once, two moments are held, and what lies between is shown.
class World {
  constructor(gl, painter, still) {
    Object.assign(this, { gl, painter, still });
    this.programs = painter.water(still);
    const { nx, nz, step, first } = still.tile, { lower, upper } = still.basin;
    this.size = V.sub(upper, lower);
    this.nx = nx;
    this.nz = Math.max(nz, 2);  // a slice is shown as a ribbon
    this.ribbon = still.basin.flat ? Math.max(0.06 * this.size[0], 2 * still.spacing) : 0;
    this.step = [step[0], nz > 1 ? step[1] : this.ribbon];
    this.first = [first[0], nz > 1 ? first[1] : -0.5 * this.ribbon];
    this.middle = [0, 1].map((k) => this.first[k] + 0.5 * this.step[k] * ([this.nx, this.nz][k] - 1));
    this.reach = [0.5 * this.step[0] * this.nx, nz > 1 ? 0.5 * this.step[1] * this.nz : 0.5 * this.ribbon];
    this.bed = lower[1];
    this.sea = !still.tank;  // whether water goes on around the basin
    this.level = 0;
    this.height = 0.2;  // significant, smoothed [m]
    this.heights = new Float32Array(this.nx * this.nz);
    this.foam = new Float32Array(this.nx * this.nz);
    this.both = new Float32Array(2 * this.nx * this.nz);
    this.tile = texture(gl, 1, gl.NEAREST);
    this.gaps = texture(gl, 2, gl.LINEAR);
    this.mirror = texture(gl, 3, gl.LINEAR_MIPMAP_LINEAR);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 1, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    this.cell = (2 * this.reach[0]) / this.nx;
    this.surfaces = { tank: this.mesh(false), sea: still.basin.flat ? null : this.mesh(true) };
    this.sides();
    this.ground = still.data.ground ? shape(gl, [still.data.ground, still.data.ground_normals]) : null;
    this.floor = array(gl, [[0, buffer(gl, still.data.floor), 3]]);
    this.ships = still.ships.map((ship, k) => this.model(ship, k));
    this.gapMap = new Float32Array(96 * 96 * Math.max(this.ships.length, 1)).fill(9);
    this.balls = this.particles();
    this.lines = { count: 0, ends: gl.createBuffer(), hues: gl.createBuffer() };
    this.lines.vertices = array(gl, [[0, this.lines.ends, 3], [1, this.lines.hues, 3, gl.UNSIGNED_BYTE, true]]);
    this.spray = { count: 0, ends: gl.createBuffer() };
    this.spray.vertices = array(gl, [[0, this.spray.ends, 3]]);
    this.wakes = this.ships.map(() => ({ trail: [], points: gl.createBuffer() }));
    for (const wake of this.wakes) wake.vertices = array(gl, [[0, wake.points, 4]]);
    this.drawnFrom = [0, 0];  // origin of the foam [m]
    this.route = [];
    this.before = this.after = null;
    this.share = 0;
    this.poses = [];
    this.origin = [0, 0];
    this.time = 0;
  }

  mesh(sea) {
    const { gl } = this, quality = Math.min(2.6, 190 / Math.max(this.nx, this.nz)), sides = [0, 1].map((k) => {
      const n = Math.round(clamp(quality * [this.nx, this.nz][k], 16, 256)), low = this.middle[k] - this.reach[k];
      const inner = Array.from({ length: n + 1 }, (_, i) => low + (2 * this.reach[k] * i) / n);
      if (!sea) return inner;
      const beyond = [];
      for (let step = inner[1] - inner[0], d = 0; d < OUT;) {
        step *= d < this.reach[k] ? 1.04 : 1.1;
        d += step;
        beyond.push(d);
      }
      return [...beyond.map((d) => inner[0] - d).reverse(), ...inner, ...beyond.map((d) => inner[n] + d)];
    });
    const [xs, zs] = sides, nodes = new Float32Array(2 * xs.length * zs.length), triangles = [];
    xs.forEach((x, i) => zs.forEach((z, j) => nodes.set([x, z], 2 * (i * zs.length + j))));
    for (let i = 0; i + 1 < xs.length; i++) for (let j = 0; j + 1 < zs.length; j++) {
      const a = i * zs.length + j, b = a + zs.length;
      triangles.push(a, a + 1, b, b, a + 1, b + 1);
    }
    const indices = buffer(gl, new Uint32Array(triangles), gl.ELEMENT_ARRAY_BUFFER);
    return { vertices: array(gl, [[0, buffer(gl, nodes), 2]], indices), count: triangles.length };
  }

  sides() {
    const { gl } = this, n = 96, rows = 6, nodes = [];
    const low = [0, 1].map((k) => this.middle[k] - this.reach[k]), high = [0, 1].map((k) => this.middle[k] + this.reach[k]);
    const rims = [[low, [high[0], low[1]]], [[high[0], low[1]], high], [high, [low[0], high[1]]], [[low[0], high[1]], low]];
    for (const [a, b] of rims) for (let i = 0; i < n; i++) for (let j = 0; j < rows; j++) {
      const at = (s, d) => [a[0] + (b[0] - a[0]) * s, a[1] + (b[1] - a[1]) * s, d];
      const [s, t] = [i / n, (i + 1) / n], [d, e] = [j / rows, (j + 1) / rows];
      nodes.push(...at(s, d), ...at(t, d), ...at(t, e), ...at(s, d), ...at(t, e), ...at(s, e));
    }
    this.wall = array(gl, [[0, buffer(gl, new Float32Array(nodes)), 3]]);
    this.wallCount = nodes.length / 3;
  }

  model(ship, k) {
    const { gl, still } = this, about = still.about[`corners${k}`];
    const thin = slender(still.data[`corners${k}`], V.scale(V.sub(about.high, about.low), 0.5 / 32767), 0.15 * ship.length);
    const vertices = array(gl, [
      [3, buffer(gl, thin), 1], [0, buffer(gl, still.data[`corners${k}`]), 3, gl.SHORT, true],
      [1, buffer(gl, still.data[`normals${k}`]), 3, gl.BYTE, true],
      [2, buffer(gl, still.data[`paint${k}`]), 4, gl.UNSIGNED_BYTE, true],
    ]);
    const gap = still.data[`gap${k}`] && { ...still.about[`gap${k}`], map: still.data[`gap${k}`] };
    return { ...ship, vertices, count: about.shape[0], low: about.low, high: about.high, gap, pose: M.one(), box: null };
  }

  particles() {
    const { gl } = this, made = { before: gl.createBuffer(), after: gl.createBuffer(), speed: gl.createBuffer(), count: 0 };
    made.vertices = array(gl, [
      [0, made.before, 3, gl.SHORT, true], [1, made.after, 3, gl.SHORT, true], [2, made.speed, 1, gl.UNSIGNED_BYTE, true],
    ]);
    return made;
  }

  get middleOf() {
    const { lower, upper } = this.still.basin;
    return [0.5 * (lower[0] + upper[0]), 0, 0.5 * (lower[2] + upper[2])];
  }

  // Two moments, and how far it is from the first to the second.
  show(before, after, share) {
    const fresh = before !== this.before || after !== this.after;
    if (fresh) this.take(before, after);
    this.share = share;
    this.time = before.time + (after.time - before.time) * share;
    this.origin = share < 0.5 ? before.origin : after.origin;
    const a = before.data.poses, b = after.data.poses;
    if (a && b) {
      this.poses = this.ships.map((_, k) => {
        const p = [...a.subarray(7 * k, 7 * k + 7)], q = [...b.subarray(7 * k, 7 * k + 7)];
        return { position: V.mix(p.slice(0, 3), q.slice(0, 3), share), turn: Q.mix(p.slice(3), q.slice(3), share) };
      });
      this.ships.forEach((ship, k) => { ship.pose = M.pose(this.poses[k].turn, this.poses[k].position); });
    }
    this.blend();
    const legs = after.data.platform, past = before.data.platform;
    this.legs = legs && past ? Array.from(legs, (v, k) => past[k] + (v - past[k]) * share) : null;
  }

  take(before, after) {
    const { gl } = this, balls = this.balls;
    if (after.data.lines) {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.lines.ends);
      gl.bufferData(gl.ARRAY_BUFFER, after.data.lines, gl.DYNAMIC_DRAW);
      gl.bindBuffer(gl.ARRAY_BUFFER, this.lines.hues);
      const hues = new Uint8Array(2 * after.data.hues.length);
      for (let k = 0; k < after.data.hues.length / 3; k++) {
        hues.set(after.data.hues.subarray(3 * k, 3 * k + 3), 6 * k);
        hues.set(after.data.hues.subarray(3 * k, 3 * k + 3), 6 * k + 3);
      }
      gl.bufferData(gl.ARRAY_BUFFER, hues, gl.DYNAMIC_DRAW);
      this.lines.count = after.data.lines.length / 3;
    }
    const p = before.data.particles, q = after.data.particles;
    if (p && q) {
      balls.count = Math.min(p.length, q.length) / 3;
      gl.bindBuffer(gl.ARRAY_BUFFER, balls.before);
      gl.bufferData(gl.ARRAY_BUFFER, p, gl.DYNAMIC_DRAW);
      gl.bindBuffer(gl.ARRAY_BUFFER, balls.after);
      gl.bufferData(gl.ARRAY_BUFFER, q, gl.DYNAMIC_DRAW);
      gl.bindBuffer(gl.ARRAY_BUFFER, balls.speed);
      gl.bufferData(gl.ARRAY_BUFFER, after.data.speed, gl.DYNAMIC_DRAW);
      const box = after.about.particles;
      Object.assign(balls, { low: box.low, high: box.high, fastest: after.fastest });
    }
    if (after.data.height) this.whiten(after);
    this.before = before;
    this.after = after;
  }

  // Where the sterns of the ships are at a time, for their wakes; times grow.
  follow(time, poses, keep) {
    this.wakes.forEach(({ trail }, k) => {
      const [x, , z, ...turn] = poses.subarray(7 * k, 7 * k + 7), m = M.pose(turn, [0, 0, 0]), n = Math.hypot(m[8], m[10]) || 1;
      const half = 0.46 * this.ships[k].length, here = { time, x: x - (half * m[8]) / n, z: z - (half * m[10]) / n, speed: 0 }, last = trail[trail.length - 1];
      const way = last ? Math.hypot(here.x - last.x, here.z - last.z) : 0;
      if (last && way < 0.2 * this.ships[k].beam) return;
      if (last) here.speed = ((here.x - last.x) * m[8] + (here.z - last.z) * m[10]) / n / Math.max(time - last.time, 1e-6);  // ahead
      trail.push(here);
      while (trail[0].time < time - keep) trail.shift();
    });
  }

  // Rows of time and poses from before this page was open: once, for wakes.
  recall(rows, [count, width]) {
    if (this.wakes.some(({ trail }) => trail.length)) return;
    for (let k = 0; k < count; k++) this.follow(rows[k * width], rows.subarray(k * width + 1, (k + 1) * width), WAKE_SECONDS + HISTORY_SECONDS);
  }

  // Foam as the simulation knows it, else where a crest is as steep as one that breaks: there it appears at once, then it fades.
  whiten(after) {
    const { nx, nz, foam } = this, h = after.data.height, flat = this.still.basin.flat, known = after.data.foam;
    const past = this.before ? Math.abs(after.time - this.before.time) : 0, fade = Math.exp(-Math.min(past, 1) / 1.6);
    let sum = 0, squares = 0;
    for (let k = 0; k < h.length; k++) { sum += h[k]; squares += h[k] * h[k]; }
    const mean = sum / h.length, now = 4 * Math.sqrt(Math.max(squares / h.length - mean * mean, 0));
    this.level = this.still.sea.exact ? 0 : mean;
    this.height += (now - this.height) * (this.before ? 0.08 : 1);
    if (flat || this.still.tank) { foam.fill(0); return; }
    if (known) { foam.forEach((_, k) => { foam[k] = known[k] / 255; }); return; }
    this.carry(after.origin);
    const dx = 1 / this.step[0] ** 2, dz = 1 / this.step[1] ** 2;
    for (let i = 0; i < nx; i++) for (let j = 0; j < nz; j++) {
      const k = i * nz + j;
      const curve = (h[k] * 2 - h[Math.max(i - 1, 0) * nz + j] - h[Math.min(i + 1, nx - 1) * nz + j]) * dx +
        (h[k] * 2 - h[i * nz + Math.max(j - 1, 0)] - h[i * nz + Math.min(j + 1, nz - 1)]) * dz;
      const steep = h[k] > mean && curve > 0 ? Math.sqrt(curve * (h[k] - mean)) : 0;  // k a of a sine
      foam[k] = Math.max(foam[k] * fade, clamp(2.2 * (steep - 0.42), 0, 0.5));
    }
  }

  // Keep the foam in its place in the world where the middle of the heights has gone on by whole cells.
  carry(origin) {
    const { nx, nz, foam } = this, [di, dj] = [0, 1].map((k) => Math.round((origin[k] - this.drawnFrom[k]) / this.step[k]));
    this.drawnFrom = origin;
    if (!di && !dj) return;
    const old = foam.slice();
    for (let i = 0; i < nx; i++) for (let j = 0; j < nz; j++) {
      const a = i + di, b = j + dj;
      foam[i * nz + j] = a >= 0 && a < nx && b >= 0 && b < nz ? old[a * nz + b] : 0;
    }
  }

  blend() {
    const { gl, heights, both, foam } = this, a = this.before.data.height, b = this.after.data.height, s = this.share;
    if (a && b) {
      const flat = this.still.basin.flat;
      for (let k = 0; k < heights.length; k++) {
        const i = flat ? k >> 1 : k;
        heights[k] = a[i] + (b[i] - a[i]) * s;
      }
      if (!flat && !this.still.sea.exact) this.ships.forEach((ship, k) => this.levelHull(ship, this.poses[k]));
      for (let k = 0; k < heights.length; k++) {
        both[2 * k] = heights[k];
        both[2 * k + 1] = foam[k];
      }
    }
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.tile);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RG32F, this.nz, this.nx, 0, gl.RG, gl.FLOAT, both);
  }

  // Under a hull heights of particles follow her bottom: draw those around her on instead, so that she cuts a clean line.
  levelHull({ gap, pose, length }, at) {
    if (!gap || !at) return;
    const { nx, nz, heights, step, first, origin } = this, heading = Math.atan2(pose[8], pose[10]), c = Math.cos(heading), s = Math.sin(heading);
    const [mx, mz] = [0, 1].map((k) => (at.position[2 * k] - origin[k] - first[k]) / step[k]), hidden = new Set();
    const [rx, rz] = step.map((one) => length / one);
    for (let i = Math.max(0, Math.ceil(mx - rx)); i < Math.min(nx, mx + rx); i++) for (let j = Math.max(0, Math.ceil(mz - rz)); j < Math.min(nz, mz + rz); j++) {
      const x = (i - mx) * step[0], z = (j - mz) * step[1];
      if (gapAt(gap, c * x - s * z, s * x + c * z) < 1.25 * step[0]) hidden.add(i * nz + j);
    }
    while (hidden.size) {  // ring by ring, from outside
      const known = [...hidden].flatMap((k) => {
        const beside = [[k - nz, k >= nz], [k + nz, k + nz < nx * nz], [k - 1, k % nz], [k + 1, (k + 1) % nz]];
        const all = beside.filter(([one, there]) => there && !hidden.has(one)).map(([one]) => heights[one]);
        return all.length ? [[k, all.reduce((sum, h) => sum + h) / all.length]] : [];
      });
      if (!known.length) return;
      for (const [k, height] of known) {
        heights[k] = height;
        hidden.delete(k);
      }
    }
  }

  // Height of the water at a place [m].
  heightAt(x, z) {
    const q = [(x - this.origin[0] - this.first[0]) / this.step[0], (z - this.origin[1] - this.first[1]) / this.step[1]];
    const i = clamp(q[0], 0, this.nx - 1.001), j = clamp(q[1], 0, this.nz - 1.001), a = Math.floor(i), b = Math.floor(j);
    const at = (m, n) => this.heights[m * this.nz + n], s = i - a, t = j - b;
    return (at(a, b) * (1 - s) + at(a + 1, b) * s) * (1 - t) + (at(a, b + 1) * (1 - s) + at(a + 1, b + 1) * s) * t;
  }

  // Height of the water around a ship [m], the mean of a ring.
  levelAround(k) {
    const { beam, length, pose } = this.ships[k], [x, , z] = this.poses[k].position, c = pose[10], s = pose[8], n = 12;
    const heights = Array.from({ length: n }, (_, i) => {
      const a = (0.6 * beam + 3 * this.step[0]) * Math.cos((2 * Math.PI * i) / n), b = (0.6 * length + 3 * this.step[0]) * Math.sin((2 * Math.PI * i) / n);
      return this.heightAt(x + c * a + s * b, z - s * a + c * b);
    });
    return heights.reduce((sum, h) => sum + h, 0) / n;
  }

  // The maps of distances to the hulls, turned from body to world.
  meet() {
    const n = 96, values = {};
    this.ships.forEach((ship, k) => {
      values[`useHull${k}`] = 0;
      if (!ship.gap || !this.poses[k]) return;
      const { near, far } = ship.gap, m = ship.pose, heading = Math.atan2(m[8], m[10]);
      const c = Math.cos(heading), s = Math.sin(heading), at = this.poses[k].position;
      const corners = [[near[0], near[1]], [far[0], near[1]], far, [near[0], far[1]]].map(([x, z]) => [c * x + s * z, -s * x + c * z]);
      const low = [0, 1].map((a) => Math.min(...corners.map((p) => p[a]))), high = [0, 1].map((a) => Math.max(...corners.map((p) => p[a])));
      for (let j = 0; j < n; j++) for (let i = 0; i < n; i++) {
        const x = low[0] + ((i + 0.5) / n) * (high[0] - low[0]), z = low[1] + ((j + 0.5) / n) * (high[1] - low[1]);
        this.gapMap[(k * n + j) * n + i] = gapAt(ship.gap, c * x - s * z, s * x + c * z);
      }
      values[`useHull${k}`] = 1;
      values[`hullBox${k}`] = [low[0] + at[0], low[1] + at[2], 0];
      values[`hullSize${k}`] = [high[0] - low[0], high[1] - low[1], 1];
      values[`mirrorAt${k}`] = at;
      values[`mirrorSize${k}`] = 0.5 * ship.beam;
      values[`mirrorReach${k}`] = ship.length;
    });
    const { gl } = this;
    gl.activeTexture(gl.TEXTURE2);
    gl.bindTexture(gl.TEXTURE_2D, this.gaps);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.R16F, n, n * Math.max(this.ships.length, 1), 0, gl.RED, gl.FLOAT, this.gapMap);
    return values;
  }

  // Draw into the viewport that is set. `eye`: {position, view, projection, angle, pixels}; `content`: water, particles or both.
  draw(eye, content, options) {
    const { gl, painter, still } = this, view = M.mul(eye.projection, eye.view), lit = { ...painter.sky.lit, ...still.light };
    if (!this.after) return;
    const water = content !== "particles" && still.surface, sea = this.sea && content === "water" && water, pixel = (2 * Math.tan(eye.angle / 2)) / eye.pixels;
    const mirrored = options.mirror && water && this.ships.length ? this.reflect(eye, lit) : null;
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, painter.sky.texture);
    const uniforms = { ...still.uniforms, ...painter.sky.lit, eyeW: eye.position, time: this.time, pixel, sky: 0, hull: 2, mirror: 3, haze: 4 };
    const turned = [...eye.view];
    turned[12] = turned[13] = turned[14] = 0;
    const back = M.inverse(M.mul(eye.projection, turned));
    gl.depthMask(false);
    this.programs.dome.use({ ...uniforms, useFog: 1, eyeW: [0, 0, 0], back, studio: sea ? 0 : 1, ground: options.light ? [0.74, 0.80, 0.85] : [0.15, 0.20, 0.26] });
    gl.bindVertexArray(painter.empty);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    if (!sea) this.drawFloor(view);
    gl.depthMask(true);
    this.solids(view, lit);
    if (content !== "water") this.drawBalls(view, eye, content === "both");
    for (const ship of this.ships) this.drawShip(ship, view, lit, -1e9, pixel);
    if (options.helm) this.drawWheelhouse(options.helm, view, lit);
    if (water) this.drawWater(view, uniforms, content === "both", sea, mirrored, pixel);
    if (water && content === "water") this.drawWakes(view);
    if (still.zones.length) this.drawZones(view, lit);
    if (options.lines) this.drawLines(view, sea);
    if (water && this.before.data.drops) this.drawDrops(view);
    gl.bindVertexArray(null);
  }

  // The shadow of the basin, and lines around it.
  drawFloor(view) {
    const { gl, still, floor } = this;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    this.programs.floor.use({ view, boxLow: still.basin.lower, boxHigh: still.basin.upper, apart: still.floorLines });
    gl.bindVertexArray(floor);
    gl.drawArrays(gl.TRIANGLES, 0, 6);
    gl.disable(gl.BLEND);
  }

  drawWater(view, uniforms, thin, sea, mirrored, pixel) {
    const { gl, still, painter } = this;
    const known = { tile: 1, tileFirst: this.first, tileStep: this.step, tileSize: [this.nx, this.nz], origin: this.origin, reach: this.reach };
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.tile);
    const hulls = this.meet();
    gl.activeTexture(gl.TEXTURE3);
    gl.bindTexture(gl.TEXTURE_2D, this.mirror);
    if (mirrored) Object.assign(hulls, { useMirror: 1, mirrorView: mirrored, mirrorPixel: (still.tank ? 16 : 2) * pixel });
    const { waves, exact, ramp } = still.sea, size = exact ? (ramp > 0 ? Math.min(this.time / ramp, 1) : 1) : Math.max(this.height, 0.02);
    const flat = waves.flatMap(([a, kx, kz, omega, phase]) => [a * size, kx, kz, (phase - omega * this.time) % (2 * Math.PI)]);
    gl.enable(gl.BLEND);
    if (!sea) {  // the cut sides
      gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
      gl.depthMask(!thin);
      painter.side.use({ ...known, view, bed: this.bed, alpha: thin ? 0.22 : 1 });
      gl.bindVertexArray(this.wall);
      gl.drawArrays(gl.TRIANGLES, 0, this.wallCount);
    }
    gl.blendColor(0, 0, 0, thin ? 0.42 : 1);
    gl.blendFunc(gl.CONSTANT_ALPHA, gl.ONE_MINUS_CONSTANT_ALPHA);
    this.programs.water.use({
      ...uniforms, ...hulls, ...known, view, waves: flat, waveCount: waves.length, farShare: sea ? 1 : 0, level: this.level,
      crest: Math.max(0.5 * this.height, 0.02), cell: this.cell, margin: Math.min(...this.reach),
      useFog: sea ? 1 : 0, rough: still.tank ? 0.02 : 0,  // of slopes: a tank mirrors the sky without clouds, but sharp ships
    });
    const surface = this.surfaces[sea ? "sea" : "tank"];
    gl.bindVertexArray(surface.vertices);
    gl.drawElements(gl.TRIANGLES, surface.count, gl.UNSIGNED_INT, 0);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  drawShip(ship, view, lit, above, pixel) {
    const { gl, painter } = this;
    painter.ship.use({ ...lit, view, pose: ship.pose, low: ship.low, high: ship.high, above, pixel });
    gl.bindVertexArray(ship.vertices);
    gl.drawArrays(gl.TRIANGLES, 0, ship.count);
  }

  // What stands around the eye at the helm: window posts, the edge of the roof, a console, and the wheel as the rudder lies.
  drawWheelhouse({ ship, rudder }, view, lit) {
    const { gl, painter } = this, u = clamp(ship.length / 15, 0.5, 2);
    const draw = (what, pose, paint) => {
      painter.solid.use({ ...lit, view, pose: M.mul(ship.pose, pose), paint });
      gl.bindVertexArray(what.vertices);
      gl.drawArrays(gl.TRIANGLES, 0, what.count);
    };
    const at = (x, y, z) => V.add(ship.helm, [x * u, y * u, z * u]), box = (p, half, paint) => draw(painter.box, sized(at(...p), V.scale(half, u)), paint);
    box([0, -1.12, 1.05], [2.4, 0.5, 0.34], [0.30, 0.33, 0.36, 1]);  // down to the deck
    box([0, 0.80, 0.3], [2.4, 0.09, 1.3], [0.80, 0.81, 0.80, 1]);  // a roof overhead
    for (const x of [-1.9, -0.7, 0.7, 1.9]) draw(painter.rod, along(at(x, -0.75, 1.46), at(0.97 * x, 0.75, 1.25), 0.03 * u), [0.80, 0.81, 0.80, 1]);
    const rim = (k, r) => { const a = (k * Math.PI) / 8 + WHEEL_TURN * rudder; return at(r * Math.sin(a), -0.34 + 0.8 * r * Math.cos(a), 0.86 + 0.5 * r * Math.cos(a)); };
    for (let k = 0; k < 16; k++) {
      draw(painter.rod, along(rim(k, 0.2), rim(k + 1, 0.2), 0.012 * u), [0.52, 0.38, 0.24, 1]);
      if (k % 2 === 0) draw(painter.rod, along(rim(k, 0), rim(k, 0.26), 0.008 * u), [0.52, 0.38, 0.24, 1]);
    }
    draw(painter.rod, along(rim(0, 0.19), rim(0, 0.21), 0.02 * u), [0.95, 0.85, 0.35, 1]);
  }

  // The ships as the water mirrors them, into a texture; the matrix from the world to it.
  reflect(eye, lit) {
    const { gl } = this, width = Math.max(eye.width >> 1, 2), height = Math.max(eye.pixels >> 1, 2);
    if (!this.pool || this.pool.width !== width || this.pool.height !== height) {
      gl.activeTexture(gl.TEXTURE3);
      gl.bindTexture(gl.TEXTURE_2D, this.mirror);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, width, height, 0, gl.RGBA, gl.UNSIGNED_BYTE, null);
      const frame = this.pool ? this.pool.frame : gl.createFramebuffer(), depth = this.pool ? this.pool.depth : gl.createRenderbuffer();
      gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.mirror, 0);
      gl.bindRenderbuffer(gl.RENDERBUFFER, depth);
      gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT16, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth);
      this.pool = { width, height, frame, depth };
    }
    const level = this.levelAround(0);
    const flip = [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 2 * level, 0, 1], view = M.mul(M.mul(eye.projection, eye.view), flip);
    const was = gl.getParameter(gl.VIEWPORT), scissor = gl.isEnabled(gl.SCISSOR_TEST);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.pool.frame);
    gl.disable(gl.SCISSOR_TEST);
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.enable(gl.DEPTH_TEST);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    for (const ship of this.ships) this.drawShip(ship, view, lit, level, (2 * Math.tan(eye.angle / 2)) / height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, eye.framebuffer || null);
    gl.viewport(...was);
    if (scissor) gl.enable(gl.SCISSOR_TEST);
    gl.activeTexture(gl.TEXTURE3);
    gl.bindTexture(gl.TEXTURE_2D, this.mirror);
    gl.generateMipmap(gl.TEXTURE_2D);
    return view;
  }

  drawBalls(view, eye, small) {
    const { gl, painter, balls, still } = this;
    if (!balls.count) return;
    painter.ball.use({
      view, low: balls.low, high: balls.high, share: this.share, radius: (small ? 0.30 : 0.42) * still.spacing,
      scale: (2 * eye.pixels) / (2 * Math.tan(eye.angle / 2)), speeds: still.speeds.flat(),
    });
    gl.bindVertexArray(balls.vertices);
    gl.drawArrays(gl.POINTS, 0, balls.count);
  }

  // Drops of the moment before, each as far on as it flies since, and as long as its way in 1/50 s.
  drawDrops(view) {
    const { gl, painter, spray, before, after, share } = this, d = before.data.drops, ends = [], since = share * (after.time - before.time);
    for (let k = 0; k < d.length && d[k] === d[k]; k += 6) for (const t of [since - 0.01, since + 0.01]) {
      ends.push(before.origin[0] + d[k] + t * d[k + 3], d[k + 1] + t * d[k + 4] - 4.905 * since * since, before.origin[1] + d[k + 2] + t * d[k + 5]);
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, spray.ends);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(ends), gl.DYNAMIC_DRAW);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.bindVertexArray(spray.vertices);
    gl.vertexAttrib3f(1, 0.95, 0.97, 1.0);
    painter.line.use({ view, alpha: 0.7 });
    spray.count = ends.length / 6;
    gl.drawArrays(gl.LINES, 0, 2 * spray.count);
    gl.disable(gl.BLEND);
  }

  // White water behind each ship that moves: a ribbon on the water, wider and fainter with its age.
  drawWakes(view) {
    const { gl, painter } = this;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(-3, -3);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.tile);
    painter.wake.use({ view, tile: 1, tileFirst: this.first, tileStep: this.step, tileSize: [this.nx, this.nz], origin: this.origin, reach: this.reach });
    this.wakes.forEach(({ trail, points, vertices }, k) => {
      const { beam, length, pose } = this.ships[k], m = V.unit([pose[8], 0, pose[10]]), at = this.poses[k]?.position;
      const from = trail.findIndex((one) => one.time > this.time - WAKE_SECONDS), to = trail.length ? latest(trail.map((one) => one.time), this.time) : -1;
      if (!at || from < 0 || to - from < 2) return;
      const path = trail.slice(from, to), last = path[path.length - 1];
      path.push({ time: this.time, x: at[0] - 0.46 * length * m[0], z: at[2] - 0.46 * length * m[2], speed: last.speed });
      const rows = path.map((one, i) => {
        const a = path[Math.max(i - 1, 0)], b = path[Math.min(i + 1, path.length - 1)], n = Math.hypot(b.x - a.x, b.z - a.z) || 1;
        const age = (this.time - one.time) / WAKE_SECONDS, half = beam * (0.34 + 0.55 * Math.sqrt(age)), strength = (1 - age) * clamp(one.speed / 3, 0, 1);
        return [-1, -0.5, 0, 0.5, 1].map((s) => [one.x + (s * half * (b.z - a.z)) / n, one.z - (s * half * (b.x - a.x)) / n, s, strength]);
      });
      const nodes = [];
      for (let i = 0; i + 1 < rows.length; i++) for (let j = 0; j < 4; j++) {
        const [a, b, c, d] = [rows[i][j], rows[i][j + 1], rows[i + 1][j], rows[i + 1][j + 1]];
        nodes.push(...a, ...b, ...c, ...c, ...b, ...d);
      }
      gl.bindBuffer(gl.ARRAY_BUFFER, points);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(nodes), gl.DYNAMIC_DRAW);
      gl.bindVertexArray(vertices);
      gl.drawArrays(gl.TRIANGLES, 0, nodes.length / 4);
    });
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  // Lines of wind and basin; the edges of a basin that is a piece of sea are left out.
  drawLines(view, sea) {
    const { gl, painter } = this, edges = sea ? 24 : 0;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    if (this.lines.count > edges) {
      painter.line.use({ view, alpha: 0.85 });
      gl.bindVertexArray(this.lines.vertices);
      gl.drawArrays(gl.LINES, edges, this.lines.count - edges);
    }
    const path = [...(this.route.length && this.poses[0] ? [this.poses[0].position] : []), ...this.route.map(([x, z]) => [x, this.level, z])];
    if (path.length > 1) {
      const ends = new Float32Array(path.flatMap((p) => [p[0], p[1] + 0.4, p[2]])), hues = new Float32Array(path.flatMap(() => [1, 0.82, 0.25]));
      const kept = [buffer(gl, ends), buffer(gl, hues)], made = array(gl, [[0, kept[0], 3], [1, kept[1], 3]]);
      painter.line.use({ view, alpha: 1 });
      gl.bindVertexArray(made);
      gl.drawArrays(gl.LINE_STRIP, 0, path.length);
      gl.deleteVertexArray(made);
      for (const one of kept) gl.deleteBuffer(one);
    }
    gl.disable(gl.BLEND);
  }

  // The matrix that lays a cube between two corners, grown by a factor; in a slice as broad as its ribbon.
  block(low, high, growth = 1) {
    const half = V.scale(V.sub(high, low), 0.5), at = V.add(low, half);
    if (this.still.basin.flat) { half[2] = 0.5 * this.ribbon; at[2] = 0; }
    return sized(at, V.scale(half, growth));
  }

  // The zones of a tank that absorb waves, tinted.
  drawZones(view, lit) {
    const { gl, painter, still } = this;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    for (const [low, high] of still.zones) {
      painter.solid.use({ ...lit, view, pose: this.block(low, high, 1.004), paint: [0.98, 0.86, 0.50, 0.38] });
      gl.bindVertexArray(painter.box.vertices);
      gl.drawArrays(gl.TRIANGLES, 0, painter.box.count);
    }
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  // Bed, obstacles, wavemakers, gauges as buoys, waypoints.
  solids(view, lit) {
    const { gl, painter, still } = this, draw = (what, pose, paint) => {
      painter.solid.use({ ...lit, view, pose, paint });
      gl.bindVertexArray(what.vertices);
      gl.drawArrays(gl.TRIANGLES, 0, what.count);
    };
    if (this.ground) {  // so little broader than the basin that the sides of the water below it are hidden
      const broad = still.basin.flat ? (1.03 * this.ribbon) / still.spacing : 1.01;
      draw(this.ground, sized([0, 0, 0], [1.01, 1, broad]), [0.80, 0.72, 0.55, 1]);
    }
    still.obstacles.forEach(([low, high], k) => {
      draw(painter.box, this.block(low, high), k < still.plates ? [0.80, 0.46, 0.20, 1] : [0.62, 0.60, 0.56, 1]);
    });
    const mark = clamp(0.006 * Math.max(this.size[0], this.size[2]), 0.003, 0.35);
    for (const name in still.gauges) {
      const [x, z] = still.gauges[name], y = this.heightAt(x, z);
      draw(painter.ball3, sized([x, y, z], [mark, mark, mark]), [0.85, 0.12, 0.35, 1]);
      draw(painter.rod, along([x, y, z], [x, y + 5 * mark, z], 0.18 * mark), [0.95, 0.95, 0.95, 1]);
    }
    this.route.forEach(([x, z]) => {
      const y = this.heightAt(x, z);
      draw(painter.rod, along([x, y - 0.5, z], [x, y + 2.2, z], 0.10), [1, 0.82, 0.25, 1]);
      draw(painter.ball3, sized([x, y + 2.3, z], [0.35, 0.35, 0.35]), [1, 0.82, 0.25, 1]);
    });
  }

  // The motion platform: base, six legs coloured by how much of their stroke they use, and the platform they carry.
  drawPlatform(eye) {
    const { gl, painter, still, legs } = this, geometry = still.platform;
    if (!geometry || !legs) return;
    const view = M.mul(eye.projection, eye.view), lit = { ...painter.sky.lit, ...still.light };
    const up = ([x, y, z]) => [y, z, x];  // X forward, Y left, Z up to this page's axes
    const [a, b, c] = legs.slice(3, 6), [sa, ca, sb, cb, sc, cc] = [a, b, c].flatMap((t) => [Math.sin(t), Math.cos(t)]);
    const R = [[cc * cb, cc * sb * sa - sc * ca, cc * sb * ca + sc * sa], [sc * cb, sc * sb * sa + cc * ca, sc * sb * ca - cc * sa], [-sb, cb * sa, cb * ca]];
    const joints = geometry.platform.map((p) => R.map((row) => V.dot(row, p)));
    const gap = [0, 1].map((k) => joints[0][k] + legs[k] - geometry.base[0][k]);
    const rise = Math.sqrt(Math.max(legs[6] ** 2 - gap[0] ** 2 - gap[1] ** 2, 0)) + geometry.base[0][2] - joints[0][2];
    const top = joints.map((p) => up([p[0] + legs[0], p[1] + legs[1], p[2] + rise])), base = geometry.base.map(up);
    const draw = (what, pose, paint) => {
      painter.solid.use({ ...lit, view, pose, paint });
      gl.bindVertexArray(what.vertices);
      gl.drawArrays(gl.TRIANGLES, 0, what.count);
    };
    gl.enable(gl.DEPTH_TEST);
    const unit = V.length(base[0]), low = geometry.shortest, high = geometry.longest;
    base.forEach((p, k) => {
      draw(painter.rod, along(p, base[(k + 1) % 6], 0.03 * unit), [0.30, 0.34, 0.38, 1]);
      draw(painter.ball3, sized(p, [0.05 * unit, 0.05 * unit, 0.05 * unit]), [0.2, 0.22, 0.25, 1]);
      const used = Math.abs(legs[6 + k] - 0.5 * (low + high)) / (0.5 * (high - low));
      const paint = used > 0.95 ? [0.93, 0.22, 0.16, 1] : used > 0.75 ? [0.98, 0.66, 0.10, 1] : [0.16, 0.66, 0.50, 1];
      const half = V.mix(p, top[k], 0.55);
      draw(painter.rod, along(p, half, 0.045 * unit), [0.55, 0.58, 0.62, 1]);
      draw(painter.rod, along(half, top[k], 0.028 * unit), paint);
      draw(painter.rod, along(top[k], top[(k + 1) % 6], 0.035 * unit), [0.92, 0.93, 0.95, 1]);
    });
    const middle = V.scale(top.reduce(V.add), 1 / 6), bow = V.mix(top[0], top[5], 0.5);
    draw(painter.rod, along(middle, V.add(middle, V.scale(V.sub(bow, middle), 0.8)), 0.03 * unit), [0.30, 0.70, 1, 1]);
    draw(painter.ball3, sized(middle, [0.06 * unit, 0.06 * unit, 0.06 * unit]), [0.92, 0.93, 0.95, 1]);
  }

  free() {
    const { gl } = this;
    for (const one of [this.tile, this.gaps, this.mirror]) gl.deleteTexture(one);
    for (const one of [this.surfaces.tank.vertices, this.surfaces.sea?.vertices, this.wall, this.floor, this.balls.vertices, this.lines.vertices, this.spray.vertices, this.ground?.vertices, ...this.wakes.map((w) => w.vertices), ...this.ships.map((s) => s.vertices)]) gl.deleteVertexArray(one || null);
  }
}
