"use strict";

// What every player of episodes does, whatever they show: time, controls, keys, lists of episodes and moments.
// Time is counted in ticks. The script of a world follows this one and ends with startPlayer(world), where
//   rate           ticks per second
//   stops          true if the buttons beside "play" go to the next moment, not to the next tick
//   aspect         width over height of the stage
//   colors         names of the style's colours to draw with, for `colors`
//   last(episode)  the last tick of an episode
//   name(episode)  what to call it in the list, after its length
//   moments()      the rows of the list: {from: tick, cells: [td, ...]}, in order
//   draw()         draws the stage at state.time
//   strip(pen, width, height, x)  draws the band above the slider; x(tick) is a column
//   tell(tick)     says in words what goes on; returns how the episode ended, "" before
//   keys           more keys: {key: function}
const game = JSON.parse(document.getElementById("game").textContent);
const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8];
const state = { episode: 0, time: 0, playing: false, speed: 1, last: 0 };
let world = null, colors = {}, rows = [], told = "";

const find = (id) => document.getElementById(id);
const stage = find("stage"), band = find("strip"), scrub = find("scrub");
const current = () => game.episodes[state.episode];
const lastTick = () => world.last(current());
const seconds = (tick) => (tick / world.rate).toFixed(1);

function make(tag, text, attributes = {}) {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  return element;
}

function cell(content, kind) {
  const element = make("td", undefined, kind ? { class: kind } : {});
  element.append(content);
  return element;
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

function write(pen, text, x, y, size, color, { align = "center", weight = 650 } = {}) {
  pen.fillStyle = color;
  pen.font = `${weight} ${size}px system-ui, "DejaVu Sans", sans-serif`;
  pen.textAlign = align;
  pen.textBaseline = "middle";
  pen.fillText(text, x, y);
}

function drawStrip() {
  const [pen, width, height] = sharp(band);
  // As far from the ends as the middle of the slider's knob.
  const inset = 8, step = (width - 2 * inset) / Math.max(1, lastTick());
  pen.fillStyle = colors.track;
  pen.fillRect(0, 0, width, height);
  world.strip(pen, width, height, (tick) => inset + step * tick);
}

function signed(value, digits) {
  return String(digits === undefined ? value : value.toFixed(digits)).replace(/-/g, "\u2212");
}

function listMoments() {
  rows = world.moments();
  const body = find("rows");
  body.replaceChildren(...rows.map((row) => {
    row.line = make("tr");
    row.line.append(...row.cells);
    row.line.addEventListener("click", () => { pause(); seek(row.from); });
    return row.line;
  }));
  if (!rows.length) body.append(make("tr", "")), body.lastChild.append(make("td", "none"));
}

function markMoment(tick) {
  const list = find("list");
  let now = -1;
  while (now + 1 < rows.length && rows[now + 1].from <= tick) now++;
  rows.forEach((row, index) => {
    if ((index === now) === row.line.hasAttribute("aria-current")) return;
    if (index !== now) { row.line.removeAttribute("aria-current"); return; }
    row.line.setAttribute("aria-current", "true");
    const top = row.line.offsetTop, bottom = top + row.line.offsetHeight;
    if (top < list.scrollTop) list.scrollTop = top - 4;
    if (bottom > list.scrollTop + list.clientHeight) list.scrollTop = bottom - list.clientHeight + 4;
  });
}

function show() {
  const tick = Math.floor(state.time);
  world.draw();
  const now = `${state.episode}/${tick}`;
  if (now === told) return;
  told = now;
  scrub.value = tick;
  markMoment(tick);
  const end = world.tell(tick), ended = end ? `, ${end}` : "";
  scrub.setAttribute("aria-valuetext", `${seconds(tick)} seconds${ended}`);
  find("clock").replaceChildren(make("b", seconds(tick)), make("span", ` / ${seconds(lastTick())} s`));
  stage.setAttribute("aria-label", `The stage after ${seconds(tick)} seconds${ended}`);
}

function seek(time) {
  state.time = Math.min(Math.max(time, 0), lastTick());
  show();
}

function step(now) {
  if (!state.playing) return;
  const passed = Math.min((now - state.last) / 1000, 0.25);
  state.last = now;
  seek(state.time + passed * state.speed * world.rate);
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

function choose(episode, time = 0) {
  state.episode = Math.min(Math.max(episode, 0), game.episodes.length - 1);
  scrub.max = lastTick();
  find("episode").value = String(state.episode);
  find("earlier").disabled = state.episode === 0;
  find("later").disabled = state.episode === game.episodes.length - 1;
  listMoments();
  find("list").scrollTop = 0;
  told = "";
  seek(time);
  drawStrip();
  if (!state.playing) markPlay();
}

function readColors() {
  const style = getComputedStyle(document.documentElement);
  colors = Object.fromEntries(world.colors.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}

function redraw() {
  readColors();
  world.draw();
  drawStrip();
}

function listEpisodes() {
  find("episodes").hidden = game.episodes.length < 2;
  find("episode").replaceChildren(...game.episodes.map((episode, number) => (
    make("option", `Episode ${number + 1}: ${seconds(world.last(episode))} s, ${world.name(episode)}`, { value: number })
  )));
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
};

function listen() {
  const keys = { ...KEYS, ...world.keys }, beside = world.stops ? jump : nudge;
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const within = event.target.closest("select, summary, input[type=checkbox], button");
    if (within && (event.key === " " || within.tagName === "SELECT")) return;
    const act = keys[event.key === "=" ? "+" : event.key];
    if (!act) return;
    event.preventDefault();
    act(event);
    markPlay();
  });
  find("play").addEventListener("click", toggle);
  find("back").addEventListener("click", () => beside(-1));
  find("forth").addEventListener("click", () => beside(1));
  scrub.addEventListener("input", () => { pause(); seek(Number(scrub.value)); markPlay(); });
  find("speed").addEventListener("change", (event) => setSpeed(Number(event.target.value)));
  find("episode").addEventListener("change", (event) => choose(Number(event.target.value)));
  find("earlier").addEventListener("click", () => choose(state.episode - 1));
  find("later").addEventListener("click", () => choose(state.episode + 1));
  stage.addEventListener("click", toggle);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
}

function startPlayer(what) {
  world = what;
  document.documentElement.style.setProperty("--aspect", world.aspect);
  find("subtitle").textContent = game.subtitle;
  find("speed").replaceChildren(...SPEEDS.map((speed) => make("option", `${speed}\u00d7`, { value: speed })));
  setSpeed(1);
  readColors();
  listEpisodes();
  listen();
  // "#episode=2&tick=31" in the address opens a moment of an episode.
  const wanted = new URLSearchParams(location.hash.slice(1));
  choose((Number(wanted.get("episode")) || 1) - 1, Number(wanted.get("tick")) || 0);
  new ResizeObserver(redraw).observe(stage);
}
