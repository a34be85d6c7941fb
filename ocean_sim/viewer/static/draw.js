// WebGL 2: programs, buffers, and each thing that is drawn. The colours of water and sky are those of the pictures.
const HEAD = "#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler2D;\n";
const OUT = 14000;  // [m] where the drawn sea ends, behind the fog

class Program {
  constructor(gl, vertex, fragment) {
    this.gl = gl;
    this.id = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, HEAD + text);
      gl.compileShader(shader);
      gl.attachShader(this.id, shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    }
    gl.linkProgram(this.id);
    if (!gl.getProgramParameter(this.id, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(this.id));
    this.places = {};
    const count = gl.getProgramParameter(this.id, gl.ACTIVE_UNIFORMS);
    for (let k = 0; k < count; k++) {
      const one = gl.getActiveUniform(this.id, k), name = one.name.replace("[0]", "");
      this.places[name] = { at: gl.getUniformLocation(this.id, one.name), type: one.type, size: one.size };
    }
  }

  use(values) {
    const gl = this.gl;
    gl.useProgram(this.id);
    this.set(values);
  }

  set(values) {
    const gl = this.gl;
    for (const name in values) {
      const place = this.places[name], value = values[name];
      if (!place) continue;
      switch (place.type) {
        case gl.FLOAT: place.size > 1 ? gl.uniform1fv(place.at, value) : gl.uniform1f(place.at, value); break;
        case gl.FLOAT_VEC2: gl.uniform2fv(place.at, value); break;
        case gl.FLOAT_VEC3: gl.uniform3fv(place.at, value); break;
        case gl.FLOAT_VEC4: gl.uniform4fv(place.at, value); break;
        case gl.FLOAT_MAT4: gl.uniformMatrix4fv(place.at, false, value.flat()); break;
        case gl.INT_VEC2: gl.uniform2iv(place.at, value); break;
        default: gl.uniform1i(place.at, value);
      }
    }
  }
}

function texture(gl, unit, filter) {
  const made = gl.createTexture();
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.bindTexture(gl.TEXTURE_2D, made);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, filter);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, filter === gl.NEAREST ? gl.NEAREST : gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  return made;
}

function buffer(gl, data, target) {
  const made = gl.createBuffer(), kind = target || gl.ARRAY_BUFFER;
  gl.bindBuffer(kind, made);
  gl.bufferData(kind, data, gl.STATIC_DRAW);
  return made;
}

// Attributes: [place, buffer, size, type, normalised].
function array(gl, attributes, indices) {
  const made = gl.createVertexArray();
  gl.bindVertexArray(made);
  for (const [place, from, size, type, unit] of attributes) {
    gl.bindBuffer(gl.ARRAY_BUFFER, from);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, size, type || gl.FLOAT, !!unit, 0, 0);
  }
  if (indices) gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices);
  gl.bindVertexArray(null);
  return made;
}

// One sky for all that is drawn, and what fog looks like around its horizon.
class Sky {
  constructor(gl) {
    this.gl = gl;
    this.lit = { sunDir: [-0.8725, 0.3246, -0.3652], sunLight: [1, 0.83, 0.515], skyLight: [0.35, 0.45, 0.56] };
    this.texture = texture(gl, 0, gl.LINEAR_MIPMAP_LINEAR);
    this.haze = texture(gl, 4, gl.NEAREST);
    const plain = (shape, ...rgb) => ({ shape, data: new Uint32Array(shape[0] * shape[1]).fill(shared(...rgb)) });
    this.levels([plain([1, 1], 0.40, 0.62, 0.90)]);  // until the others come
    this.hazes(plain([64, 128], 0.60, 0.80, 1.0));
  }

  levels(levels) {
    const gl = this.gl;
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    levels.forEach((image, level) => this.fill(image, level));
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAX_LEVEL, levels.length - 1);
  }

  hazes(image) {
    this.gl.activeTexture(this.gl.TEXTURE4);
    this.gl.bindTexture(this.gl.TEXTURE_2D, this.haze);
    this.fill(image, 0);
  }

  fill({ shape: [rows, columns], data }, level) {
    const gl = this.gl;
    gl.texImage2D(gl.TEXTURE_2D, level, gl.RGB9_E5, columns, rows, 0, gl.RGB, gl.UNSIGNED_INT_5_9_9_9_REV, data);
  }

  take(head) {
    this.lit = head.lit;
    const [haze, ...levels] = head.arrays.map(({ name, shape }) => ({ shape, data: head.data[name] }));
    this.hazes(haze);
    this.levels(levels);
  }
}

function shared(r, g, b) {
  const e = Math.ceil(Math.log2(Math.max(r, g, b, 1e-5))), unit = 2 ** (e - 9), cut = (v) => Math.min(Math.round(v / unit), 511);
  return (cut(r) | (cut(g) << 9) | (cut(b) << 18) | ((e + 15) << 27)) >>> 0;
}

// What the programs of the pictures leave to be declared.
function declared(uniforms) {
  const kinds = { sunDir: "vec3", sunLight: "vec3", skyLight: "vec3", eyeW: "vec3", pixel: "float" };
  for (const name in uniforms) {
    const value = uniforms[name];
    kinds[name] = !Array.isArray(value) ? "float" : Array.isArray(value[0]) ? "mat4" : "vec3";
  }
  return Object.entries(kinds).map(([name, kind]) => `uniform ${kind} ${name};\n`).join("") +
    "uniform sampler2D sky, haze, hull, mirror;\nout vec4 fragOutput0;\n";
}

const KNOWN = `
uniform sampler2D tile;
uniform vec2 tileFirst, tileStep, origin;
uniform ivec2 tileSize;
uniform vec2 reach;
vec4 weights(float f) {
  float g = f * f, h = g * f;
  return 0.5 * vec4(-h + 2.0 * g - f, 3.0 * h - 5.0 * g + 2.0, -3.0 * h + 4.0 * g + f, h - g);
}
vec4 slopes(float f) {
  float g = f * f;
  return 0.5 * vec4(-3.0 * g + 4.0 * f - 1.0, 9.0 * g - 10.0 * f, -9.0 * g + 8.0 * f + 1.0, 3.0 * g - 2.0 * f);
}
// Height, its slopes along x and z, and foam: a cubic through the known heights.
vec4 known(vec2 p) {
  vec2 q = clamp((p - tileFirst) / max(tileStep, vec2(1e-6)), vec2(-0.5), vec2(tileSize) - 0.5), i = floor(q), f = q - i;
  vec4 wx = weights(f.x), wz = weights(f.y), dx = slopes(f.x), dz = slopes(f.y);
  vec4 sum = vec4(0.0);
  for (int a = 0; a < 4; a++) {
    int x = clamp(int(i.x) + a - 1, 0, tileSize.x - 1);
    vec4 row = vec4(0.0);
    for (int b = 0; b < 4; b++) {
      vec2 v = texelFetch(tile, ivec2(clamp(int(i.y) + b - 1, 0, tileSize.y - 1), x), 0).rg;
      row += vec4(v.r * wz[b], v.r * wz[b], v.r * dz[b], v.g * wz[b]);
    }
    sum += row * vec4(wx[a], dx[a], wx[a], wx[a]);
  }
  return vec4(sum.x, sum.yz / max(tileStep, vec2(1e-6)), clamp(sum.w, 0.0, 1.0));
}
`;

const WATER_VERTEX = `
layout(location = 0) in vec2 node;
${KNOWN}
uniform mat4 view;
uniform vec4 waves[40];
uniform float waveCount, farShare, level, crest, cell, margin, rough;
out vec3 posW, nrmW, attW;
void main() {
  vec2 p = node + origin, past = abs(node - 0.5 * (tileFirst * 2.0 + tileStep * (vec2(tileSize) - 1.0))) - reach, beyond = max(past, 0.0);
  // The waves from afar begin before the sides, beyond which the heights of the basin are drawn out to stripes.
  float out_ = max(beyond.x, beyond.y), share = smoothstep(-0.2, 0.05, max(past.x, past.y) / margin) * farShare;
  vec4 here = known(node);
  here.yz *= step(beyond, vec2(1e-4));
  float height = 0.0, lost = 0.0;
  vec2 slope = vec2(0.0);
  float apart = max(cell, 0.075 * out_);
  if (share > 0.0) for (int k = 0; k < int(waveCount); k++) {
    vec4 w = waves[k];
    float n = length(w.yz), fade = clamp((6.283 / n / apart - 3.0) / 3.0, 0.0, 1.0), phase = dot(w.yz, p) + w.w;
    height += fade * w.x * cos(phase);
    slope -= fade * w.x * sin(phase) * w.yz;
    lost += 0.25 * w.x * w.x * n * n * (1.0 - fade * fade);
  }
  float h = mix(here.x, level + height, share);
  vec2 s = mix(here.yz, slope, share);
  posW = vec3(p.x, h, p.y);
  nrmW = normalize(vec3(-s.x, 1.0, -s.y));
  attW = vec3(here.w * (1.0 - smoothstep(0.0, 2.0 * max(tileStep.x, tileStep.y), out_)), (h - level) / crest, max(lost * share, rough));
  gl_Position = view * vec4(posW, 1.0);
}`;

const WAKE_VERTEX = `
layout(location = 0) in vec4 node;  // x and z, place across from -1 to 1, strength
${KNOWN}
uniform mat4 view;
out vec4 at;
void main() {
  vec2 inside = reach - abs(node.xy - origin - tileFirst - 0.5 * tileStep * (vec2(tileSize) - 1.0));
  at = vec4(node.xyz, node.w * step(0.0, min(inside.x, inside.y)));
  gl_Position = view * vec4(node.x, known(node.xy - origin).x + 0.02, node.y, 1.0);
  gl_Position.z -= 3e-5 * gl_Position.w;  // water between its nodes stands over those of the wake
}`;
const WAKE_FRAGMENT = `
in vec4 at;
out vec4 colour;
float random(vec2 p) { return fract(sin(dot(p, vec2(127.1, 311.7))) * 43758.5453); }
float noise(vec2 p) {
  vec2 i = floor(p), f = smoothstep(0.0, 1.0, p - i);
  return mix(mix(random(i), random(i + vec2(1, 0)), f.x), mix(random(i + vec2(0, 1)), random(i + vec2(1, 1)), f.x), f.y);
}
void main() {
  float n = 0.45 * noise(0.9 * at.xy) + 0.33 * noise(2.3 * at.xy + 5.0) + 0.22 * noise(5.9 * at.xy);
  float cover = at.w * at.w * (1.0 - at.z * at.z);
  float white = smoothstep(0.70 - 0.48 * cover, 0.95 - 0.40 * cover, n);
  colour = vec4(mix(vec3(0.55, 0.78, 0.82), vec3(0.88, 0.93, 0.95), white), 0.75 * white * smoothstep(0.0, 0.2, cover) + 0.22 * at.w * (1.0 - at.z * at.z));
}`;

const SIDE_VERTEX = `
layout(location = 0) in vec3 node;  // x and z on the rim, share of the way to the bed
${KNOWN}
uniform mat4 view;
uniform float bed;
out float down;
out vec3 posW;
void main() {
  float top = known(node.xy).x;
  down = node.z;
  posW = vec3(node.x + origin.x, mix(top, bed, down), node.y + origin.y);
  gl_Position = view * vec4(posW, 1.0);
}`;
const SIDE_FRAGMENT = `
in float down;
in vec3 posW;
uniform float alpha;
out vec4 colour;
void main() {
  vec3 n = normalize(cross(dFdx(posW), dFdy(posW)));
  vec3 c = mix(vec3(0.17, 0.52, 0.62), vec3(0.07, 0.29, 0.40), pow(down, 0.6));
  c *= 0.86 + 0.18 * abs(dot(n, normalize(vec3(-0.87, 0.32, -0.37)))) + 0.10 * smoothstep(0.03, 0.0, down);
  colour = vec4(c, alpha);
}`;

const SHIP_VERTEX = `
layout(location = 0) in vec3 corner;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 paint;
layout(location = 3) in float radius;
uniform mat4 view, pose;
uniform vec3 low, high;
uniform float pixel;
out vec3 nrmW, posW;
out vec4 tint;
void main() {
  vec4 p = pose * vec4(0.5 * (low + high) + 0.5 * (high - low) * corner, 1.0);
  nrmW = mat3(pose) * normal;
  if (radius > 0.0) p.xyz += normalize(nrmW) * max(0.6 * pixel * (view * p).w - radius, 0.0);  // a stay is drawn a pixel wide or more
  posW = p.xyz;
  tint = vec4(pow(paint.rgb, vec3(2.2)), paint.a);
  gl_Position = view * p;
}`;
const LIT = `
uniform vec3 sunDir, SUNSHINE, FROM_ABOVE, FROM_BELOW, MIRRORED;
vec3 shown(vec3 c) {
  c = max(c, vec3(0.0)) * 1.15;
  c = c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14);
  return pow(clamp(c, 0.0, 1.0), vec3(1.0 / 2.2));
}
vec3 lit(vec3 n, vec3 paint, float gloss) {
  float sun = dot(n, sunDir);
  vec3 ambient = mix(FROM_BELOW, FROM_ABOVE, 0.5 + 0.5 * n.y);
  float facing = 0.35 + 0.65 * clamp(1.0 - abs(sun), 0.0, 1.0);
  return paint * (SUNSHINE * clamp(sun, 0.0, 1.0) + ambient) + 0.12 * gloss * MIRRORED * facing;
}
`;
const SHIP_FRAGMENT = `
in vec3 nrmW, posW;
in vec4 tint;
uniform float above;
out vec4 colour;
${LIT}
void main() {
  if (posW.y < above) discard;
  colour = vec4(shown(lit(normalize(nrmW), tint.rgb, tint.a)), 1.0);
}`;

const SOLID_VERTEX = `
layout(location = 0) in vec3 corner;
layout(location = 1) in vec3 normal;
uniform mat4 view, pose;
out vec3 nrmW;
void main() { nrmW = mat3(pose) * normal; gl_Position = view * (pose * vec4(corner, 1.0)); }`;
const SOLID_FRAGMENT = `
in vec3 nrmW;
uniform vec4 paint;
out vec4 colour;
${LIT}
void main() { colour = vec4(shown(lit(normalize(nrmW), pow(paint.rgb, vec3(2.2)), 0.0)), paint.a); }`;

const BALL_VERTEX = `
layout(location = 0) in vec3 before;
layout(location = 1) in vec3 after;
layout(location = 2) in float speed;
uniform mat4 view;
uniform vec3 low, high, speeds[5];
uniform float share, radius, scale;
out vec3 tint;
void main() {
  vec3 p = 0.5 * (low + high) + 0.5 * (high - low) * mix(before, after, share);
  gl_Position = before.x < -1.00001 || after.x < -1.00001 ? vec4(2.0, 2.0, 2.0, 1.0) : view * vec4(p, 1.0);
  gl_PointSize = clamp(radius * scale / gl_Position.w, 1.5, 64.0);
  float at = clamp(speed, 0.0, 1.0) * 4.0;
  int k = min(int(at), 3);
  tint = mix(speeds[k], speeds[k + 1], at - float(k));
}`;
const BALL_FRAGMENT = `
in vec3 tint;
out vec4 colour;
void main() {
  vec2 q = 2.0 * gl_PointCoord - 1.0;
  float r = dot(q, q);
  if (r > 1.0) discard;
  vec3 n = vec3(q.x, -q.y, sqrt(1.0 - r));
  float light = 0.50 + 0.55 * max(dot(n, normalize(vec3(-0.4, 0.7, 0.6))), 0.0);
  colour = vec4(tint * light + 0.25 * pow(max(dot(n, normalize(vec3(-0.3, 0.6, 0.75))), 0.0), 24.0), 1.0);
}`;

const LINE_VERTEX = `
layout(location = 0) in vec3 end;
layout(location = 1) in vec3 hue;
uniform mat4 view;
out vec3 tint;
void main() { tint = hue; gl_Position = view * vec4(end, 1.0); }`;
const LINE_FRAGMENT = "in vec3 tint; uniform float alpha; out vec4 colour; void main() { colour = vec4(tint, alpha); }";

const SKY_VERTEX = `
uniform mat4 back;
out vec3 posW;
void main() {
  vec2 p = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0;
  vec4 far = back * vec4(p, 0.999, 1.0);
  posW = far.xyz / far.w;
  gl_Position = vec4(p, 0.99999, 1.0);
}`;

const FLOOR_VERTEX = `
layout(location = 0) in vec3 corner;
uniform mat4 view;
out vec3 posW;
void main() { posW = corner; gl_Position = view * vec4(corner, 1.0); }`;

// What every world draws with, compiled once for each set of ships.
class Painter {
  constructor(gl) {
    this.gl = gl;
    this.solid = new Program(gl, SOLID_VERTEX, SOLID_FRAGMENT);
    this.ship = new Program(gl, SHIP_VERTEX, SHIP_FRAGMENT);
    this.ball = new Program(gl, BALL_VERTEX, BALL_FRAGMENT);
    this.line = new Program(gl, LINE_VERTEX, LINE_FRAGMENT);
    this.wake = new Program(gl, WAKE_VERTEX, WAKE_FRAGMENT);
    this.side = new Program(gl, SIDE_VERTEX, SIDE_FRAGMENT);
    this.sky = new Sky(gl);
    this.rod = shape(gl, rod(16));
    this.box = shape(gl, cube());
    this.ball3 = shape(gl, sphere(16, 10));
    this.waters = new Map();
    this.empty = gl.createVertexArray();
  }

  // The programs of water and sky are text that came with the still.
  water(still) {
    const key = still.shaders.water;
    if (!this.waters.has(key)) {
      const { common, functions, water, sky, floor } = still.shaders, top = declared(still.uniforms);
      // With few pixels a wave the sun's glint stands on the water as crumbs of sand: here it is wider, whiter and limited.
      const soft = `vec3 softened(vec3 glint) { return mix(glint, vec3(glint.g), 0.4) / (1.0 + 2.0 * glint.g); }
#define sunGlint(n, e, variance) softened(sunGlint(n, e, (variance) + 0.006))\n`;
      const body = `${top}in vec3 posW, nrmW, attW;\n${common}${functions}${soft}void main() {${water}
  // From above a slope mirrors hardly more sky than the flat: crests and slopes towards the sun are made lighter; clouds
  // lit by the sun turn no dark water brown.
  float over = smoothstep(0.70, 0.95, normalize(eyeW - posW).y);
  float relief = clamp(2.0 * dot(normalize(nrmW).xz, normalize(sunDir.xz)) + 0.25 * clamp(attW.y, -1.0, 1.0), -0.4, 1.0);
  vec3 bluest = fragOutput0.b * mix(vec3(0.36, 0.80, 1.0), vec3(1.0), smoothstep(0.35, 0.60, fragOutput0.b));
  fragOutput0.rgb = mix(fragOutput0.rgb, min(fragOutput0.rgb, bluest), over) * (1.0 + over * relief);
}`;
      const dome = `${top}in vec3 posW;\nuniform float studio;
uniform vec3 ground;\n${common}void main() {${sky}
  vec3 d = normalize(posW - eyeW);
  float below = clamp(-d.y, 0.0, 1.0);
  vec3 floor_ = mix(fragOutput0.rgb, ground, 1.0 - exp(-below / 0.07));
  fragOutput0.rgb = mix(fragOutput0.rgb, floor_, studio * step(d.y, 0.0));
}`;
      const under = `in vec3 posW;\nuniform vec3 boxLow, boxHigh;\nuniform float apart;\nout vec4 fragOutput0;\nvoid main() {${floor}}`;
      this.waters.set(key, { water: new Program(this.gl, WATER_VERTEX, body), dome: new Program(this.gl, SKY_VERTEX, dome), floor: new Program(this.gl, FLOOR_VERTEX, under) });
    }
    return this.waters.get(key);
  }
}

// Radius [m] of the rod of twelve sides that a triangle longer than `least` [m] and narrow belongs to, at its corners; 0 for all others.
function slender(corners, unit, least) {
  const radius = new Float32Array(corners.length / 3);
  for (let k = 0; k < radius.length; k += 3) {
    const [a, b, c] = [0, 1, 2].map((i) => unit.map((u, axis) => u * corners[3 * (k + i) + axis])), sides = [V.sub(b, a), V.sub(c, a), V.sub(c, b)];
    const long = Math.max(...sides.map(V.length)), high = V.length(V.cross(sides[0], sides[1])) / long;
    if (long > least && long > 40 * high) radius.fill(1.93 * high, k, k + 3);
  }
  return radius;
}

function shape(gl, [corners, normals]) {
  const vertices = array(gl, [[0, buffer(gl, new Float32Array(corners)), 3], [1, buffer(gl, new Float32Array(normals)), 3]]);
  return { vertices, count: corners.length / 3 };
}

// A rod of radius 1 along y from 0 to 1.
function rod(sides) {
  const corners = [], normals = [];
  for (let k = 0; k < sides; k++) {
    const [a, b] = [k, k + 1].map((i) => (2 * Math.PI * i) / sides).map((t) => [Math.cos(t), Math.sin(t)]);
    const quad = [[a, 0], [a, 1], [b, 1], [a, 0], [b, 1], [b, 0]];
    for (const [[x, z], y] of quad) { corners.push(x, y, z); normals.push(x, 0, z); }
    for (const [y, turn] of [[0, [b, a]], [1, [a, b]]]) {
      corners.push(0, y, 0, turn[1][0], y, turn[1][1], turn[0][0], y, turn[0][1]);
      for (let i = 0; i < 3; i++) normals.push(0, 2 * y - 1, 0);
    }
  }
  return [corners, normals];
}

function cube() {
  const corners = [], normals = [];
  for (let axis = 0; axis < 3; axis++) for (const side of [-1, 1]) {
    const u = (axis + 1) % 3, v = (axis + 2) % 3, at = (a, b) => { const p = [0, 0, 0]; p[axis] = side; p[u] = a; p[v] = b; return p; };
    for (const p of [at(-1, -1), at(1, -1), at(1, 1), at(-1, -1), at(1, 1), at(-1, 1)]) {
      const n = [0, 0, 0];
      n[axis] = side;
      corners.push(...p);
      normals.push(...n);
    }
  }
  return [corners, normals];
}

function sphere(round, down) {
  const corners = [], at = (i, j) => {
    const a = (2 * Math.PI * i) / round, b = (Math.PI * j) / down;
    return [Math.sin(b) * Math.cos(a), Math.cos(b), Math.sin(b) * Math.sin(a)];
  };
  for (let i = 0; i < round; i++) for (let j = 0; j < down; j++) {
    corners.push(...at(i, j), ...at(i + 1, j), ...at(i + 1, j + 1), ...at(i, j), ...at(i + 1, j + 1), ...at(i, j + 1));
  }
  return [corners, corners];
}

// The matrix that lays a rod of a radius from a to b.
function along(a, b, radius) {
  const y = V.sub(b, a), up = Math.abs(y[1]) < 0.9 * V.length(y) ? [0, 1, 0] : [1, 0, 0];
  const x = V.scale(V.unit(V.cross(y, up)), radius), z = V.scale(V.unit(V.cross(x, y)), radius);
  return [...x, 0, ...y, 0, ...z, 0, ...a, 1];
}
const sized = (p, s) => [s[0], 0, 0, 0, 0, s[1], 0, 0, 0, 0, s[2], 0, ...p, 1];
