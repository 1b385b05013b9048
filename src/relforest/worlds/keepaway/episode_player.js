"use strict";

// An episode holds one state per cycle: players as x, y in centimetres and body in degrees, one after the
// other, keepers first; the ball as x, y. Decisions and commands belong to the state in which they were made.
const game = JSON.parse(document.getElementById("game").textContent);
const [LENGTH, WIDTH] = game.field;
const KEEPERS = game.keepers, PLAYERS = game.keepers + game.takers;
const KICKABLE = 1.085, CYCLES_PER_SECOND = 10, TRAIL = 15;
const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];
const ENDS = ["stopped", "the ball went out", "a taker took the ball", "cut off"];
const SHORT_ENDS = ["stopped", "out", "taken", "cut off"];
const KINDS = ["nothing", "dash", "turn", "kick"];

const find = (id) => document.getElementById(id);
const field = find("field"), strip = find("strip"), scrub = find("scrub");
const state = { episode: 0, time: 0, playing: false, speed: 1, trails: true, last: 0 };
let colors = {}, rows = [];

const current = () => game.episodes[state.episode];
const lastCycle = () => current().ball.length / 2 - 1;
const seconds = (cycle) => (cycle / CYCLES_PER_SECOND).toFixed(1);

function make(tag, text, attributes = {}) {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  return element;
}

function ballAt(cycle) {
  return [current().ball[2 * cycle] / 100, current().ball[2 * cycle + 1] / 100];
}

function playerAt(cycle, player) {
  const at = 3 * (cycle * PLAYERS + player), values = current().players;
  return [values[at] / 100, values[at + 1] / 100, values[at + 2]];
}

function between(first, second, share) {
  const turn = ((second[2] - first[2] + 540) % 360) - 180;
  return [
    first[0] + share * (second[0] - first[0]),
    first[1] + share * (second[1] - first[1]),
    first[2] + share * (Number.isFinite(turn) ? turn : 0),
  ];
}

function decisionAt(cycle) {
  // The last decision made in or before a cycle.
  const times = current().decisions.time;
  let low = 0, high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= cycle) low = middle + 1; else high = middle;
  }
  return low - 1;
}

function decision(index) {
  const { time, actor, action, order, values } = current().decisions;
  return {
    time: time[index], actor: actor[index], action: action[index],
    order: order.slice(index * KEEPERS, (index + 1) * KEEPERS),
    values: values ? values.slice(index * KEEPERS, (index + 1) * KEEPERS) : null,
  };
}

function named(made) {
  return made.action === 0 ? "hold" : `pass to ${made.order[made.action] + 1}`;
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

function margin() { return 0.05 * Math.max(LENGTH, WIDTH); }

function drawField() {
  const [pen, width, height] = sharp(field);
  const scale = Math.min(width / (LENGTH + 2 * margin()), height / (WIDTH + 2 * margin()));
  const x = (value) => width / 2 + scale * value, y = (value) => height / 2 + scale * value;
  pen.lineCap = pen.lineJoin = "round";
  pen.fillStyle = colors.grass;
  pen.fillRect(x(-LENGTH / 2), y(-WIDTH / 2), scale * LENGTH, scale * WIDTH);
  pen.fillStyle = colors.stripe;
  for (let stripe = 1; stripe < 10; stripe += 2) {
    pen.fillRect(x(LENGTH * (stripe / 10 - 0.5)), y(-WIDTH / 2), scale * LENGTH / 10, scale * WIDTH);
  }
  pen.strokeStyle = colors.chalk;
  pen.lineWidth = 3;
  pen.strokeRect(x(-LENGTH / 2), y(-WIDTH / 2), scale * LENGTH, scale * WIDTH);

  const cycle = Math.min(Math.floor(state.time), lastCycle()), share = state.time - cycle;
  const next = Math.min(cycle + 1, lastCycle());
  const players = [];
  for (let player = 0; player < PLAYERS; player++) {
    players.push(between(playerAt(cycle, player), playerAt(next, player), share));
  }
  const ball = between([...ballAt(cycle), 0], [...ballAt(next), 0], share);
  const radius = Math.max(0.4 * scale, Math.min(11, width / 30));
  if (state.trails) drawTrails(pen, x, y, cycle, players, ball, radius);
  drawChoice(pen, x, y, scale, cycle, players, radius);
  for (let player = PLAYERS - 1; player >= 0; player--) drawPlayer(pen, x, y, player, players[player], radius);
  disc(pen, x(ball[0]), y(ball[1]), 0.5 * radius + 1.5, colors.rim);
  disc(pen, x(ball[0]), y(ball[1]), 0.5 * radius, colors.ball);
  if (cycle >= lastCycle()) write(pen, ENDS[current().end], width / 2, y(-WIDTH / 2) / 2, 13, colors.ink);
}

function write(pen, text, x, y, size, color) {
  pen.fillStyle = color;
  pen.font = `650 ${size}px system-ui, "DejaVu Sans", sans-serif`;
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.fillText(text, x, y);
}

function disc(pen, x, y, radius, color) {
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fillStyle = color;
  pen.fill();
}

function drawTrails(pen, x, y, cycle, players, ball, radius) {
  const first = Math.max(0, cycle - TRAIL);
  pen.lineCap = "butt";
  for (let thing = 0; thing <= PLAYERS; thing++) {
    const at = (when) => (thing < PLAYERS ? playerAt(when, thing) : ballAt(when));
    pen.strokeStyle = thing === PLAYERS ? colors.ball : thing < KEEPERS ? colors.keeper : colors.taker;
    pen.lineWidth = thing === PLAYERS ? 2.5 : Math.max(3, radius / 3);
    let from = at(first);
    for (let when = first + 1; when <= cycle + 1; when++) {
      const to = when <= cycle ? at(when) : thing < PLAYERS ? players[thing] : ball;
      pen.globalAlpha = 0.75 * Math.max(0, 1 - (state.time - when + 1) / (TRAIL + 1));
      pen.beginPath();
      pen.moveTo(x(from[0]), y(from[1]));
      pen.lineTo(x(to[0]), y(to[1]));
      pen.stroke();
      from = to;
    }
  }
  pen.globalAlpha = 1;
  pen.lineCap = "round";
}

function drawChoice(pen, x, y, scale, cycle, players, radius) {
  const index = decisionAt(cycle);
  if (index < 0) return;
  const made = decision(index), me = players[made.actor];
  // A pass is shown for half a second: by then the ball is on its way.
  if (cycle - made.time > (made.action ? 5 : 1)) return;
  pen.strokeStyle = colors.choice;
  pen.lineWidth = 2;
  pen.beginPath();
  pen.arc(x(me[0]), y(me[1]), Math.max(KICKABLE * scale, radius + 5), 0, 2 * Math.PI);
  pen.stroke();
  if (made.action === 0) return;
  const mate = players[made.order[made.action]];
  const span = Math.hypot(mate[0] - me[0], mate[1] - me[1]) * scale;
  if (span < 3 * radius) return;
  const along = Math.atan2(mate[1] - me[1], mate[0] - me[0]);
  pen.save();
  pen.translate(x(me[0]), y(me[1]));
  pen.rotate(along);
  pen.lineWidth = 2.5;
  pen.beginPath();
  pen.moveTo(radius + 2, 0);
  pen.lineTo(span - radius - 6, 0);
  pen.moveTo(span - radius - 15, -6);
  pen.lineTo(span - radius - 6, 0);
  pen.lineTo(span - radius - 15, 6);
  pen.stroke();
  pen.restore();
}

function drawPlayer(pen, x, y, player, at, radius) {
  const column = x(at[0]), row = y(at[1]), body = at[2] * Math.PI / 180;
  pen.strokeStyle = colors.ink;
  pen.lineWidth = Math.max(3, radius / 3);
  pen.beginPath();
  pen.moveTo(column, row);
  pen.lineTo(column + 1.5 * radius * Math.cos(body), row + 1.5 * radius * Math.sin(body));
  pen.stroke();
  disc(pen, column, row, radius, colors.rim);
  disc(pen, column, row, radius - 1.5, player < KEEPERS ? colors.keeper : colors.taker);
  if (player >= KEEPERS) return;
  write(pen, String(player + 1), column, row + 0.5, Math.round(1.1 * radius), "#262626");
}

function drawStrip() {
  const [pen, width, height] = sharp(strip);
  const inset = 8, step = (width - 2 * inset) / Math.max(1, lastCycle());
  pen.fillStyle = colors.track;
  pen.fillRect(0, 0, width, height);
  for (let cycle = 0, until = 0; cycle <= lastCycle(); cycle = until) {
    const color = holder(cycle);
    for (until = cycle + 1; until <= lastCycle() && holder(until) === color;) until++;
    if (!color) continue;
    pen.fillStyle = color;
    pen.fillRect(inset + step * (cycle - 0.5), 0, step * (until - cycle), height);
  }
  pen.fillStyle = colors.ink;
  const { time, action } = current().decisions;
  time.forEach((cycle, index) => {
    if (action[index] > 0) pen.fillRect(inset + step * cycle - 0.75, 0, 1.5, height);
  });
}

function holder(cycle) {
  const ball = ballAt(cycle);
  let color = "";
  for (let player = 0; player < PLAYERS; player++) {
    const at = playerAt(cycle, player);
    if (Math.hypot(at[0] - ball[0], at[1] - ball[1]) >= KICKABLE) continue;
    if (player >= KEEPERS) return colors.taker;
    color = colors.keeper;
  }
  return color;
}

function brief(value) {
  if (value === null) return "";
  return String(Number(value.toPrecision(3))).replace("-", "\u2212");
}

function shares(values) {
  const known = values.filter((value) => value !== null);
  const low = Math.min(...known), high = Math.max(...known);
  const zero = low >= 0 ? 0 : low - 0.1 * (high - low);
  return values.map((value) => (value === null || high <= zero ? 0 : (value - zero) / (high - zero)));
}

function tellDecision() {
  const cycle = Math.floor(state.time), index = decisionAt(cycle);
  const said = find("said"), actions = find("actions");
  said.replaceChildren();
  actions.replaceChildren();
  if (index < 0) {
    said.textContent = "No keeper has reached the ball yet.";
    // Empty lines keep everything below in its place.
    for (let action = 0; action < KEEPERS; action++) {
      const item = make("li", "hold", { class: "later" });
      if (current().decisions.values) item.append(make("span", "0"), make("i"));
      actions.append(item);
    }
  } else {
    const made = decision(index);
    said.append(`${seconds(made.time)} s: keeper `, chip(made.actor), " decided to ", make("b", named(made)));
    const lengths = made.values ? shares(made.values) : null;
    made.order.forEach((player, action) => {
      const item = make("li", action === 0 ? "hold" : `pass to ${player + 1}`);
      if (action === made.action) item.setAttribute("aria-current", "true");
      if (lengths) {
        item.append(make("span", brief(made.values[action])));
        item.append(make("i", undefined, { style: `--share: ${lengths[action].toFixed(3)}` }));
      }
      actions.append(item);
    });
  }
  markRow(index);
}

function chip(player) {
  const number = player < KEEPERS ? player + 1 : player - KEEPERS + 1;
  return make("span", String(number), { class: player < KEEPERS ? "chip" : "chip taker" });
}

function listDecisions() {
  // Holding is decided anew in every cycle: a run of holds is one row.
  const body = find("rows"), { time } = current().decisions;
  rows = [];
  time.forEach((cycle, index) => {
    const made = decision(index), previous = rows[rows.length - 1];
    if (previous && made.action === 0 && previous.action === 0 && previous.actor === made.actor
        && cycle - previous.until <= 1) {
      previous.until = cycle;
      previous.last = index;
    } else {
      rows.push({ first: index, last: index, time: cycle, until: cycle, actor: made.actor, action: made.action,
        name: named(made), values: made.values });
    }
  });
  body.replaceChildren(...rows.map((row) => {
    const line = make("tr"), who = make("td");
    const times = row.until - row.time + 1;
    who.append(chip(row.actor));
    line.append(make("td", `${seconds(row.time)} s`, { class: "n" }), who);
    line.append(make("td", times > 1 ? `${row.name} \u00d7 ${times}` : row.name));
    line.append(make("td", row.values ? brief(row.values[row.action]) : "", { class: "n" }));
    line.addEventListener("click", () => { pause(); seek(row.time); });
    row.line = line;
    return line;
  }));
  if (!rows.length) body.append(make("tr", "")), body.lastChild.append(make("td", "none"));
}

function markRow(index) {
  const list = find("list");
  for (const row of rows) {
    const here = index >= row.first && index <= row.last;
    if (here === row.line.hasAttribute("aria-current")) continue;
    if (!here) { row.line.removeAttribute("aria-current"); continue; }
    row.line.setAttribute("aria-current", "true");
    const top = row.line.offsetTop, bottom = top + row.line.offsetHeight;
    if (top < list.scrollTop) list.scrollTop = top - 4;
    if (bottom > list.scrollTop + list.clientHeight) list.scrollTop = bottom - list.clientHeight + 4;
  }
}

function tellCommands() {
  const cycle = Math.floor(state.time), commands = current().commands;
  find("commands").replaceChildren(...Array.from({ length: PLAYERS }, (_, player) => {
    const at = 3 * (cycle * PLAYERS + player), line = make("tr"), who = make("td");
    const [kind, amount, direction] = at + 2 < commands.length ? commands.slice(at, at + 3) : [0, 0, 0];
    who.append(chip(player));
    const text = kind === 3 ? `power ${amount}, direction ${direction}\u00b0` : kind === 2 ? `${amount}\u00b0`
      : kind === 1 ? `power ${amount}` : "";
    line.append(who, make("td", KINDS[kind]), make("td", text.replace(/-/g, "\u2212"), { class: "n" }));
    return line;
  }));
}

let told = "";

function show() {
  const cycle = Math.floor(state.time), over = cycle >= lastCycle();
  drawField();
  const now = `${state.episode}/${cycle}`;
  if (now === told) return;
  told = now;
  scrub.value = cycle;
  const ended = over ? `, ${ENDS[current().end]}` : "";
  scrub.setAttribute("aria-valuetext", `${seconds(cycle)} seconds${ended}`);
  const clock = find("clock");
  clock.replaceChildren(make("b", seconds(cycle)), make("span", ` / ${seconds(lastCycle())} s`));
  field.setAttribute("aria-label", `The field after ${seconds(cycle)} seconds${ended}`);
  tellDecision();
  if (find("commands").closest("details").open) tellCommands();
}

function seek(time) {
  state.time = Math.min(Math.max(time, 0), lastCycle());
  show();
}

function step(now) {
  if (!state.playing) return;
  const passed = Math.min((now - state.last) / 1000, 0.25);
  state.last = now;
  seek(state.time + passed * state.speed * CYCLES_PER_SECOND);
  if (state.time >= lastCycle()) pause(); else requestAnimationFrame(step);
}

function play() {
  if (state.time >= lastCycle()) seek(0);
  state.playing = true;
  state.last = performance.now();
  markPlay();
  requestAnimationFrame(step);
}

function pause() {
  state.playing = false;
  markPlay();
}

function markPlay() {
  const button = find("play");
  const over = !state.playing && lastCycle() > 0 && state.time >= lastCycle();
  const shape = state.playing ? "M2 1h4v12H2zM8 1h4v12H8z" : over ? "M7 1.5a5.5 5.5 0 1 0 5.4 6.6h-2.1A3.5 3.5 0 1 1 7 3.5c.9 0 1.8.4 2.4 1L7.5 6.4H13V.9l-2.1 2.1A5.5 5.5 0 0 0 7 1.5z" : "M3 1l10 6-10 6z";
  button.innerHTML = `<svg viewBox="0 0 14 14" aria-hidden="true"><path d="${shape}"/></svg>`;
  button.setAttribute("aria-label", state.playing ? "Pause" : over ? "Play again" : "Play");
  button.title = `${state.playing ? "Pause" : "Play"} (space)`;
}

function jump(direction) {
  const cycle = Math.floor(state.time), starts = rows.map((row) => row.time);
  const target = direction > 0 ? starts.find((time) => time > cycle) : starts.reverse().find((time) => time < cycle);
  pause();
  seek(target === undefined ? (direction > 0 ? lastCycle() : 0) : target);
}

function setSpeed(speed) {
  state.speed = speed;
  find("speed").value = String(speed);
}

function choose(episode, time = 0) {
  state.episode = Math.min(Math.max(episode, 0), game.episodes.length - 1);
  const playing = state.playing;
  scrub.max = lastCycle();
  find("episode").value = String(state.episode);
  find("earlier").disabled = state.episode === 0;
  find("later").disabled = state.episode === game.episodes.length - 1;
  listDecisions();
  find("list").scrollTop = 0;
  told = "";
  seek(time);
  drawStrip();
  if (!playing) markPlay();
}

function readColors() {
  const style = getComputedStyle(document.documentElement);
  const names = ["grass", "stripe", "chalk", "rim", "ball", "ink", "keeper", "taker", "choice", "track"];
  colors = Object.fromEntries(names.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}

function redraw() {
  readColors();
  drawField();
  drawStrip();
}

function listEpisodes() {
  find("episodes").hidden = game.episodes.length < 2;
  find("episode").replaceChildren(...game.episodes.map((episode, number) => {
    const length = seconds(episode.ball.length / 2 - 1);
    return make("option", `Episode ${number + 1}: ${length} s, ${SHORT_ENDS[episode.end]}`, { value: number });
  }));
}

const KEYS = {
  " ": () => (state.playing ? pause() : play()),
  ArrowLeft: (event) => (event.shiftKey ? jump(-1) : (pause(), seek(Math.ceil(state.time) - 1))),
  ArrowRight: (event) => (event.shiftKey ? jump(1) : (pause(), seek(Math.floor(state.time) + 1))),
  Home: () => seek(0),
  End: () => { pause(); seek(lastCycle()); markPlay(); },
  "+": () => setSpeed(SPEEDS[Math.min(SPEEDS.indexOf(state.speed) + 1, SPEEDS.length - 1)]),
  "-": () => setSpeed(SPEEDS[Math.max(SPEEDS.indexOf(state.speed) - 1, 0)]),
  t: () => { state.trails = find("trails").checked = !state.trails; drawField(); },
  n: () => choose(state.episode + 1),
  p: () => choose(state.episode - 1),
};

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
find("play").addEventListener("click", () => (state.playing ? pause() : play()));
find("back").addEventListener("click", () => { pause(); seek(Math.ceil(state.time) - 1); markPlay(); });
find("forth").addEventListener("click", () => { pause(); seek(Math.floor(state.time) + 1); markPlay(); });
scrub.addEventListener("input", () => { pause(); seek(Number(scrub.value)); markPlay(); });
find("speed").addEventListener("change", (event) => setSpeed(Number(event.target.value)));
find("trails").addEventListener("change", (event) => { state.trails = event.target.checked; drawField(); });
find("episode").addEventListener("change", (event) => choose(Number(event.target.value)));
find("earlier").addEventListener("click", () => choose(state.episode - 1));
find("later").addEventListener("click", () => choose(state.episode + 1));
find("commands").closest("details").addEventListener("toggle", tellCommands);
field.addEventListener("click", () => (state.playing ? pause() : play()));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);

document.documentElement.style.setProperty("--aspect", (LENGTH + 2 * margin()) / (WIDTH + 2 * margin()));
find("subtitle").textContent = game.subtitle;
readColors();
listEpisodes();
// "#episode=2&cycle=31" in the address opens a moment of the game.
const wanted = new URLSearchParams(location.hash.slice(1));
choose((Number(wanted.get("episode")) || 1) - 1, Number(wanted.get("cycle")) || 0);
new ResizeObserver(redraw).observe(field);
