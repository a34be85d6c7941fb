// The page: what is shown, what is pressed, and the socket or the replay behind it.
const $ = (id) => document.getElementById(id);
const root = document.documentElement;
const LIVE = START.mode === "live";
const TOKEN = new URLSearchParams(location.search).get("token");
const WITH = TOKEN ? `?token=${encodeURIComponent(TOKEN)}` : "";

function store(key, value) {
  try { if (value === undefined) return localStorage.getItem(key); localStorage.setItem(key, value); } catch { /* a file of its own has none */ }
  return null;
}

const canvas = $("sea");
const gl = canvas.getContext("webgl2", { antialias: true, alpha: false, powerPreference: "high-performance", preserveDrawingBuffer: true, xrCompatible: false });
if (!gl) { $("coverText").textContent = "This browser has no WebGL 2, which draws the sea."; throw new Error("no WebGL 2"); }
gl.getExtension("EXT_color_buffer_float");
gl.getExtension("EXT_color_buffer_half_float");
gl.getExtension("OES_texture_float_linear");
gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);

const painter = new Painter(gl), camera = new Camera(), plots = new Plots($("plots"));
const state = {
  worlds: [], content: "water", lines: true, rig: true, mirror: true, me: 0, holder: 0, watchers: 0, drives: true,
  panel: null, paused: true, connected: false, scale: 1, replays: [], time: 0, speed: 1, drawn: 0, frames: 0,
  throttle: 0, rudder: 0, steered: -1e9, picking: false, dirty: true, back: false, begin: 0, end: 0,
};

// --- what comes in ------------------------------------------------------------------------------------------------------

function begin(stills) {
  for (const world of state.worlds) world.free();
  state.worlds = stills.map((still) => new World(gl, painter, still));
  const first = state.worlds[0], still = first.still;
  if (state.panel?.sea) still.sea = state.panel.sea;  // as sliders have set it
  $("title").textContent = state.worlds.length > 1 ? START.runs.map((run) => run.name).join("  |  ") : still.title;
  $("title").title = stills.map((one) => one.title).join(" | ");
  $("count").hidden = !still.particles && still.fluid === "";
  const counts = stills.map((one) => (one.particles ? `${one.particles.toLocaleString("en")} particles` : one.fluid.replaceAll("_", " ")));
  $("count").textContent = [...new Set(counts)].join("  |  ");
  $("showSea").checked = first.sea;
  $("showSea").parentElement.hidden = still.tank;  // water goes on around no tank
  $("showMirror").parentElement.hidden = !first.ships.length;
  $("steering").hidden = !LIVE || !state.drives || !first.ships.some((ship) => ship.steered);
  if ($("arrows")) $("arrows").textContent = $("steering").hidden ? "turn the view" : "steer a ship";  // on a first visit, with keys
  $("rigCheck").hidden = $("ridesCheck").hidden = !still.platform;
  plots.begin(state.worlds.map((world, k) => ({ scalars: world.still.scalars, name: START.runs?.[k]?.name || world.still.title, spacing: world.still.particles && world.still.spacing })));
  const contents = [...(still.surface ? ["water"] : []), ...(still.particles ? ["particles"] : []), ...(still.surface && still.particles ? ["both"] : [])];
  if (!contents.includes(state.content)) state.content = contents[0] || "water";
  segments($("contents"), contents, () => state.content, (name) => { state.content = name; state.dirty = true; });
  const modes = camera.modes(first);
  if (!modes.includes(camera.mode)) camera.mode = modes[0];
  segments($("cameras"), modes, () => camera.mode, (name) => { camera.mode = name; camera.turn = camera.tilt = 0; state.dirty = true; });
  camera.ship = Math.min(camera.ship, Math.max(first.ships.length - 1, 0));
  $("whichShip").hidden = first.ships.length < 2;
  $("whichShip").innerHTML = first.ships.map((ship, k) => `<option value="${k}">${escaped(ship.name)}</option>`).join("");
  $("whichShip").value = camera.ship;
  $("windText").textContent = still.windStylised ? " This one is a stylised force field, thousands of times stronger than a real wind; stress is a real one." : "";
  $("wavesText").textContent = sayWaves(still);
  const words = [["wavemaker", "#cc7533", still.plates], ["absorbs waves", "#c9b878", still.zones.length], ["gauge", "#d81f59", Object.keys(still.gauges).length]].filter(([, , there]) => there);
  $("things").innerHTML = words.map(([word, hue]) => `<span style="--hue:${hue}">${word}</span>`).join("");
  $("things").hidden = !words.length || state.worlds.length > 1;
  const tints = still.speeds.map((rgb) => `rgb(${rgb.map((v) => Math.round(255 * v))})`);
  document.querySelector("#legend i").style.background = `linear-gradient(90deg, ${tints})`;
  $("strip").hidden = state.worlds.length > 1;
  offerLines();
  helmBar();
  state.dirty = true;
}

// Lines are offered where there are any: of a basin that is no piece of sea, or of a wind.
function offerLines() {
  const { surfaces, still } = state.worlds[0];
  $("showLines").parentElement.hidden = !!surfaces.sea && !still.tank && (state.panel ? state.panel.wind === "still" : still.windAngle === null);
}

// The value of a slider by the first words of its label, as it stands now.
function slid(words) { return state.panel?.sliders.find((s) => s.label.startsWith(words))?.value; }

function sayWaves({ plates, waves: { kind, height, period, significant_wave_height: high, peak_period: peak } }) {
  const [tall, long] = [slid("wave height") ?? high ?? height, slid("wave period") ?? peak ?? period].map((v) => v && +v.toPrecision(3));
  const towards = slid("wave heading"), heading = towards === undefined ? "" : `, heading ${Math.round(towards)}°`;
  const origin = plates ? ", made by the wavemaker." : state.panel?.wind === "still" || slid("wind strength") === 0 ? ". They are swell: no wind blows here." : ".";
  if (high) return `Waves: ${kind.toUpperCase()}, significant height ${tall} m, peak period ${long} s${heading}${origin}`;
  if (height) return `Waves: regular, ${tall} m high, period ${long} s${heading}${origin}`;
  return "";
}

function segments(box, names, now, choose) {
  const words = { water: "Water", particles: "Particles", both: "Both", orbit: "Orbit", follow: "Follow", helm: "Helm", top: "Top", side: "Side" };
  box.innerHTML = names.map((name) => `<button role="radio" data-name="${name}">${words[name]}</button>`).join("");
  box.hidden = names.length < 2;
  const mark = () => { for (const b of box.children) b.setAttribute("aria-checked", b.dataset.name === now()); };
  for (const b of box.children) b.onclick = () => { choose(b.dataset.name); mark(); };
  box.mark = mark;
  box.pick = (name) => { if (names.includes(name)) { choose(name); mark(); } };
  mark();
}

const live = {
  queue: [], arrived: 0, gap: 0.05, history: new History(),

  open() {
    const address = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/watch${WITH}`;
    const socket = this.socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => { this.tries = 0; state.connected = true; link(); };
    socket.onclose = (event) => {
      state.connected = false;
      link();
      if (event.code === 1008 && event.reason) say(event.reason, true);
      this.tries = (this.tries || 0) + 1;
      setTimeout(() => this.open(), Math.min(500 * 1.6 ** this.tries, 8000));
    };
    this.chain = Promise.resolve();
    socket.onmessage = (event) => { this.chain = this.chain.then(() => this.take(event.data)).catch((error) => { console.error(error); say(String(error), true); }); };
  },

  async take(data) {
    if (typeof data === "string") return heard(JSON.parse(data));
    const packet = await inflated(data), head = unpack(packet);
    if (head.kind === "still") {
      if (head.protocol !== 1) throw new Error("the server speaks another version; load the page again");
      this.queue = [];
      this.history.clear();
      toLive();
      begin([head]);
      this.past(state.worlds[0]).catch(console.error);
    } else if (head.kind === "frame") {
      const now = performance.now() / 1000, last = this.queue[this.queue.length - 1];
      if (last) this.gap += 0.1 * (clamp(now - this.arrived, 0.01, 0.4) - this.gap);
      this.arrived = now;
      head.at = now;
      if (last && head.time < last.time) this.queue = [];
      this.queue.push(head);
      if (this.queue.length > 6) this.queue.shift();
      this.history.add(head.time, packet);
      if (head.data.trail) state.worlds[0].recall(head.data.trail, head.about.trail.shape);
      if (head.data.poses) state.worlds[0].follow(head.time, head.data.poses, WAKE_SECONDS + HISTORY_SECONDS);
      plots.add(0, head.time, head.data.scalars);
      state.frames++;
      numbers(head);
      state.dirty = true;
    }
  },

  // What other pages saw before this one opened, or this one before it was loaded again: for plots and for the bar that goes back.
  async past(world) {
    const buffer = await (await fetch(`/past${WITH}`)).arrayBuffer(), { history } = this, kept = [];
    for (let at = 0; at < buffer.byteLength;) {
      const { time, end } = unpack(buffer, at);
      kept.push([time, buffer.slice(at, end)]);
      at = end;
    }
    if (state.worlds[0] !== world) return;
    const moments = kept.filter(([time]) => !(time >= history.times[0])).concat(history.times.map((time, k) => [time, history.packets[k]]));
    history.clear();
    for (const [time, packet] of moments) history.add(time, packet);
    plots.begin([plots.sets[0]]);
    history.packets.forEach((packet, k) => plots.add(0, history.times[k], unpack(packet).data.scalars));
  },

  // The moment to show: a frame's length behind the newest, so that there is one on both sides.
  show(now) {
    const { queue } = this, world = state.worlds[0];
    if (!queue.length || !world) return false;
    const at = now - this.gap * 1.15;
    while (queue.length > 2 && queue[1].at <= at) queue.shift();
    const [a, b] = queue.length > 1 ? queue : [queue[0], queue[0]], span = b.at - a.at;
    world.show(a, b, span > 0 ? clamp((at - a.at) / span, 0, 1) : 1);
    return at < queue[queue.length - 1].at + 0.2;
  },
};

function send(message) {
  if (LIVE && state.connected && live.socket.readyState === 1) live.socket.send(JSON.stringify(message));
}

function heard(message) {
  switch (message.type) {
    case "hello": state.me = message.you; state.drives = message.drives; document.body.classList.toggle("passive", !message.drives); tabs(); send({ do: "scene" }); break;
    case "helm": state.holder = message.holder; state.watchers = message.watchers; helmBar(); link(); break;
    case "panel": panel(message); break;
    case "problems": editor.show(message.problems); if (message.problems.length) editor.number(); break;
    case "scene":
      $("sceneName").textContent = `${message.name}.yaml`;
      $("sceneSets").textContent = message.sets.length ? `with ${message.sets.join(", ")}` : "";
      if (editor.text.value === editor.original || !editor.original) editor.load(message.text);
      break;
    case "scenes": scenes(message.rows); break;
    case "keys": keyRows(message.rows); break;
    case "said": say(message.text, message.bad); break;
  }
}

// Look back: the last minute as it was, while the simulation goes on.
function lookBack(share) {
  const { history } = live;
  if (share > 0.995 || history.times.length < 2) { toLive(); return; }
  if (!state.back) state.replays = [history];
  state.back = true;
  pausedIs(true);
  span();
  seek(state.begin + share * (state.end - state.begin));
}

function span() { [state.begin, state.end] = [live.history.times[0], live.history.end]; }

function toLive() {
  if (!state.back) return;
  state.back = false;
  state.replays = [];
  pausedIs(state.panel?.paused ?? false);
  state.dirty = true;
}

function link() {
  const chip = $("link");
  chip.hidden = !LIVE;
  chip.classList.toggle("off", !state.connected);
  doing();
  helmBar();
  if (!state.worlds.length) $("coverText").textContent = state.connected ? "Building the sea ..." : "Looking for the server ...";
}

// Whether the simulation goes on, beside the title.
function doing() {
  const { panel } = state, what = !state.worlds.length ? `building, ${short(performance.now() / 1000)} s` : state.back ? "looking back" : !panel?.paused ? "live" : Math.abs(live.history.end - panel.duration) < 0.1 ? "scene's end" : "paused";
  $("link").classList.toggle("still", !!panel?.paused);
  $("link").textContent = !state.connected ? "looking for the server" : state.watchers > 1 ? `${what}, ${state.watchers} watching` : what;
}

function say(text, bad) {
  const box = $("said");
  clearTimeout(say.timer);
  if (!text) { box.classList.remove("on"); return; }
  box.textContent = text;
  box.classList.toggle("bad", !!bad);
  box.classList.add("on");
  say.timer = setTimeout(() => box.classList.remove("on"), bad ? 8000 : 4500);
}

const PACE_SECONDS = 5;  // of wall time, that the pace is the mean of
let lately = [];  // frames of this time, without a pause or another speed asked for

function paceWords({ at, time }) {
  if (lately.length && (time < lately[0].time || lately[0].speed !== state.speed)) lately = [];
  lately.push({ at, time, speed: state.speed });
  while (lately.length > 2 && lately[1].at <= at - PACE_SECONDS) lately.shift();
  const wall = at - lately[0].at, pace = (time - lately[0].time) / wall;
  if (wall < 1) return "measuring ...";
  if (state.speed && pace >= 0.97 * state.speed) return "keeps up";
  return `${pace < 9.95 ? pace.toPrecision(2) : pace.toFixed(0)} × real time`;
}

function numbers(head) {
  $("pace").hidden = state.paused;
  $("pace").textContent = head.time ? paceWords(head) : "compiling ...";
  if (performance.now() - state.steered < 1500) return;
  const throttle = reading(head, "throttle", "") / 100, rudder = reading(head, "rudder", "");
  if (Number.isNaN(throttle) || (throttle === state.throttle && rudder === state.steeredTo)) return;
  Object.assign(state, { throttle, rudder: (rudder * Math.PI) / 180, steeredTo: rudder });
  helmShows();
}

// A plotted number of the ship that is followed, or of all.
function reading(head, group, word) {
  const { scalars, ships } = state.worlds[0].still, whose = ships.length > 1 && group !== "height" ? ` ${ships[camera.ship].name}` : "";
  const at = scalars.findIndex((s) => s.group === group && s.label.startsWith(word) && s.label.endsWith(whose));
  return at < 0 ? undefined : head.data.scalars?.[at];
}

const fixed = (value) => (Math.round(10 * value) / 10 || 0).toFixed(1);  // never -0.0

// An angle with its side, however many turns a curve has counted.
function sided(angle) {
  const degrees = angle - 360 * Math.round(angle / 360);
  return `${Math.abs(degrees).toFixed(0)}°${Math.abs(degrees) < 0.5 ? "" : degrees > 0 ? " port" : " starboard"}`;
}

// Mean time between two rises of the first gauge through its mean, in the last minute [s].
function crossingPeriod() {
  const { times, rows, scalars } = plots.sets[0], at = scalars.findIndex((s) => s.group === "elevation"), now = nearest(times, state.time);
  const from = nearest(times, state.time - 60), mean = rows.slice(from, now).reduce((sum, row) => sum + row[at], 0) / Math.max(now - from, 1);
  const rises = [];
  for (let k = from + 1; k <= now && at >= 0; k++) if (rows[k - 1][at] < mean && rows[k][at] >= mean) rises.push(times[k]);
  return rises.length > 5 ? (rises[rises.length - 1] - rises[0]) / (rises.length - 1) : undefined;
}

function instruments() {
  const world = state.worlds[0], head = world?.after;
  if (!head || $("strip").hidden) return;
  const { still } = world, { waves, exact } = still.sea, ship = world.ships[camera.ship], rows = [];
  const add = (name, value, more, few) => rows.push(`<div${few ? ' class="few"' : ""}><dt>${name}</dt><dd>${value}</dd><small>${more}</small></div>`);
  const eye = world.seen?.view || M.one(), ahead = Math.atan2(eye[1] - eye[2], eye[9] - eye[10]);  // the top of the compass
  const turn = (id, angle) => { for (const one of [$(id), $(`${id}Word`)]) one.style.display = angle === null ? "none" : ""; $(id).setAttribute("transform", `rotate(${((ahead - (angle ?? 0)) * 180) / Math.PI})`); };
  turn("rose", 0);
  [...document.querySelectorAll("#rose text")].forEach((letter, k) => letter.setAttribute("transform", `rotate(${90 * k}) translate(0 -46.5) rotate(${-90 * k - (ahead * 180) / Math.PI})`));
  turn("shipMark", ship?.steered ? Math.atan2(ship.pose[8], ship.pose[10]) : null);
  $("strip").classList.toggle("bare", !(ship?.steered || (exact && waves.length) || still.windAngle !== null));
  const going = [1, 2].map((k) => waves.reduce((sum, wave) => sum + wave[0] ** 2 * wave[k], 0));
  turn("seaMark", exact && waves.length ? Math.atan2(...going) : null);
  turn("windMark", still.windAngle === null ? null : 0.5 * Math.PI - still.windAngle);
  if (ship?.steered) {
    const speed = reading(head, "speed", ""), rudder = reading(head, "rudder", "");
    if (speed !== undefined) add("Speed", `${fixed(speed / 0.514444)} kn`, `${fixed(speed)} m/s`);
    add("Heading", sided((Math.atan2(ship.pose[8], ship.pose[10]) * 180) / Math.PI), "of north (+z)");
    if (rudder !== undefined) add("Rudder", ...`${sided(rudder)} `.split(" "));
  }
  const regular = (exact && waves.length === 1) || !!(still.waves.height && still.waves.period);
  const high = regular && exact ? 2 * waves[0][0] : (reading(head, "height", "") ?? world.height) / (regular ? Math.SQRT2 : 1);  // of a sine
  const stated = slid("wave period") || still.waves.peak_period || still.waves.period, period = stated || crossingPeriod();
  if (high > 0.005 && (exact || stated || still.windSpeed || world.ships.length)) {
    add(regular ? "H" : "H<sub>s</sub>", `${high.toFixed(high < 1 ? 2 : 1)} m`, regular && exact ? "of the wave" : still.sea.ramp > world.time ? "growing" : "now");
    if (period) add(regular ? "T" : stated ? "T<sub>p</sub>" : "T<sub>z</sub>", `${period.toFixed(1)} s`, stated ? "stated" : "at the gauge", true);
  }
  add("Depth", `${+(-still.basin.lower[1]).toPrecision(3)} m`, "", !!ship?.steered);
  const strength = slid("wind strength") ?? 1;
  const told = still.windStylised ? "drift" : "stated";
  if (still.windSpeed) add(still.windStylised ? "Gusts" : "Wind", `${still.windSpeed.toFixed(1)} m/s`, strength === 1 ? told : `${told}, × ${short(strength)}`, true);
  $("readings").innerHTML = rows.join("");
  $("legend").hidden = state.content === "water" || !world.balls.count;
  if (!$("legend").hidden) {
    const top = world.balls.fastest;
    document.querySelector("#legend b").innerHTML = [0, 0.5 * top, top].map((v) => `<span>${+v.toPrecision(2)}</span>`).join("");
  }
  $("helmWord").textContent = state.back ? "Helm, as it is now" : state.paused ? "Helm, when play goes on" : "Helm";
  $("scrubBar").hidden = LIVE && !(live.history.end - live.history.times[0] > 0.2);
  $("toLive").hidden = !state.back;
  if (!LIVE) return;
  doing();
  if (state.back) span();
  $("scrub").value = state.back ? (1000 * (state.time - state.begin)) / (state.end - state.begin) : 1000;
  const length = live.history.end - live.history.times[0];
  $("ago").textContent = state.back ? `${(state.end - state.time).toFixed(1)} s ago` : `last ${length < 9.95 ? length.toFixed(1) : Math.round(length)} s`;
}

// A length on the water, where one looks straight down.
function scaleBar() {
  const eye = camera.mode === "top" && state.worlds.length === 1 && state.worlds[0].seen;
  $("scale").hidden = !eye;
  if (!eye) return;
  const metres = (2 * Math.tan(eye.angle / 2) * V.length(V.sub(eye.position, eye.target))) / canvas.clientHeight, length = round(60 * metres);
  $("scale").textContent = `${+length.toPrecision(1)} m`;
  $("scale").style.width = `${length / metres}px`;
}

// A first visit gets three lines.
function greet() {
  if (store("greeted")) return;
  $("first").hidden = false;
  if (matchMedia("(pointer: coarse), (hover: none) and (max-width: 820px)").matches) $("first").querySelector("ul").innerHTML = `<li><b>Drag</b> to look around; two fingers move, a pinch comes nearer</li><li>${LIVE ? "The panel (top right) has the controls, plots and scenes" : "The bar goes to any time"}</li>`;
  else if (!LIVE) $("first").querySelector("ul").innerHTML = "<li><b>Space</b> pauses; the bar goes to any time</li><li><b>Drag</b> to look around, 1 to 5 choose a camera</li><li><b>?</b> lists all keys</li>";
  const done = (event) => {
    if (event.key === "Tab") return;
    $("first").hidden = true;
    store("greeted", "1");
    removeEventListener("keydown", done);
  };
  $("firstDone").onclick = done;
  addEventListener("keydown", done);
}

// --- panel --------------------------------------------------------------------------------------------------------------

const TABS = { play: "Controls", plots: "Plots", scene: "Scene", scenes: "Scenes", keys: "All keys" };
function tabs() {
  const names = LIVE && state.drives ? ["play", "plots", "scene", "scenes", "keys"] : ["play", "plots"];
  $("tabs").innerHTML = names.map((name) => `<button role="tab" id="to-${name}" aria-controls="tab-${name}">${TABS[name]}</button>`).join("");
  for (const name of names) $(`to-${name}`).onclick = () => tab(name);
  $("tabs").onkeydown = (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    event.stopPropagation();
    const at = names.indexOf(state.tab), next = names[(at + step + names.length) % names.length];
    tab(next);
    $(`to-${next}`).focus();
  };
  tab(names.includes(state.tab) ? state.tab : LIVE ? "play" : "plots");
}

function tab(name) {
  state.tab = name;
  for (const section of document.querySelectorAll("#panel section")) section.hidden = section.id !== `tab-${name}`;
  for (const button of $("tabs").children) {
    button.setAttribute("aria-selected", button.id === `to-${name}`);
    button.tabIndex = button.id === `to-${name}` ? 0 : -1;
  }
  document.body.classList.toggle("wide", name === "scene");
  for (const list of ["keys", "scenes"]) if (name === list && !$(list).childElementCount) $(list).innerHTML = `<p class="hint">The ${list} are on their way ...</p>`;
  if (name === "scenes") send({ do: "scenes" });
  if (name === "keys") send({ do: "keys" });
  if (name === "scene") {
    send({ do: "scene" });
    if (!editor.schema) fetch(`/schema${WITH}`).then((reply) => reply.json()).then((schema) => { editor.schema = schema; }).catch(() => {});
  }
  if (name === "plots") plots.draw(state.time, state.back);
}

function mayTouch() { return !LIVE || state.holder === 0 || state.holder === state.me; }

function helmBar() {
  const other = LIVE && !mayTouch();
  $("helmBar").hidden = !other;
  const away = LIVE && !(state.connected && state.worlds.length);
  for (const one of document.querySelectorAll("#tab-play input, #tab-play select, #go, #one, #reset, #speed, #apply, #record")) {
    if (!one.closest(".group:has(#showLines)")) one.disabled = away || other || (LIVE && !state.drives && ["go", "one", "reset", "speed", "record"].includes(one.id));
  }
}

function panel(now) {
  state.panel = now;
  if (!state.back) pausedIs(now.paused);
  speeds(now.speed);
  $("wind").innerHTML = now.winds.map((name) => `<option value="${escaped(name)}"${name === now.wind ? " selected" : ""}>${name === "still" ? "still: no wind blows" : escaped(name)}</option>`).join("");
  $("windGroup").hidden = !state.drives;
  if (state.worlds[0]) $("wavesText").textContent = sayWaves(state.worlds[0].still);
  $("message").hidden = !now.message;
  $("message").textContent = now.message;
  $("record").textContent = now.recording ? "Stop recording" : "Record a run";
  $("record").classList.toggle("on", !!now.recording);
  const box = $("sliders"), key = now.sliders.map((s) => `${s.label} ${s.low} ${s.high}`).join();
  if (box.dataset.key !== key) {
    box.dataset.key = key;
    const drawn = now.sliders.map((s, k) => `<label class="slider">${escaped(s.label)} <output></output>` +
      `<input type="range" min="0" max="1000" data-k="${k}"><small><span>${+s.low.toPrecision(4)}</span><span>${+s.high.toPrecision(4)}</span></small></label>`);
    const [sea, physics] = [true, false].map((air) => drawn.filter((_, k) => /^(wind|wave)/.test(now.sliders[k].label) === air).join(""));
    box.innerHTML = (sea || `<p class="hint">${physics ? "Wind and waves stay as they are while it runs." : "Nothing can be changed while it runs."} To change them, use the tab All keys, which restarts the scene.</p>`) +
      (physics && `<details><summary>Physics</summary>${physics}</details>`);
    for (const input of box.querySelectorAll("input")) {
      const s = now.sliders[input.dataset.k];
      input.setAttribute("aria-label", s.label);
      input.oninput = () => {
        const value = s.low + (input.value / 1000) * (s.high - s.low);
        input.closest("label").querySelector("output").textContent = short(value);
        send({ do: "slide", key: s.label, value });
      };
    }
  }
  for (const input of box.querySelectorAll("input")) {
    const s = now.sliders[input.dataset.k];
    if (document.activeElement !== input) {
      input.value = (1000 * (s.value - s.low)) / (s.high - s.low);
      input.closest("label").querySelector("output").textContent = short(s.value);
    }
  }
  const ship = now.ships[camera.ship], world = state.worlds[0];
  if (world) offerLines();
  if (ship && world) world.route = ship.route;
  if (world && now.sea) world.still.sea = now.sea;
  helmBar();
  state.dirty = true;
}

function pausedIs(paused) {
  if (paused !== state.paused) lately = [];
  state.paused = paused;
  $("go").setAttribute("aria-label", paused ? "Play" : "Pause");
  $("goShape").setAttribute("d", paused ? "M7 4l13 8-13 8z" : "M7 5h4v14H7zM13 5h4v14h-4z");
  if (paused) $("pace").hidden = true;
}

function speeds(now) {
  const values = LIVE ? [0.1, 0.25, 0.5, 1, 2, 4, 0] : [0.1, 0.25, 0.5, 1, 2, 4, 8];
  if (!values.includes(now)) values.unshift(now);
  $("speed").innerHTML = values.map((v) => `<option value="${v}"${v === now ? " selected" : ""}>${v ? `${v} ×` : "max"}</option>`).join("");
  state.speed = now;
}

function helmShows() {
  const degrees = (state.rudder * 180) / Math.PI;
  $("rudder").value = -degrees;
  $("throttle").value = state.throttle;
  $("rudderOut").textContent = sided(degrees);
  $("throttleOut").textContent = `${Math.round(100 * state.throttle)} %`.replace("-", "−");
  $("wheelTurn").setAttribute("transform", `rotate(${-degrees * WHEEL_TURN})`);
}

function steer(throttle, rudder) {
  const world = state.worlds[0], ship = world?.ships[camera.ship];
  if (!ship || !LIVE || !mayTouch()) return;
  toLive();
  if (state.paused) say("Paused: she answers when play goes on (Space).");
  state.throttle = clamp(throttle, -1, 1);
  state.rudder = clamp(rudder, -0.611, 0.611);
  state.steered = performance.now();
  world.route = [];
  helmShows();
  // While a key or a stick is held, the newest order goes out every 30 ms.
  steer.timer ||= setTimeout(() => { steer.timer = 0; send({ do: "steer", ship: ship.name, throttle: state.throttle, rudder: state.rudder }); }, 30);
}

// Packaged scenes: the gallery first, those with pictures before others, and none of a benchmark.
function scenes(rows) {
  const plain = (text) => escaped(text.replaceAll("`", "")), order = (r) => 2 * !/^(gallery\/|showcase)/.test(r.name) + !r.picture;
  rows = rows.filter((r) => !r.name.startsWith("bench/")).sort((a, b) => order(a) - order(b));
  const draw = () => {
    const find = $("sceneFilter").value.toLowerCase();
    $("scenes").innerHTML = rows.filter((r) => `${r.name} ${r.sentence}`.toLowerCase().includes(find)).map((r) =>
      `<li><button data-name="${escaped(r.name)}">${r.picture ? `<img data-file="${escaped(r.picture)}" alt="">` : ""}<b>${plain(r.sentence || r.name)}</b><span>${escaped(r.name)}</span></button></li>`).join("");
    for (const img of $("scenes").querySelectorAll("img")) img.src = `/${img.dataset.file}${WITH}`;
    for (const b of $("scenes").querySelectorAll("button")) b.onclick = () => { editor.original = editor.text.value; send({ do: "open", name: b.dataset.name }); say("Building the scene ..."); };
  };
  $("sceneFilter").oninput = draw;
  draw();
}

function keyRows(rows) {
  const draw = () => {
    const find = $("keyFilter").value.toLowerCase(), shown = rows.filter((r) => `${r.key} ${r.meaning}`.toLowerCase().includes(find)).slice(0, 120);
    $("keys").innerHTML = shown.map((r, k) => {
      const now = String(r.value), words = r.value === null && r.choices.length ? [...r.choices, "null"] : r.choices, label = `aria-label="${escaped(r.key)}"`;
      const field = words.includes(now) ? `<select data-k="${k}" ${label}>${words.map((w) => `<option${w === now ? " selected" : ""}>${escaped(w)}</option>`).join("")}</select>`
        : `<input data-k="${k}" ${label} value="${escaped(r.value ?? "")}" placeholder="${r.value === null ? "open" : ""}">`;
      return `<div class="key"><code>${escaped(r.key)}${r.unit && r.unit !== "1" ? ` [${escaped(r.unit)}]` : ""}</code>${field}<p>${escaped(`${r.meaning} ${r.range}`.replaceAll("`", ""))}</p></div>`;
    }).join("");
    for (const field of $("keys").querySelectorAll("[data-k]")) field.onchange = () => {
      const r = shown[field.dataset.k];
      send({ do: "change", key: r.key, value: String(field.value).trim() || "null" });
      say(`${r.key}: building anew ...`);
    };
  };
  $("keyFilter").oninput = draw;
  draw();
}

const editor = new Editor(document.querySelector(".editor"), send);
$("apply").onclick = () => { send({ do: "apply", text: editor.text.value }); editor.original = editor.text.value; };
$("revert").onclick = () => { editor.load(editor.original); send({ do: "scene" }); };
$("save").onclick = () => {
  const name = $("saveName").value.trim();
  if (!/^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$/.test(name)) { say("A name has letters, digits, _ and -, at most 64.", true); return; }
  send({ do: "save", name });
};
$("takeHelm").onclick = () => send({ do: "take" });
$("wind").onchange = () => { send({ do: "wind", name: $("wind").value }); say("Building with another wind ..."); };
$("rudder").oninput = () => steer(state.throttle, (-$("rudder").value * Math.PI) / 180);
$("throttle").oninput = () => steer(+$("throttle").value, state.rudder);
$("amidships").onclick = () => steer(state.throttle, 0);
$("whichShip").onchange = () => { camera.ship = +$("whichShip").value; if (state.panel) panel(state.panel); state.dirty = true; };
$("routeMode").onclick = () => picking(!state.picking);
$("routeClear").onclick = () => { const world = state.worlds[0]; world.route = []; sail(world.ships[camera.ship].name, []); };
$("routeSpeed").onchange = () => { const world = state.worlds[0]; if (world?.route?.length) sail(world.ships[camera.ship].name, world.route); };
$("record").onclick = () => send({ do: state.panel?.recording ? "stop" : "record" });
$("still").onclick = still;
$("csv").onclick = () => keep(new Blob([plots.csv()], { type: "text/csv" }), "curves.csv");
$("film").onclick = film;
$("copy").onclick = () => {
  const address = `${location.href.split("#")[0]}#${camera.mode},${state.content}`;
  (navigator.clipboard?.writeText(address) ?? Promise.reject()).then(() => say("The link is copied."), () => say(address));
};
$("toLive").onclick = toLive;
$("go").onclick = go;
$("one").onclick = () => { if (LIVE && !state.back) send({ do: "step" }); else { pausedIs(true); const r = state.replays[0]; seek(r.times[Math.min(r.before(state.time) + 1, r.times.length - 1)] + 1e-6); } };
$("reset").onclick = () => { toLive(); if (LIVE) { send({ do: "reset" }); } else seek(state.begin); };
$("speed").onchange = () => { state.speed = +$("speed").value; send({ do: "speed", value: state.speed }); };
$("theme").onclick = () => theme(root.dataset.theme === "light" ? "dark" : "light");
$("fold").onclick = () => { const folded = document.body.classList.toggle("folded"); $("fold").setAttribute("aria-expanded", !folded); state.dirty = true; };
$("ask").onclick = () => $("help").showModal();
$("showLines").onchange = () => { state.lines = $("showLines").checked; state.dirty = true; };
$("showMirror").onchange = () => { state.mirror = $("showMirror").checked; state.dirty = true; };
$("showRig").onchange = () => { state.rig = $("showRig").checked; state.dirty = true; };
$("rides").onchange = () => { state.rides = $("rides").checked; };
$("showSea").onchange = () => { for (const world of state.worlds) { world.sea = $("showSea").checked && !!world.surfaces.sea; } state.dirty = true; };
$("scrub").oninput = () => { if (LIVE) { lookBack($("scrub").value / 1000); return; } pausedIs(true); seek(state.begin + ($("scrub").value / 1000) * (state.end - state.begin)); };

function theme(name) { root.dataset.theme = name; store("theme", name); state.dirty = true; }
theme(new URLSearchParams(location.search).get("theme") || store("theme") || (matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark"));

function go() {
  if ($("go").disabled) return;
  if (LIVE && !state.back) { send({ do: state.paused ? "play" : "pause" }); pausedIs(!state.paused); return; }
  if (state.paused && state.time >= state.end - 1e-6) seek(state.begin);
  pausedIs(!state.paused);
}

function picking(on) {
  state.picking = on;
  $("routeMode").setAttribute("aria-pressed", on);
  canvas.classList.toggle("aim", on);
  $("cross").hidden = !on;
  if (!on) return;
  const [x, y] = middle();
  $("cross").style.left = `${x}px`;
  $("cross").style.top = `${y}px`;
  const world = state.worlds[0], speed = reading(world.after, "speed", "");
  if (!world.route.length && speed > 0.5) $("routeSpeed").value = (Math.round(2 * speed) / 2).toFixed(1);
  say("Click on the water, waypoint by waypoint; or move the cross with Shift and W A S D, and press Enter.");
  canvas.focus();
}

// Pixels of the middle of what no panel hides.
function middle() {
  const box = $("panel").getBoundingClientRect(), folded = document.body.classList.contains("folded");
  return innerWidth > 820 ? [0.5 * (folded ? innerWidth : box.left), 0.5 * innerHeight] : [0.5 * innerWidth, 0.5 * (folded ? innerHeight : box.top)];
}

function overWater(x, y) { waypoint((2 * x) / innerWidth - 1, 1 - (2 * y) / innerHeight); }

function waypoint(x, y) {
  const world = state.worlds[0], ship = world.ships[camera.ship], at = camera.hit(world.seen, x, y, world.level);
  if (!at || !ship || !mayTouch()) return;
  world.route = [...world.route, [+at[0].toFixed(2), +at[2].toFixed(2)]];
  sail(ship.name, world.route);
}

function sail(ship, points) {
  if (state.paused && points.length) say("Paused: she sails when play goes on (Space).");
  send({ do: "route", ship, points, speed: clamp(+$("routeSpeed").value || 3, 0.5, 50) });
}

function keep(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 2000);
}

function fileName(kind) {
  const title = state.worlds[0].still.title.toLowerCase().replace(/[^a-z0-9]+/g, "_").slice(0, 60);
  return `${title}_${state.time.toFixed(2)}s.${kind}`;
}

// What is seen as a film, from one press of the button to the next.
function film() {
  if (film.tape) { film.end(); return; }
  const kind = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"].find((one) => window.MediaRecorder?.isTypeSupported(one));
  if (!kind) { say("This browser cannot record a film.", true); return; }
  const tape = film.tape = new MediaRecorder(canvas.captureStream(30), { mimeType: kind, videoBitsPerSecond: 8e6 }), parts = [];
  const mark = (on) => { $("film").classList.toggle("on", on); $("film").textContent = on ? "Stop the film" : "Film (WebM)"; };
  let ends = false;
  film.end = () => {
    if (ends || parts.some((part) => part.size)) { tape.stop(); return; }
    ends = true;
    say("The film ends with its first picture; press again to end it without.");
  };
  tape.ondataavailable = (event) => { parts.push(event.data); if (ends && event.data.size && tape.state === "recording") tape.stop(); };
  tape.onstop = () => {
    const whole = new Blob(parts, { type: "video/webm" });
    film.tape = null;
    mark(false);
    if (whole.size) keep(whole, fileName("webm")); else say("The film has no picture: this browser drew none while it ran.", true);
  };
  tape.start(1000);
  mark(true);
}
// A still picture, sharp and with its middle in the middle, whatever the live one is.
function still() {
  if (!state.worlds.length) return;
  const { scale } = state;
  if (!film.tape) state.scale = 1;  // a film keeps its size
  draw([1, 1, 0, 0]);
  const name = fileName("png");
  canvas.toBlob((blob) => keep(blob, name));
  Object.assign(state, { scale, dirty: true });
}

// --- mouse, fingers, keys -----------------------------------------------------------------------------------------------

const fingers = new Map();
canvas.onpointerdown = (event) => {
  canvas.setPointerCapture(event.pointerId);
  fingers.set(event.pointerId, { x: event.clientX, y: event.clientY, button: event.button, moved: 0 });
};
canvas.onpointermove = (event) => {
  const finger = fingers.get(event.pointerId);
  if (!finger) return;
  const right = (event.clientX - finger.x) / innerHeight, down = (event.clientY - finger.y) / innerHeight;
  finger.moved += Math.hypot(right, down);
  if (fingers.size === 2) {
    const [a, b] = [...fingers.values()], before = Math.hypot(a.x - b.x, a.y - b.y);
    finger.x = event.clientX;
    finger.y = event.clientY;
    camera.nearer(before / Math.max(Math.hypot(a.x - b.x, a.y - b.y), 1));
    camera.pan(0.5 * right, 0.5 * down);
  } else {
    finger.x = event.clientX;
    finger.y = event.clientY;
    if (finger.button === 2 || event.shiftKey) camera.pan(right, down); else camera.drag(right, down);
  }
  state.dirty = true;
};
canvas.onpointerup = canvas.onpointercancel = (event) => {
  const finger = fingers.get(event.pointerId);
  fingers.delete(event.pointerId);
  if (state.picking && finger && finger.moved < 0.01 && event.type === "pointerup") {
    overWater(event.clientX, event.clientY);
  }
};
canvas.oncontextmenu = (event) => event.preventDefault();
canvas.addEventListener("wheel", (event) => { event.preventDefault(); camera.nearer(Math.exp(0.0012 * event.deltaY)); state.dirty = true; }, { passive: false });

let wheelHeld = null;
$("wheel").onpointerdown = (event) => { $("wheel").setPointerCapture(event.pointerId); wheelHeld = event.clientX; };
$("wheel").onpointermove = (event) => { if (wheelHeld !== null) { steer(state.throttle, state.rudder - 0.006 * (event.clientX - wheelHeld)); wheelHeld = event.clientX; } };
$("wheel").onpointerup = $("wheel").onpointercancel = () => { wheelHeld = null; };

const down = new Set();
let moves = false;  // whether held keys move the view in place of turning it
addEventListener("keydown", (event) => {
  const typing = event.target.closest("input:not([type=range]), textarea, select, dialog");
  if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
  const onButton = event.target.closest("button, input");
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  if (onButton && (key === " " || key === "Enter" || key.startsWith("Arrow"))) return;
  const modes = ["orbit", "follow", "helm", "top", "side"];
  const acts = {
    " ": go, n: () => $("one").click(), r: () => $("reset").click(), c: () => camera.reset(), p: still, l: () => $("theme").click(), m: () => $("fold").click(),
    v: () => { const all = ["water", "particles", "both"].filter((n) => $("contents").querySelector(`[data-name=${n}]`)); $("contents").pick(all[(all.indexOf(state.content) + 1) % all.length]); },
    x: () => steer(state.throttle, 0), "?": () => $("help").showModal(),
    h: () => { const n = state.worlds[0]?.ships.length; if (n) { camera.ship = (camera.ship + 1) % n; $("whichShip").value = camera.ship; if (state.panel) panel(state.panel); } },
    ",": () => faster(-1), ".": () => faster(1), Enter: () => { if (state.picking) overWater(...middle()); },
  };
  moves = event.shiftKey;
  if (/^[1-5]$/.test(key)) $("cameras").pick(modes[key - 1]);
  else if (acts[key] && !event.repeat) acts[key]();
  else if (/^(Arrow(Up|Down|Left|Right)|[wasdqe])$/.test(key)) {
    down.add(key);
    if (!event.repeat) holdKeys(0.1);  // a tap counts, however long a picture takes
  }
  else return;
  event.preventDefault();
  state.dirty = true;
});
addEventListener("keyup", (event) => down.delete(event.key.length === 1 ? event.key.toLowerCase() : event.key));
addEventListener("blur", () => down.clear());

function faster(step) {
  const options = [...$("speed").options], at = $("speed").selectedIndex;
  $("speed").selectedIndex = clamp(at + step, 0, options.length - 1);
  $("speed").onchange();
}

function holdKeys(seconds) {
  if (!down.size) return;
  const has = (name) => (down.has(name) ? 1 : 0), ships = LIVE && state.worlds[0]?.ships.length;
  const ahead = has("ArrowUp") - has("ArrowDown"), port = has("ArrowLeft") - has("ArrowRight");
  if (ships && (ahead || port)) steer(state.throttle + 0.5 * seconds * ahead, state.rudder + 0.35 * seconds * port);
  const right = has("d") - has("a") - (ships ? 0 : port), up = has("w") - has("s") + (ships ? 0 : ahead);
  if (right || up) (moves ? camera.pan(-0.35 * seconds * right, 0.35 * seconds * up) : camera.drag(0.35 * seconds * right, 0.35 * seconds * up));
  if (has("q")) camera.nearer(0.4 ** seconds);
  if (has("e")) camera.nearer(2.5 ** seconds);
  state.dirty = true;
}

// A pad: left stick the wheel, right stick or triggers the throttle, the first button amidships.
function holdPad(seconds) {
  if (!LIVE || !state.worlds[0]?.ships.length || !navigator.getGamepads) return;
  for (const pad of navigator.getGamepads()) {
    if (!pad?.connected || pad.mapping !== "standard") continue;
    const past = (value) => (Math.abs(value || 0) > 0.15 ? value : 0), pressed = (n) => pad.buttons[n]?.value || 0;
    const ahead = pressed(7) - pressed(6) - past(pad.axes[3]), port = -past(pad.axes[0]);
    if (pressed(0) > 0.5) steer(state.throttle, 0);
    else if (ahead || port) steer(state.throttle + 0.5 * seconds * ahead, state.rudder + 0.35 * seconds * port);
  }
}

// --- pictures -----------------------------------------------------------------------------------------------------------

function draw(free = freeBox(state.worlds.length)) {
  const ratio = Math.min(devicePixelRatio || 1, 2) * state.scale;
  const width = Math.max(Math.round(canvas.clientWidth * ratio), 2), height = Math.max(Math.round(canvas.clientHeight * ratio), 2);
  if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
  const seen = state.worlds[0];
  if (seen.after && camera.of !== seen.still.title) { camera.of = seen.still.title; camera.face(seen, painter.sky.lit.sunDir); }
  const n = state.worlds.length, options = { lines: state.lines, mirror: state.mirror, light: root.dataset.theme === "light" };
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.enable(gl.SCISSOR_TEST);
  state.worlds.forEach((world, k) => {
    const x = Math.round((k * width) / n), w = Math.round(((k + 1) * width) / n) - x;
    gl.viewport(x, 0, w, height);
    gl.scissor(x, 0, w, height);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    if (!world.after) return;
    world.seen = shifted(camera.eye(world, w, height, free), free);
    const ship = world.ships[camera.ship] || world.ships[0];
    const helm = camera.mode === "helm" && ship && { ship, rudder: ((reading(world.after, "rudder", "") || 0) * Math.PI) / 180 };
    world.draw(world.seen, state.content, { ...options, helm });
  });
  const first = state.worlds[0];
  $("rig").hidden = !(state.rig && first?.legs);
  if (!$("rig").hidden) inset(first, ratio);
  gl.disable(gl.SCISSOR_TEST);
  if (!LIVE || state.back) return;  // a replay has a clock of its own, by which two runs go on, one longer than the other
  state.time = state.worlds[0]?.time ?? 0;
  $("clock").textContent = `t = ${state.time.toFixed(2)} s`;
}

// Of the picture, what no panel and no bar hides: its shares of width and height, and its middle from -1 to 1.
function freeBox(n) {
  const folded = document.body.classList.contains("folded"), broad = innerWidth > 820, panel = $("panel").getBoundingClientRect();
  const right = broad && !folded && n === 1 ? panel.left : innerWidth, bars = (!broad && $("scrubBar").offsetHeight ? $("scrubBar") : $("dock").lastElementChild).getBoundingClientRect();
  const top = $("strip").hidden ? $("top").getBoundingClientRect().bottom : broad ? 90 : $("strip").getBoundingClientRect().bottom;
  return [right / innerWidth, Math.max(bars.top - top, 60) / innerHeight, right / innerWidth - 1, 1 - (top + bars.top) / innerHeight];
}

function shifted(eye, free) {
  const p = [...eye.projection];
  p[8] -= free[2];
  p[9] -= free[3];
  return { ...eye, projection: p };
}

// The motion platform in a card of its own, in the first picture alone.
function inset(world, ratio) {
  const box = $("rig").getBoundingClientRect(), at = [box.left, innerHeight - box.bottom, box.width, box.height].map((v) => Math.round(v * ratio));
  gl.viewport(...at);
  gl.scissor(...at);
  gl.clearColor(0.07, 0.13, 0.19, 1);
  gl.clear(gl.DEPTH_BUFFER_BIT | gl.COLOR_BUFFER_BIT);
  const { platform } = world.still, unit = Math.hypot(...platform.base[0]), high = 0.6 * platform.longest;
  const turn = 0.8, eye = [Math.sin(turn) * 3.9 * unit, high + 1.5 * unit, -Math.cos(turn) * 3.9 * unit], target = [0, high * 0.62, 0];
  world.drawPlatform({ view: M.look(eye, target, [0, 1, 0]), projection: M.perspective(0.62, box.width / box.height, 0.1, 100) });
}

let last = performance.now(), slow = 0, plotted = 0, counted = 0;
function tick(now) {
  requestAnimationFrame(tick);
  const seconds = Math.min((now - last) / 1000, 0.25);
  last = now;
  holdKeys(seconds);
  holdPad(seconds);
  let moving = !!film.tape;  // a film of a scene at rest is its still picture, drawn again and again
  if (XR.session) return;  // the headset asks for its own pictures
  if (LIVE && !state.back) moving = live.show(now / 1000) || moving;
  else if (state.replays.length && !state.paused) {
    seek(state.time + seconds * (state.speed || 1));
    moving = true;
    if (state.time >= state.end) { LIVE ? toLive() : pausedIs(true); }
  }
  if (state.worlds.length && (moving || state.dirty)) {
    const begun = performance.now();
    draw();
    state.drawn++;
    state.dirty = state.worlds.some((world) => world.turning);
    if (state.worlds[0].after && !$("cover").classList.contains("gone")) $("cover").classList.add("gone");
    // Coarser pixels where the machine cannot follow; a film keeps its size.
    slow = 0.92 * slow + 0.08 * Math.max(seconds * 1000, performance.now() - begun);
    if (++counted > 40 && slow > 55 && state.scale > 0.5 && !film.tape) { state.scale = Math.max(0.5, state.scale * 0.8); counted = 0; }
  }
  if (now - plotted < 150) return;
  plotted = now;
  if (state.worlds.length) instruments(); else doing();
  scaleBar();
  if (state.tab === "plots") plots.draw(state.time, state.back);
}

// --- replay -------------------------------------------------------------------------------------------------------------

function seek(time) {
  state.time = clamp(time, state.begin, state.end);
  state.replays.forEach((replay, k) => {
    const at = Math.min(state.time, replay.end), i = replay.before(at), j = Math.min(i + 1, replay.times.length - 1);
    const a = replay.frame(i), b = replay.frame(j), span = b.time - a.time;
    state.worlds[k].show(a, b, span > 0 ? clamp((at - a.time) / span, 0, 1) : 0);
  });
  $("scrub").value = (1000 * (state.time - state.begin)) / Math.max(state.end - state.begin, 1e-9);
  $("scrub").setAttribute("aria-valuetext", `${state.time.toFixed(2)} seconds`);
  $("clock").textContent = `t = ${state.time.toFixed(2)}${LIVE ? "" : ` of ${state.end.toFixed(2)}`} s`;
  state.dirty = true;
}

async function fetched(path, id) {
  if (START.held) return unpack(await inflated(held(id)));
  const reply = await fetch(path + WITH);
  if (!reply.ok) throw new Error(await reply.text());
  return unpack(await inflated(await reply.arrayBuffer()));
}

async function replay() {
  $("scrubBar").hidden = false;
  for (const id of ["windGroup", "sliders", "record"]) $(id).hidden = true;
  $("sliders").parentElement.hidden = true;
  $("coverText").textContent = "Unpacking the replay ...";
  const stills = await Promise.all(START.runs.map((_, k) => fetched(`/still/${k}`, `still${k}`)));
  const heads = await Promise.all(START.runs.map((_, k) => fetched(`/replay/${k}`, `replay${k}`)));
  begin(stills);
  state.replays = heads.map((head) => new Replay(head));
  state.begin = Math.min(...state.replays.map((r) => r.times[0]));
  state.end = Math.max(...state.replays.map((r) => r.end));
  state.replays.forEach((r, k) => {
    plots.fill(k, r);
    r.times.forEach((time, i) => { const { data } = r.frame(i); if (data.poses) state.worlds[k].follow(time, data.poses, Infinity); });
  });
  if (START.runs.length > 1) {
    $("names").innerHTML = START.runs.map((run, k) => `<span style="left:${(100 * (k + 0.5)) / START.runs.length}%">${escaped(run.name)}</span>`).join("") + '<i style="left:50%"></i>';
    document.body.classList.add("folded");
  }
  seek(state.begin);
  pausedIs(false);
}

window.oceanSim = { state, camera, painter, plots, XR, M, History, live };  // for those who look into the page, tests among them
const [seenFrom, seenAs] = location.hash.slice(1).split(",");  // as `Copy link` leaves them
if (seenFrom) Object.assign(camera, { mode: seenFrom });
if (seenAs) state.content = seenAs;
speeds(1);
tabs();
link();
greet();
if (innerWidth <= 820) $("fold").click();  // a small screen shows the sea first
requestAnimationFrame(tick);
addEventListener("resize", () => { state.dirty = true; });
fetched("/sky", "sky").then((head) => { painter.sky.take(head); state.dirty = true; }).catch(() => {});
XR.offer((now) => {
  if (LIVE) live.show(now / 1000);
  else if (!state.paused) seek(state.time + 0.011 * state.speed);
});
if (LIVE) live.open();
else replay().catch((error) => { console.error(error); $("coverText").textContent = `This replay cannot be shown: ${error.message}`; });
