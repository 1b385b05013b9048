"use strict";

// Plays recorded episodes of any world. Time is counted in ticks, `game.rate` of them a second. What changes
// over time is a list of pairs: a tick, and what holds from then on. A look is a list of shapes in world units.
const game = JSON.parse(document.getElementById("game").textContent);
const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8];
const TRAIL = 15, SMALLEST = 9, HEADER = 32;
const state = { episode: 0, time: 0, playing: false, speed: 1, last: 0, reason: -1 };
let colors = {}, rows = [], told = "", shown = "", trails = true;

const find = (id) => document.getElementById(id);
const stage = find("stage"), band = find("strip"), scrub = find("scrub");
const current = () => game.episodes[state.episode];
const lastTick = (episode = current()) => episode.ticks - 1;
const seconds = (tick) => (tick / game.rate).toFixed(1);
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

for (const episode of game.episodes) {
  for (const { moves } of episode.tracks) for (let at = 3; at < moves.length; at++) moves[at] += moves[at - 3];
  episode.frame = frameOf(episode);
}

function make(tag, text, attributes = {}) {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  return element;
}

function signed(value, digits) {
  return String(digits === undefined ? value : value.toFixed(digits)).replace(/-/g, "\u2212");
}

function plus(value) {
  // Not "-0.00", nor "+0.00".
  const rounded = Number(value.toFixed(2)) || 0;
  return `${rounded > 0 ? "+" : ""}${signed(rounded, 2)}`;
}

// Colors and words

const shade = (color) => (color.startsWith("#") ? color : colors[color]);

function readColors() {
  const style = getComputedStyle(document.documentElement);
  colors = Object.fromEntries(game.roles.map((role) => [role, style.getPropertyValue(`--${role}`).trim()]));
}

function over(color) {
  const [red, green, blue] = [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16) / 255);
  return 0.299 * red + 0.587 * green + 0.114 * blue > 0.5 ? "#262626" : "#ffffff";
}

function chip([label, color]) {
  const role = color.startsWith("#") ? color : `var(--${color})`;
  return make("span", label, { class: "chip", style: `background: ${role}; color: ${over(shade(color))}` });
}

function worded(words, tag = "span") {
  const element = make(tag);
  element.append(...game.words[words].map((part) => (typeof part === "string" ? part : chip(part))));
  return element;
}

// What holds at a moment

function at(changes, tick) {
  // The last change in or before a tick.
  let low = 0, high = changes.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (changes[middle][0] <= tick) low = middle + 1; else high = middle;
  }
  return low ? changes[low - 1][1] : undefined;
}

function pose(track, tick) {
  const { moves } = track;
  return [moves[3 * tick] * game.grain, moves[3 * tick + 1] * game.grain, moves[3 * tick + 2] * game.turn];
}

function poseBetween(track, time, look) {
  const tick = Math.floor(time), next = tick + 1, share = time - tick;
  const first = pose(track, tick);
  if (!share || 3 * next >= track.moves.length || at(track.looks, next) < 0) return first;
  const second = pose(track, next);
  // A thing that turns into another one does not move on the way.
  return at(track.looks, next) === look || track.trail ? first.map((value, part) => value + share * (second[part] - value)) : first;
}

function choiceAt(tick) {
  // The last decision made in or before a tick.
  const { choices } = current();
  let index = -1;
  while (index + 1 < choices.length && choices[index + 1].from <= tick) index++;
  return index;
}

// Drawing

function frameOf(episode) {
  // What is in view during the whole episode: everything, as far as the stage allows.
  let [left, right, low, high] = game.view;
  if (!game.widest) return [left, right, low, high];
  for (const track of episode.tracks) {
    for (let tick = 0; tick < episode.ticks; tick++) {
      if (at(track.looks, tick) < 0) continue;
      const [x, y] = pose(track, tick);
      left = Math.min(left, x - game.room);
      right = Math.max(right, x + game.room);
      high = Math.max(high, y + game.room);
    }
  }
  const [least, most, , top] = game.widest;
  return [Math.max(left, least), Math.min(right, most), low, Math.min(high, top)];
}

function sharp(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  return [pen, width, height];
}

function write(pen, text, x, y, size, color, { align = "center", weight = 650, halo = "" } = {}) {
  pen.font = `${weight} ${size}px system-ui, "DejaVu Sans", sans-serif`;
  pen.textAlign = align;
  pen.textBaseline = "middle";
  if (halo) {
    pen.strokeStyle = shade(halo);
    pen.lineWidth = 4;
    pen.strokeText(text, x, y);
  }
  pen.fillStyle = shade(color);
  pen.fillText(text, x, y);
}

function cameraOf(width, height, [left, right, low, high], small) {
  const scale = Math.min(width / (right - left), height / (high - low));
  // What stands on the ground stays there; everything else is in the middle.
  const spare = game.widest ? 0 : (height - scale * (high - low)) / 2;
  return {
    scale,
    // Small texts in small pictures could not be read.
    least: small ? 0 : SMALLEST,
    place: ([x, y], [atX, atY, angle]) => {
      const along = Math.cos(angle), across = Math.sin(angle);
      const worldX = atX + along * x - across * y, worldY = atY + across * x + along * y;
      return [width / 2 + scale * (worldX - (left + right) / 2), height - spare - scale * (worldY - low)];
    },
  };
}

function trace(pen, points, closed) {
  pen.beginPath();
  points.forEach(([x, y], index) => (index ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  if (closed) pen.closePath();
}

function stroke(pen, color, width, dashed) {
  pen.strokeStyle = shade(color);
  pen.lineWidth = Math.max(width, 1);
  pen.setLineDash(dashed ? [3 * pen.lineWidth, 3 * pen.lineWidth] : []);
  pen.stroke();
  pen.setLineDash([]);
}

function fill(pen, color) {
  pen.fillStyle = shade(color);
  pen.fill();
}

const DRAW = {
  circle(pen, { scale, place }, shape, pose) {
    const [x, y] = place(shape.centre, pose);
    pen.beginPath();
    pen.arc(x, y, scale * shape.radius, 0, 2 * Math.PI);
    if (shape.fill) fill(pen, shape.fill);
    if (shape.edge) stroke(pen, shape.edge, scale * shape.width);
  },
  polygon(pen, { scale, place }, shape, pose) {
    trace(pen, shape.corners.map((corner) => place(corner, pose)), true);
    if (shape.fill) fill(pen, shape.fill);
    if (shape.edge) stroke(pen, shape.edge, scale * shape.width, shape.dashed);
  },
  line(pen, { scale, place }, shape, pose) {
    const points = shape.points.map((point) => place(point, pose));
    pen.lineCap = shape.dashed ? "butt" : "round";
    trace(pen, points);
    stroke(pen, shape.color, scale * shape.width, shape.dashed);
    if (!shape.arrow) return;
    const [tail, tip] = points.slice(-2), along = Math.atan2(tip[1] - tail[1], tip[0] - tail[0]);
    const barb = (turn) => [tip[0] + 5 * scale * shape.width * Math.cos(along + turn), tip[1] + 5 * scale * shape.width * Math.sin(along + turn)];
    trace(pen, [barb(-2.6), tip, barb(2.6)]);
    stroke(pen, shape.color, scale * shape.width);
  },
  text(pen, { scale, least, place }, shape, pose) {
    if (!least && scale * shape.size < SMALLEST) return;
    const [x, y] = place(shape.at, pose), align = ["left", "center", "right"][Math.round(shape.side || 0) + 1];
    write(pen, shape.words, x, y + 0.5, Math.max(scale * shape.size, least), shape.color, { align, halo: shape.halo, weight: shape.bold ? 650 : 400 });
  },
};

function drawLook(pen, camera, look, pose) {
  for (const shape of game.looks[look] || []) DRAW[shape.type](pen, camera, shape, pose);
}

const HERE = [0, 0, 0];

function draw(canvas, time, { small = false } = {}) {
  const episode = current(), tick = Math.floor(time), [pen, width, height] = sharp(canvas);
  const camera = cameraOf(width, small ? height : height - HEADER, episode.frame, small);
  if (!small) pen.translate(0, HEADER);
  pen.lineJoin = "round";
  pen.fillStyle = colors.paper;
  pen.fillRect(0, -HEADER, width, height + HEADER);
  drawLook(pen, camera, game.backdrop, HERE);
  if (trails && !small) drawTrails(pen, camera, time);
  for (const track of episode.tracks) {
    const look = at(track.looks, tick);
    if (look >= 0) drawLook(pen, camera, look, poseBetween(track, time, look));
  }
  drawLook(pen, camera, at(episode.notes, tick), HERE);
  if (small) return;
  drawWitnesses(pen, camera, time);
  pen.translate(0, -HEADER);
  pen.fillStyle = colors.paper;
  pen.fillRect(0, 0, width, HEADER);
  write(pen, at(episode.captions, tick), 14, HEADER / 2, 15, "ink", { align: "left" });
  const score = at(episode.scores, tick);
  if (score !== null) write(pen, `${game.score} ${signed(score, 2)}`, width - 14, HEADER / 2, 13, "grey", { align: "right", weight: 400 });
}

function drawTrails(pen, camera, time) {
  const first = Math.max(0, Math.floor(time) - TRAIL);
  pen.lineCap = "butt";
  for (const track of current().tracks) {
    if (!track.trail) continue;
    let from = camera.place([0, 0], pose(track, first));
    for (let tick = first + 1; tick <= time + 1; tick++) {
      const to = camera.place([0, 0], tick <= time ? pose(track, tick) : poseBetween(track, time, at(track.looks, Math.floor(time))));
      pen.globalAlpha = 0.75 * Math.max(0, 1 - (time - tick + 1) / (TRAIL + 1));
      trace(pen, [from, to]);
      stroke(pen, track.trail, 3.5);
      from = to;
    }
  }
  pen.globalAlpha = 1;
}

const reaches = new Map();

function reachOf(look) {
  // How far what is drawn of a thing reaches from where it is.
  if (!reaches.has(look)) {
    const far = (game.looks[look] || []).map((shape) => {
      if (shape.type === "circle" && shape.fill) return Math.hypot(...shape.centre) + shape.radius;
      return shape.type === "polygon" && shape.fill ? Math.max(...shape.corners.map((corner) => Math.hypot(...corner))) : 0;
    });
    reaches.set(look, Math.max(0, ...far));
  }
  return reaches.get(look);
}

const signOf = (reason) => (reason.adds < 0 ? "doubt" : "mark");

function drawWitnesses(pen, camera, time) {
  // A ring around each object that satisfies a reason best: the chosen reason, or else the first for and against.
  const tick = Math.floor(time), reasons = current().choices[choiceAt(tick)]?.why?.reasons || [];
  const rings = new Map(), badges = [];
  const first = (color) => reasons.findIndex((reason) => signOf(reason) === color && reason.marks.length);
  const shownReasons = state.reason >= 0 ? [state.reason] : [first("mark"), first("doubt")].filter((index) => index >= 0);
  for (const index of shownReasons) {
    for (const place of reasons[index].marks) {
      const track = current().tracks[place], look = at(track.looks, tick);
      if (look < 0) continue;
      const before = rings.get(place) || 0, radius = camera.scale * reachOf(look) + 5 + 5 * before;
      const [x, y] = camera.place([0, 0], poseBetween(track, time, look)), color = signOf(reasons[index]);
      rings.set(place, before + 1);
      pen.beginPath();
      pen.arc(x, y, radius, 0, 2 * Math.PI);
      stroke(pen, "card", 5);
      stroke(pen, color, 3);
      const side = (radius + 8) * Math.SQRT1_2, middle = x + (before % 2 ? -side : side);
      badges.push([String(index + 1), middle, y - side, color]);
    }
  }
  for (const [number, x, y, color] of badges) {
    pen.beginPath();
    pen.arc(x, y, 9, 0, 2 * Math.PI);
    fill(pen, color);
    write(pen, number, x, y + 0.5, 12, "card");
  }
}

function drawStrip() {
  const [pen, width, height] = sharp(band), { bands } = current();
  // As far from the ends as the middle of the slider's knob.
  const inset = 8, step = (width - 2 * inset) / Math.max(1, lastTick()), x = (tick) => inset + step * tick;
  pen.fillStyle = colors.track;
  pen.fillRect(0, 0, width, height);
  bands.forEach(([from, color], index) => {
    const until = index + 1 < bands.length ? bands[index + 1][0] : lastTick() + 0.5;
    if (!color) return;
    pen.fillStyle = shade(color);
    pen.fillRect(x(Math.max(from - 0.5, 0)), 0, step * (until - from), height);
  });
  pen.fillStyle = colors.ink;
  for (const row of rows) pen.fillRect(x(row.from) - 0.75, 0, 1.5, height);
}

// What is told beside the stage

function listRows() {
  // What is decided again and again from tick to tick, such as to hold the ball, is one row.
  rows = [];
  for (const choice of current().choices) {
    const previous = rows[rows.length - 1];
    const brief = choice.until - choice.from <= 1;
    if (previous && previous.words === choice.words && previous.brief && brief && choice.from - previous.until <= 0) {
      previous.times += 1;
      previous.until = choice.until;
      previous.lasts += choice.lasts;
      previous.reward += choice.reward;
    } else rows.push({ ...choice, brief, times: 1 });
  }
  if (current().before) {
    const until = rows.length ? rows[0].from : lastTick();
    rows.unshift({ from: 0, until, lasts: until / game.rate, reward: current().before, times: 1 });
  }
  const body = find("rows");
  body.replaceChildren(...rows.map((row) => {
    const words = row.words === undefined ? make("span", "before any decision") : worded(row.words);
    if (row.times > 1) words.append(` \u00d7 ${row.times}`);
    row.line = make("tr");
    row.line.append(make("td", seconds(row.from), { class: "n" }), make("td"), make("td", row.lasts.toFixed(1), { class: "n" }), make("td", plus(row.reward), { class: "n" }));
    row.line.children[1].append(words);
    row.line.addEventListener("click", () => { pause(); seek(row.from); });
    return row.line;
  }));
  if (!rows.length) body.append(make("tr", "")), body.lastChild.append(make("td"), make("td", "none"));
}

function markRow(tick) {
  const list = find("list");
  let now = -1;
  while (now + 1 < rows.length && rows[now + 1].from <= tick) now++;
  rows.forEach((row, index) => {
    if ((index === now) === row.line.hasAttribute("aria-current")) return;
    if (index !== now) { row.line.removeAttribute("aria-current"); return; }
    row.line.setAttribute("aria-current", "true");
    // The head and the foot of the table stay in view.
    const top = row.line.offsetTop, bottom = top + row.line.offsetHeight, edge = row.line.offsetHeight;
    if (top - edge < list.scrollTop) list.scrollTop = top - edge;
    if (bottom + edge > list.scrollTop + list.clientHeight) list.scrollTop = bottom + edge - list.clientHeight;
  });
}

function shares(values) {
  const known = values.filter((value) => value !== null);
  const low = Math.min(...known), high = Math.max(...known);
  const zero = low >= 0 ? 0 : low - 0.1 * (high - low);
  return values.map((value) => (value === null || high <= zero ? 0 : (value - zero) / (high - zero)));
}

function tellChoice(tick) {
  const index = choiceAt(tick), choice = current().choices[index];
  if (shown === `${state.episode}/${index}`) return;
  shown = `${state.episode}/${index}`;
  const said = find("said"), options = find("options");
  // Empty lines keep everything below in its place.
  const { options: listed, chosen, values } = choice || { options: current().choices[0]?.options || [], chosen: -1, values: current().choices[0]?.values && [] };
  options.replaceChildren(...(listed.length > 1 ? listed.map((words, action) => {
    const item = make("li");
    item.append(worded(words));
    if (action === chosen) item.setAttribute("aria-current", "true");
    if (values) {
      const value = values[action] ?? null;
      item.append(make("span", value === null ? "" : signed(Number(value.toPrecision(3)))));
      item.append(make("i", undefined, { style: `--share: ${value === null ? 0 : shares(values)[action].toFixed(3)}` }));
    }
    return item;
  }) : []));
  if (choice) said.replaceChildren(worded(choice.words), make("small", `from ${seconds(choice.from)} s for ${choice.lasts.toFixed(1)} s, reward ${plus(choice.reward)}`));
  else said.replaceChildren("no decision yet", make("small", `until ${seconds(current().choices[0]?.from ?? lastTick())} s`));
  options.classList.toggle("many", listed.length > 8);
  const taken = options.querySelector("[aria-current]");
  if (taken) options.scrollTop = taken.offsetTop - options.clientHeight / 2;
  tellWhy(choice?.why);
  drawChange();
}

function tellWhy(why) {
  state.reason = -1;
  const lead = why ? ["it is worth ", signed(Math.abs(why.lead), 2), why.lead < 0 ? " less than " : " more than ", worded(why.rival)] : [];
  find("lead").replaceChildren(...lead);
  find("reasons").replaceChildren(...(why ? why.reasons.map(reasonItem) : []));
  const [count, adds] = why ? why.rest : [0, 0];
  find("rest").textContent = count ? `${count} more: ${plus(adds)}` : "";
}

function reasonItem(reason, index) {
  const item = make("li", undefined, { tabindex: 0 });
  item.append(make("i", index + 1, { style: `background: var(--${signOf(reason)})` }), worded(reason.says), make("b", plus(reason.adds), { style: `color: var(--${signOf(reason)})` }));
  const stands = worded(reason.stands, "small");
  if (stands.textContent) item.append(stands);
  const choose = (chosen) => () => {
    state.reason = chosen;
    for (const other of find("reasons").children) other.removeAttribute("aria-current");
    if (chosen >= 0) item.setAttribute("aria-current", "true");
    draw(stage, state.time);
  };
  for (const begin of ["mouseenter", "focus"]) item.addEventListener(begin, choose(index));
  for (const end of ["mouseleave", "blur"]) item.addEventListener(end, choose(-1));
  return item;
}

function moments(index) {
  // The ticks before and after a decision. At the next tick another one may have begun.
  const { choices } = current(), choice = choices[index];
  if (!choice) return [0, Math.min(choices[0]?.from ?? lastTick(), lastTick())];
  return [Math.min(choice.from, lastTick()), Math.min(choice.until, lastTick())];
}

function drawChange() {
  const [before, after] = moments(choiceAt(Math.floor(state.time)));
  draw(find("before"), before, { small: true });
  draw(find("after"), after, { small: true });
  const scoreOf = (tick) => { const score = at(current().scores, tick); return score === null ? `${seconds(tick)} s` : signed(score, 2); };
  find("worse").textContent = scoreOf(before);
  find("better").textContent = scoreOf(after);
}

function tellDetails(tick) {
  if (find("detailed").open) find("details").replaceChildren(...at(current().details, tick).map((words) => worded(words, "div")));
}

function show() {
  const tick = Math.floor(state.time);
  draw(stage, state.time);
  const now = `${state.episode}/${tick}`;
  if (now === told) return;
  told = now;
  scrub.value = tick;
  markRow(tick);
  tellChoice(tick);
  tellDetails(tick);
  const caption = at(current().captions, tick), what = `${seconds(tick)} seconds${caption ? `, ${caption}` : ""}`;
  scrub.setAttribute("aria-valuetext", what);
  find("clock").replaceChildren(make("b", seconds(tick)), make("span", ` / ${seconds(lastTick())} s`));
  stage.setAttribute("aria-label", `The stage after ${what}`);
}

// Time

function seek(time) {
  state.time = clamp(time, 0, lastTick());
  show();
}

function step(now) {
  if (!state.playing) return;
  const passed = Math.min((now - state.last) / 1000, 0.25);
  state.last = now;
  seek(state.time + passed * state.speed * game.rate);
  if (state.time >= lastTick()) pause(); else requestAnimationFrame(step);
}

function play() {
  if (state.time >= lastTick()) seek(0);
  state.playing = true;
  state.last = performance.now();
  markPlay();
  requestAnimationFrame(step);
}

function pause() {
  state.playing = false;
  markPlay();
}

const toggle = () => (state.playing ? pause() : play());

function markPlay() {
  const button = find("play");
  const over = !state.playing && lastTick() > 0 && state.time >= lastTick();
  const shape = state.playing ? "M2 1h4v12H2zM8 1h4v12H8z" : over ? "M7 1.5a5.5 5.5 0 1 0 5.4 6.6h-2.1A3.5 3.5 0 1 1 7 3.5c.9 0 1.8.4 2.4 1L7.5 6.4H13V.9l-2.1 2.1A5.5 5.5 0 0 0 7 1.5z" : "M3 1l10 6-10 6z";
  button.innerHTML = `<svg viewBox="0 0 14 14" aria-hidden="true"><path d="${shape}"/></svg>`;
  button.setAttribute("aria-label", state.playing ? "Pause" : over ? "Play again" : "Play");
  button.title = `${state.playing ? "Pause" : "Play"} (space)`;
}

function jump(direction) {
  const tick = Math.floor(state.time), starts = rows.map((row) => row.from);
  const target = direction > 0 ? starts.find((from) => from > tick) : starts.reverse().find((from) => from < tick);
  pause();
  seek(target === undefined ? (direction > 0 ? lastTick() : 0) : target);
  markPlay();
}

function nudge(direction) {
  pause();
  seek(direction > 0 ? Math.floor(state.time) + 1 : Math.ceil(state.time) - 1);
  markPlay();
}

function setSpeed(speed) {
  state.speed = speed;
  find("speed").value = String(speed);
}

function setTrails(on) {
  trails = find("trails").checked = on;
  draw(stage, state.time);
}

function choose(episode, time = 0) {
  state.episode = clamp(episode, 0, game.episodes.length - 1);
  scrub.max = lastTick();
  find("episode").value = String(state.episode);
  find("earlier").disabled = state.episode === 0;
  find("later").disabled = state.episode === game.episodes.length - 1;
  find("length").textContent = seconds(lastTick());
  find("total").textContent = plus(current().reward);
  listRows();
  find("list").scrollTop = 0;
  told = shown = "";
  seek(time);
  drawStrip();
  if (!state.playing) markPlay();
}

function redraw() {
  readColors();
  draw(stage, state.time);
  drawChange();
  drawStrip();
}

const KEYS = {
  " ": toggle,
  ArrowLeft: (event) => (event.shiftKey ? jump(-1) : nudge(-1)),
  ArrowRight: (event) => (event.shiftKey ? jump(1) : nudge(1)),
  Home: () => seek(0),
  End: () => { pause(); seek(lastTick()); },
  "+": () => setSpeed(SPEEDS[Math.min(SPEEDS.indexOf(state.speed) + 1, SPEEDS.length - 1)]),
  "-": () => setSpeed(SPEEDS[Math.max(SPEEDS.indexOf(state.speed) - 1, 0)]),
  n: () => choose(state.episode + 1),
  p: () => choose(state.episode - 1),
  t: () => setTrails(!trails),
};

function listen() {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const within = event.target.closest("select, summary, input[type=checkbox], button");
    if (within && (event.key === " " || within.tagName === "SELECT")) return;
    const act = KEYS[event.key === "=" ? "+" : event.key];
    if (!act) return;
    event.preventDefault();
    act(event);
    markPlay();
  });
  find("play").addEventListener("click", toggle);
  find("back").addEventListener("click", () => jump(-1));
  find("forth").addEventListener("click", () => jump(1));
  find("before").addEventListener("click", () => { pause(); seek(moments(choiceAt(Math.floor(state.time)))[0]); });
  // Just before the next decision is made.
  find("after").addEventListener("click", () => { pause(); seek(moments(choiceAt(Math.floor(state.time)))[1] - 1); });
  find("trails").addEventListener("change", (event) => setTrails(event.target.checked));
  find("detailed").addEventListener("toggle", () => tellDetails(Math.floor(state.time)));
  scrub.addEventListener("input", () => { pause(); seek(Number(scrub.value)); markPlay(); });
  find("speed").addEventListener("change", (event) => setSpeed(Number(event.target.value)));
  find("episode").addEventListener("change", (event) => choose(Number(event.target.value)));
  find("earlier").addEventListener("click", () => choose(state.episode - 1));
  find("later").addEventListener("click", () => choose(state.episode + 1));
  stage.addEventListener("click", toggle);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
}

function start() {
  const [left, right, low, high] = game.view;
  document.documentElement.style.setProperty("--aspect", (right - left) / (high - low + 0.04 * (right - left)));
  find("subtitle").textContent = game.subtitle;
  find("legend").textContent = game.legend;
  find("detailed").hidden = !game.episodes.some((episode) => episode.details.some(([, lines]) => lines.length));
  const explained = game.episodes.some((episode) => episode.choices.some((choice) => choice.why));
  find("why").hidden = !explained;
  find("main").classList.toggle("reasoned", explained);
  find("trailing").hidden = !game.episodes.some((episode) => episode.tracks.some((track) => track.trail));
  find("speed").replaceChildren(...SPEEDS.map((speed) => make("option", `${speed}\u00d7`, { value: speed })));
  setSpeed(1);
  readColors();
  find("episodes").hidden = game.episodes.length < 2;
  find("episode").replaceChildren(...game.episodes.map((episode, number) => (
    make("option", `Episode ${number + 1}: ${seconds(lastTick(episode))} s, ${episode.end || `total ${plus(episode.reward)}`}`, { value: number })
  )));
  listen();
  // "#episode=2&tick=31" in the address opens a moment of an episode.
  const wanted = new URLSearchParams(location.hash.slice(1));
  choose((Number(wanted.get("episode")) || 1) - 1, Number(wanted.get("tick")) || 0);
  new ResizeObserver(redraw).observe(stage);
}

start();
