// Vectors are arrays of three, matrices arrays of sixteen by columns, quaternions w, x, y, z.
const V = {
  add: (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]],
  sub: (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]],
  scale: (a, s) => [a[0] * s, a[1] * s, a[2] * s],
  dot: (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2],
  cross: (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]],
  length: (a) => Math.hypot(a[0], a[1], a[2]),
  unit: (a) => V.scale(a, 1 / (V.length(a) || 1)),
  mix: (a, b, s) => a.map((v, k) => v + (b[k] - v) * s),
};
const clamp = (v, low, high) => Math.min(Math.max(v, low), high);
const M = {
  one: () => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],
  mul(a, b) {
    const c = new Array(16);
    for (let j = 0; j < 4; j++) for (let i = 0; i < 4; i++) {
      c[4 * j + i] = a[i] * b[4 * j] + a[4 + i] * b[4 * j + 1] + a[8 + i] * b[4 * j + 2] + a[12 + i] * b[4 * j + 3];
    }
    return c;
  },
  perspective(angle, aspect, near, far) {
    const f = 1 / Math.tan(angle / 2), d = 1 / (near - far);
    return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) * d, -1, 0, 0, 2 * far * near * d, 0];
  },
  look(eye, target, up) {
    const z = V.unit(V.sub(eye, target)), x = V.unit(V.cross(up, z)), y = V.cross(z, x);
    return [x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0, -V.dot(x, eye), -V.dot(y, eye), -V.dot(z, eye), 1];
  },
  pose(q, p) {  // body to world
    const [w, x, y, z] = q;
    return [
      1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0,
      2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x), 0,
      2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), 0, p[0], p[1], p[2], 1];
  },
  point: (m, p) => [0, 1, 2].map((i) => m[i] * p[0] + m[4 + i] * p[1] + m[8 + i] * p[2] + m[12 + i]),
  turn: (m, p) => [0, 1, 2].map((i) => m[i] * p[0] + m[4 + i] * p[1] + m[8 + i] * p[2]),
  inverse(m) {  // by cofactors
    const r = new Array(16), s = (i, j, k, l) => m[i] * m[j] - m[k] * m[l];
    const a = s(0, 5, 1, 4), b = s(0, 6, 2, 4), c = s(0, 7, 3, 4), d = s(1, 6, 2, 5), e = s(1, 7, 3, 5), f = s(2, 7, 3, 6);
    const g = s(8, 13, 9, 12), h = s(8, 14, 10, 12), i = s(8, 15, 11, 12), j = s(9, 14, 10, 13), k = s(9, 15, 11, 13), l = s(10, 15, 11, 14);
    const t = 1 / (a * l - b * k + c * j + d * i - e * h + f * g);
    r[0] = (m[5] * l - m[6] * k + m[7] * j) * t; r[1] = (m[2] * k - m[1] * l - m[3] * j) * t;
    r[2] = (m[13] * f - m[14] * e + m[15] * d) * t; r[3] = (m[10] * e - m[9] * f - m[11] * d) * t;
    r[4] = (m[6] * i - m[4] * l - m[7] * h) * t; r[5] = (m[0] * l - m[2] * i + m[3] * h) * t;
    r[6] = (m[14] * c - m[12] * f - m[15] * b) * t; r[7] = (m[8] * f - m[10] * c + m[11] * b) * t;
    r[8] = (m[4] * k - m[5] * i + m[7] * g) * t; r[9] = (m[1] * i - m[0] * k - m[3] * g) * t;
    r[10] = (m[12] * e - m[13] * c + m[15] * a) * t; r[11] = (m[9] * c - m[8] * e - m[11] * a) * t;
    r[12] = (m[5] * h - m[4] * j - m[6] * g) * t; r[13] = (m[0] * j - m[1] * h + m[2] * g) * t;
    r[14] = (m[13] * b - m[12] * d - m[14] * a) * t; r[15] = (m[8] * d - m[9] * b + m[10] * a) * t;
    return r;
  },
};
const Q = {
  mix(a, b, s) {  // the short way, then of unit length
    const sign = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] < 0 ? -1 : 1;
    const q = a.map((v, k) => v + (sign * b[k] - v) * s), n = Math.hypot(...q) || 1;
    return q.map((v) => v / n);
  },
};
