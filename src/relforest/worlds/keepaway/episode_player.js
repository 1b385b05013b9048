// An episode holds one state per cycle: players as x, y in centimetres and body in degrees, one after the
// other, keepers first; the ball as x, y. Decisions and commands belong to the state in which they were made.
const [LENGTH, WIDTH] = game.field;
const KEEPERS = game.keepers, PLAYERS = game.keepers + game.takers;
const KICKABLE = 1.085, TRAIL = 15;
const ENDS = ["stopped", "the ball went out", "a taker took the ball", "cut off"];
const SHORT_ENDS = ["stopped", "out", "taken", "cut off"];
const KINDS = ["nothing", "dash", "turn", "kick"];

let trails = true;

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

const over = () => Math.floor(state.time) >= lastTick();

function margin() { return 0.05 * Math.max(LENGTH, WIDTH); }

function drawField() {
  const [pen, width, height] = sharp(stage);
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

  const cycle = Math.min(Math.floor(state.time), lastTick()), share = state.time - cycle;
  const next = Math.min(cycle + 1, lastTick());
  const players = [];
  for (let player = 0; player < PLAYERS; player++) {
    players.push(between(playerAt(cycle, player), playerAt(next, player), share));
  }
  const ball = between([...ballAt(cycle), 0], [...ballAt(next), 0], share);
  const radius = Math.max(0.4 * scale, Math.min(11, width / 30));
  if (trails) drawTrails(pen, x, y, cycle, players, ball, radius);
  drawChoice(pen, x, y, scale, cycle, players, radius);
  for (let player = PLAYERS - 1; player >= 0; player--) drawPlayer(pen, x, y, player, players[player], radius);
  disc(pen, x(ball[0]), y(ball[1]), 0.5 * radius + 1.5, colors.rim);
  disc(pen, x(ball[0]), y(ball[1]), 0.5 * radius, colors.ball);
  if (over()) write(pen, ENDS[current().end], width / 2, y(-WIDTH / 2) / 2, 13, colors.ink);
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
  return signed(Number(value.toPrecision(3)));
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
}

function chip(player) {
  const number = player < KEEPERS ? player + 1 : player - KEEPERS + 1;
  return make("span", String(number), { class: player < KEEPERS ? "chip" : "chip taker" });
}

function tellCommands() {
  const cycle = Math.floor(state.time), commands = current().commands;
  find("commands").replaceChildren(...Array.from({ length: PLAYERS }, (_, player) => {
    const at = 3 * (cycle * PLAYERS + player), line = make("tr"), who = make("td");
    const [kind, amount, direction] = at + 2 < commands.length ? commands.slice(at, at + 3) : [0, 0, 0];
    who.append(chip(player));
    const text = kind === 3 ? `power ${amount}, direction ${direction}\u00b0` : kind === 2 ? `${amount}\u00b0`
      : kind === 1 ? `power ${amount}` : "";
    line.append(who, make("td", KINDS[kind]), make("td", signed(text), { class: "n" }));
    return line;
  }));
}

function paintStrip(pen, width, height, x) {
  for (let cycle = 0, until = 0; cycle <= lastTick(); cycle = until) {
    const color = holder(cycle);
    for (until = cycle + 1; until <= lastTick() && holder(until) === color;) until++;
    if (!color) continue;
    pen.fillStyle = color;
    pen.fillRect(x(cycle - 0.5), 0, x(until) - x(cycle), height);
  }
  pen.fillStyle = colors.ink;
  const { time, action } = current().decisions;
  time.forEach((cycle, index) => {
    if (action[index] > 0) pen.fillRect(x(cycle) - 0.75, 0, 1.5, height);
  });
}

function decisions() {
  // Holding is decided anew in every cycle: a run of holds is one row.
  const runs = [];
  current().decisions.time.forEach((cycle, index) => {
    const made = decision(index), previous = runs[runs.length - 1];
    if (previous && made.action === 0 && previous.action === 0 && previous.actor === made.actor
        && cycle - previous.until <= 1) {
      previous.until = cycle;
    } else {
      runs.push({ ...made, from: cycle, until: cycle });
    }
  });
  return runs.map((run) => {
    const times = run.until - run.from + 1;
    const name = times > 1 ? `${named(run)} \u00d7 ${times}` : named(run);
    const value = run.values ? brief(run.values[run.action]) : "";
    return { from: run.from, cells: [cell(`${seconds(run.from)} s`, "n"), cell(chip(run.actor)), cell(name), cell(value, "n")] };
  });
}

function tell() {
  tellDecision();
  if (find("commands").closest("details").open) tellCommands();
  return over() ? ENDS[current().end] : "";
}

function setTrails(on) {
  trails = find("trails").checked = on;
  drawField();
}

find("trails").addEventListener("change", (event) => setTrails(event.target.checked));
find("commands").closest("details").addEventListener("toggle", tellCommands);
startPlayer({
  rate: 10,
  stops: false,
  aspect: (LENGTH + 2 * margin()) / (WIDTH + 2 * margin()),
  colors: ["grass", "stripe", "chalk", "rim", "ball", "ink", "keeper", "taker", "choice", "track"],
  last: (episode) => episode.ball.length / 2 - 1,
  name: (episode) => SHORT_ENDS[episode.end],
  moments: decisions,
  draw: drawField,
  strip: paintStrip,
  tell,
  keys: { t: () => setTrails(!trails) },
});
