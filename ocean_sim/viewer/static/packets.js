// Packets of protocol version 1; see ocean_sim/viewer/protocol.py.
const KINDS = { float32: Float32Array, int16: Int16Array, uint16: Uint16Array, int8: Int8Array, uint8: Uint8Array, uint32: Uint32Array, float16: Uint16Array };
const HALF = new Float32Array(65536);
for (let k = 0; k < 65536; k++) {
  const sign = k & 0x8000 ? -1 : 1, e = (k >> 10) & 31, m = k & 1023;
  HALF[k] = sign * (e === 0 ? m * 2 ** -24 : e === 31 ? (m ? NaN : Infinity) : (1 + m / 1024) * 2 ** (e - 15));
}

async function inflated(buffer) {
  if (new Uint8Array(buffer, 0, 1)[0] !== 0x78) return buffer;
  const stream = new Blob([buffer]).stream().pipeThrough(new DecompressionStream("deflate"));
  return await new Response(stream).arrayBuffer();
}

// The packet that begins at a place of a buffer; `end`: where it ends.
function unpack(buffer, begin = 0) {
  const view = new DataView(buffer, begin);
  if (view.getUint32(0, false) !== 0x4f535031) throw new Error("this is not a packet");
  const size = view.getUint32(4, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, begin + 8, size)));
  let at = begin + 8 + size;
  head.data = {};
  head.about = {};
  for (const row of head.arrays) {
    const kind = KINDS[row.dtype], count = row.shape.reduce((a, b) => a * b, 1);
    const bytes = count * kind.BYTES_PER_ELEMENT;
    let array = new kind(buffer, at, count);
    if (row.dtype === "float16") array = Float32Array.from(array, (v) => HALF[v]);
    head.data[row.name] = array;
    head.about[row.name] = row;
    at += Math.ceil(bytes / 4) * 4;
  }
  head.end = at;
  return head;
}

// The int16 moments that differences stand for, all in one array.
function summed(planes, shape) {
  const [, moments, n] = shape, out = new Int16Array(moments * n), low = moments * n;
  for (let t = 0; t < moments; t++) for (let k = 0; k < n; k++) {
    const at = t * n + k, step = (planes[at] << 8) | planes[low + at];
    out[at] = t ? out[at - n] + step : step;
  }
  return out;
}

// A finished run: its moments as frames, made when they are asked for.
class Replay {
  constructor(head) {
    this.times = head.times;
    this.head = head;
    this.kept = {};
    for (const name of ["height", "particles", "speed", "foam"]) {
      if (head.data[name]) {
        const row = head.about[name];
        this.kept[name] = { row, n: row.shape[2], whole: summed(head.data[name], row.shape) };
        delete head.data[name];
      }
    }
    this.made = new Map();
  }

  get end() { return this.times[this.times.length - 1]; }

  before(time) { return latest(this.times, time); }

  frame(k) {
    if (this.made.has(k)) return this.made.get(k);
    const { head, kept } = this, data = {}, about = {};
    const rows = (name, width) => head.data[name].subarray(k * width, (k + 1) * width);
    if (kept.height) {
      const { row, n, whole } = kept.height, unit = row.high / 32767;
      data.height = Float32Array.from(whole.subarray(k * n, (k + 1) * n), (v) => v * unit);
    }
    if (kept.foam) data.foam = Uint8Array.from(kept.foam.whole.subarray(k * kept.foam.n, (k + 1) * kept.foam.n));
    for (const name of ["poses", "platform", "scalars"]) {
      if (head.data[name] && head.data[name].length) data[name] = rows(name, head.about[name].shape[1]);
    }
    if (head.data.drops) data.drops = rows("drops", 6 * head.about.drops.shape[1]);
    if (kept.particles) this.particles(k, data, about);
    const origin = [...rows("origins", 2)];
    const frame = { time: this.times[k], seq: k, origin, fastest: head.fastest, data, about };
    if (this.made.size > 64) this.made.clear();
    this.made.set(k, frame);
    return frame;
  }

  // Particles are kept in some moments only; between them they go straight.
  particles(k, data, about) {
    const { row, n, whole } = this.kept.particles, every = row.every, last = row.shape[1] - 1;
    const a = Math.min(Math.floor(k / every), last), b = Math.min(a + 1, last), s = (k % every) / every;
    const speed = this.kept.speed, m = speed.n;
    if (s === 0 || a === b) {
      data.particles = whole.slice(a * n, (a + 1) * n);
    } else {
      data.particles = new Int16Array(n);
      for (let i = 0; i < n; i++) {
        const u = whole[a * n + i], v = whole[b * n + i];
        data.particles[i] = u + (v - u) * s;
      }
    }
    data.speed = Uint8Array.from(speed.whole.subarray(a * m, (a + 1) * m));
    about.particles = { low: row.low, high: row.high };
  }
}

// Index of the last of some times at or before a time.
function latest(times, time) {
  let low = 0, high = times.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= time) low = middle; else high = middle - 1;
  }
  return low;
}

// The last minute of a live simulation: its packets as they came. Every second one goes when they become too many or too large.
const HISTORY_SECONDS = 60, HISTORY_MOMENTS = 600, HISTORY_BYTES = 96e6;
class History {
  constructor() { this.clear(); }

  clear() { Object.assign(this, { times: [], packets: [], bytes: 0, apart: 0, made: new Map() }); }

  get end() { return this.times[this.times.length - 1]; }

  before(time) { return latest(this.times, time); }

  add(time, packet) {
    if (this.times.length && time < this.end + Math.max(this.apart, 1e-6)) return;
    this.times.push(time);
    this.packets.push(packet);
    this.bytes += packet.byteLength;
    while (this.times[0] < time - HISTORY_SECONDS) { this.times.shift(); this.bytes -= this.packets.shift().byteLength; }
    if (this.times.length <= HISTORY_MOMENTS && this.bytes <= HISTORY_BYTES) return;
    const odd = (_, k) => (this.times.length - 1 - k) % 2 === 0, packets = this.packets.filter(odd);
    Object.assign(this, { times: this.times.filter(odd), packets, bytes: packets.reduce((sum, one) => sum + one.byteLength, 0) });
    this.apart = (this.end - this.times[0]) / this.times.length;
  }

  frame(k) {
    const packet = this.packets[k];
    if (!this.made.has(packet)) {
      if (this.made.size > 8) this.made.clear();
      this.made.set(packet, unpack(packet));
    }
    return this.made.get(packet);
  }
}

function held(id) {
  const text = document.getElementById(id).textContent, raw = atob(text), bytes = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; k++) bytes[k] = raw.charCodeAt(k);
  return bytes.buffer;
}
