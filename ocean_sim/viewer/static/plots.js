// Curves over time: one card for each group of numbers, the last of them in words.
const TITLES = {
  elevation: "Elevation at the gauges", height: "Significant wave height", heave: "Heave: height of the centre of mass", angles: "Roll and pitch", yaw: "Heading to port of north",
  speed: "Speed ahead", throttle: "Throttle", rudder: "Rudder to port", legs: "Legs of the platform", compression: "Compression of the water",
  pace: "Simulated over wall time", dt: "Time step", cost: "Cost of each stage",
};
const HUES = {
  dark: ["#56b4e9", "#e69f00", "#2fc79a", "#cc79a7", "#f0e442", "#ff7a50", "#a8b5c0"],
  light: ["#0072b2", "#b35c00", "#00785a", "#a23c7c", "#6b5d00", "#c63f12", "#52616b"],
};
const KEPT = 2400;
// Least height of a plot, by unit: what moves less is noise, and lies in its middle. Of lengths in water of particles, see `curves`.
const LEAST = { m: 0.002, deg: 0.5, "m/s": 0.05, "%": 0.1, x: 0.05, 1: 0.05 };

class Plots {
  constructor(box) {
    this.box = box;
    this.sets = [];
    this.cards = [];
  }

  // `worlds`: the scalars of each, and the spacing of its particles or 0 [m], [{scalars, name, spacing}].
  begin(worlds) {
    this.sets = worlds.map(({ scalars, name, spacing }) => ({ scalars, name, spacing, times: [], rows: [] }));
    this.box.textContent = "";
    this.cards = [];
    const groups = [...new Set(worlds.flatMap((w) => w.scalars.map((s) => s.group)))];
    for (const group of groups) {
      const card = document.createElement("figure"), canvas = document.createElement("canvas"), head = document.createElement("figcaption");
      card.className = "card";
      head.innerHTML = `<b>${TITLES[group] || group}</b><span class="legend"></span>`;
      canvas.setAttribute("role", "img");
      canvas.setAttribute("aria-label", `${TITLES[group] || group} over time`);
      card.append(head, canvas);
      this.box.append(card);
      this.cards.push({ group, canvas, legend: head.querySelector(".legend"), shown: "" });
    }
  }

  add(k, time, scalars) {
    const set = this.sets[k];
    if (!set || !scalars) return;
    const last = set.times[set.times.length - 1];
    if (last !== undefined && time <= last) {
      if (time === last) return;
      set.times.length = set.rows.length = 0;
    }
    set.times.push(time);
    const before = set.rows[set.rows.length - 1];
    set.rows.push(Float32Array.from(scalars, (v, i) => (before && set.scalars[i].group === "yaw" ? v - 360 * Math.round((v - before[i]) / 360) : v)));
    if (set.times.length > KEPT) { set.times.splice(0, 200); set.rows.splice(0, 200); }
  }

  // All moments of a replay at once.
  fill(k, replay) {
    const set = this.sets[k], { scalars } = replay.head.data, width = set.scalars.length;
    set.times = replay.times;
    set.rows = replay.times.map((_, i) => scalars.subarray(i * width, (i + 1) * width));
    set.whole = true;
  }

  // At the end of the curves, or at `now` in a replay and where a live page looks back.
  draw(now, past) {
    const style = getComputedStyle(document.documentElement), dark = style.getPropertyValue("--dark").trim() === "1";
    const ink = style.getPropertyValue("--muted").trim(), rule = style.getPropertyValue("--rule").trim(), hues = HUES[dark ? "dark" : "light"];
    for (const card of this.cards) {
      const { canvas } = card, box = canvas.getBoundingClientRect();
      if (!box.width || box.bottom < 0 || box.top > innerHeight) continue;
      const ratio = Math.min(devicePixelRatio || 1, 2), w = Math.round(box.width * ratio), h = Math.round(box.height * ratio);
      if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
      const pen = canvas.getContext("2d");
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      pen.clearRect(0, 0, box.width, box.height);
      this.curves(pen, box.width, box.height, card, { ink, rule, hues }, now, past);
    }
  }

  curves(pen, width, height, card, { ink, rule, hues }, now, past) {
    const lines = [], left = 56, bottom = 16, top = 6;
    this.sets.forEach((set, k) => set.scalars.forEach((s, i) => { if (s.group === card.group) lines.push({ set, k, i, ...s }); }));
    let low = Infinity, high = -Infinity, from = Infinity, to = -Infinity;
    for (const { set, i } of lines) {
      if (!set.times.length) continue;
      from = Math.min(from, set.times[0]);
      to = Math.max(to, set.times[set.times.length - 1]);
      for (const row of set.rows) { const v = row[i]; if (v < low) low = v; if (v > high) high = v; }
    }
    if (!(to > -Infinity)) return;
    if (!lines.some(({ set }) => set.whole)) from = Math.max(from, to - 60);
    const { unit, set: { spacing } } = lines[0], size = Math.max(Math.abs(low), Math.abs(high));
    const least = Math.max(LEAST[unit] ?? 0.1 * size, unit === "m" ? 0.2 * spacing : 0, 1e-9), reach = Math.max(high - low, least);
    const gap = Math.max(0.08 * reach, 0.5 * (least - high + low));
    low -= gap;
    high += gap;
    if (to <= from) to = from + 1;
    const x = (t) => left + ((t - from) / (to - from)) * (width - left - 6), y = (v) => height - bottom - ((v - low) / (high - low)) * (height - bottom - top);
    pen.font = "11px system-ui, sans-serif";
    pen.lineWidth = 1;
    const step = round((high - low) / 4), digits = clamp(Math.ceil(-Math.log10(step) - 1e-9), 0, 7);
    const fine = clamp(Math.round(-Math.log10(Math.max(reach, 0.2 * size) / 100)), 0, Math.max(digits, 3));  // digits of a value in words
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (let v = Math.ceil(low / step) * step; v <= high; v += step) {
      pen.strokeStyle = rule;
      pen.beginPath();
      pen.moveTo(left, y(v));
      pen.lineTo(width - 6, y(v));
      pen.stroke();
      pen.fillStyle = ink;
      pen.fillText((Math.abs(v) < 1e-9 * step ? 0 : v).toFixed(digits).replace("-", "−"), left - 6, y(v));
    }
    pen.textBaseline = "alphabetic";
    pen.textAlign = "left";
    const parts = clamp(Math.ceil(-Math.log10((to - from) / 20)), 0, 7);
    pen.fillText(`${from.toFixed(parts)} s`, left, height - 3);
    pen.textAlign = "right";
    pen.fillText(`${to.toFixed(parts)} s`, width - 6, height - 3);
    const words = [];
    lines.forEach(({ set, k, i, label, unit }, n) => {
      const hue = hues[n % hues.length];
      pen.strokeStyle = hue;
      pen.setLineDash(k ? [5, 3] : []);
      pen.lineWidth = 1.6;
      pen.beginPath();
      let begun = false, stride = Math.max(1, Math.floor(set.times.length / 700));
      for (let j = 0; j < set.times.length; j += stride) {
        if (set.times[j] < from) continue;
        begun ? pen.lineTo(x(set.times[j]), y(set.rows[j][i])) : pen.moveTo(x(set.times[j]), y(set.rows[j][i]));
        begun = true;
      }
      pen.stroke();
      const at = set.whole || past ? nearest(set.times, now) : set.rows.length - 1;
      const value = set.rows[at] ? set.rows[at][i] : NaN;
      const who = this.sets.length > 1 ? `${k + 1}: ` : "";
      const turned = (card.group === "yaw" || label.startsWith("rudder")) && Number.isFinite(value);
      const said = turned ? sided(value) : Number.isFinite(value) ? (+value.toFixed(fine) || 0).toFixed(fine).replace("-", "−") : "–";
      words.push(`<i style="--hue:${hue}">${who}${escaped(label)} <b>${said}</b> ${turned || unit === "1" ? "" : escaped(unit)}</i>`);
    });
    pen.setLineDash([]);
    if ((past || lines.some(({ set }) => set.whole)) && now >= from && now <= to) {
      pen.strokeStyle = ink;
      pen.lineWidth = 1;
      pen.beginPath();
      pen.moveTo(x(now), top);
      pen.lineTo(x(now), height - bottom);
      pen.stroke();
    }
    const text = words.join("");
    if (text !== card.shown) { card.legend.innerHTML = text; card.shown = text; }
  }

  csv() {
    return this.sets.map((set) => {
      const head = ["time_s", ...set.scalars.map((s) => `${s.name}_${s.unit}`.replace(/[^A-Za-z0-9_]+/g, "_"))].join(",");
      return [`# ${set.name}`, head, ...set.times.map((t, k) => [t, ...set.rows[k]].map((v) => Number(v.toPrecision(7))).join(","))].join("\n");
    }).join("\n\n") + "\n";
  }
}

function nearest(times, now) {
  let low = 0, high = times.length - 1;
  while (low < high) { const m = (low + high) >> 1; if (times[m] < now) low = m + 1; else high = m; }
  return low;
}
function round(raw) {
  const power = 10 ** Math.floor(Math.log10(raw)), part = raw / power;
  return (part <= 1 ? 1 : part <= 2 ? 2 : part <= 5 ? 5 : 10) * power;
}
function short(v) {
  if (!Number.isFinite(v)) return "–";
  const a = Math.abs(v);
  return (a >= 1000 ? v.toFixed(0) : a >= 100 ? v.toFixed(1) : a >= 1 ? v.toFixed(2) : a >= 0.1 ? v.toFixed(3) : a ? v.toPrecision(2) : "0").replace("-", "−");
}
function escaped(text) {
  return String(text).replace(/[&<>"']/g, (c) => `&#${c.charCodeAt(0)};`);
}
