// An episode holds, for each picture, how far every block moved since the one before: x and y in hundredths of
// a unit, the angle in thousandths of a radian. The first picture counts from 0.
const ASPECT = 1.4, LINES = 10, THICKNESS = 3;
const LEGENDS = {
  "high-towers": "The green line is at the mean height of all blocks.",
  "color-grouping": "A green line under a stack tells what it scores: from \u22121 to 1 for each block but one.",
  "arch": "The green area is what an arch scores.",
};

for (const episode of game.episodes) {
  const width = 3 * episode.ids.length, { moves } = episode;
  for (let at = width; at < moves.length; at++) moves[at] += moves[at - width];
  episode.view = viewOf(episode);
  episode.rest = restOf(episode);
}

function poseAt(episode, tick, block) {
  const at = 3 * (tick * episode.ids.length + block), { moves } = episode;
  return [moves[at] / 100, moves[at + 1] / 100, moves[at + 2] / 1000];
}

function isGone(episode, tick, block) {
  return episode.gone[block] !== null && tick >= episode.gone[block];
}

function between(first, second, share) {
  return first.map((value, part) => value + share * (second[part] - value));
}

function heldAt(episode, tick) {
  let held = -1;
  for (const [from, block] of episode.held) if (from <= tick) held = block;
  return episode.ids.indexOf(held);
}

function viewOf(episode) {
  // What lies within is in view during the whole episode: everything, but no block that falls from the table.
  let left = -20, right = 20, high = 20;
  for (let tick = 0; tick < episode.ticks; tick++) {
    episode.ids.forEach((_, block) => {
      const [x, y] = poseAt(episode, tick, block), reach = Math.hypot(...episode.sides[block]);
      if (isGone(episode, tick, block) || Math.abs(x) > 110) return;
      left = Math.min(left, x - reach);
      right = Math.max(right, x + reach);
      high = Math.max(high, y + reach);
    });
  }
  return { left: left - 2, right: right + 2, high: high + 4 };
}

function restOf(episode) {
  // What the small pictures show: between options no block is in the air.
  const { left, right } = episode.view;
  let high = 12;
  for (const { from } of [...episode.options, { from: Infinity }]) {
    const tick = Math.min(from, episode.ticks - 1);
    episode.ids.forEach((_, block) => {
      if (isGone(episode, tick, block)) return;
      high = Math.max(high, poseAt(episode, tick, block)[1] + Math.hypot(...episode.sides[block]));
    });
  }
  return { left, right, high: high + 2 };
}

function optionAt(tick) {
  // The last option that began in or before a tick; during the drop there is none.
  const { options } = current();
  let index = -1;
  while (index + 1 < options.length && options[index + 1].from <= tick) index++;
  return index;
}

function light(color) {
  const [red, green, blue] = [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16) / 255);
  return 0.299 * red + 0.587 * green + 0.114 * blue;
}

const over = (color) => (light(color) > 0.5 ? "#262626" : "#ffffff");

function scaled(width, height, { left, right, high }, below) {
  const scale = Math.min(width / (right - left), (height - below) / high), middle = (left + right) / 2;
  return {
    scale,
    x: (value) => width / 2 + scale * (value - middle),
    y: (value) => height - below - scale * value,
  };
}

function drawTable(pen, width, height, { scale, x, y }, { labels }) {
  pen.fillStyle = colors.sky;
  pen.fillRect(0, 0, width, height);
  const every = LINES * (scale * LINES < 28 ? 2 : 1);
  for (let level = every; labels && y(level) > 40; level += every) {
    pen.fillStyle = colors.level;
    pen.fillRect(30, Math.round(y(level)), width - 40, 1);
    write(pen, String(level), 26, y(level), 10, colors.grey, { align: "right", weight: 400 });
  }
  const left = Math.max(x(-100), 0), right = Math.min(x(100), width);
  pen.fillStyle = colors.wood;
  pen.fillRect(left, y(0), right - left, Math.max(THICKNESS * scale, 6));
  pen.fillStyle = colors.edge;
  pen.fillRect(left, y(0), right - left, 1.5);
}

function trace(pen, frame, pose, [wide, high], grow) {
  pen.save();
  pen.translate(frame.x(pose[0]), frame.y(pose[1]));
  pen.rotate(-pose[2]);
  pen.beginPath();
  const [w, h] = [wide * frame.scale + grow, high * frame.scale + grow];
  pen.rect(-w, -h, 2 * w, 2 * h);
  pen.restore();
}

function drawBlock(pen, frame, episode, block, pose) {
  const color = episode.colors[block];
  trace(pen, frame, pose, episode.sides[block], 0);
  pen.fillStyle = color;
  pen.fill();
  trace(pen, frame, pose, episode.sides[block], -0.5);
  pen.lineWidth = 1;
  pen.strokeStyle = colors.outline;
  pen.stroke();
}

function drawName(pen, frame, episode, block, pose) {
  const color = episode.colors[block], text = String(episode.ids[block]);
  const [wide, high] = episode.sides[block].map((side) => side * frame.scale);
  const along = Math.abs(Math.cos(pose[2])), across = Math.abs(Math.sin(pose[2]));
  const x = frame.x(pose[0]), y = frame.y(pose[1]);
  for (const size of [15, 13, 11, 9]) {
    const half = 0.32 * size * text.length, tall = 0.37 * size;
    if (half * along + tall * across > wide || half * across + tall * along > high) continue;
    write(pen, text, x, y + 0.5, size, over(color));
    return;
  }
  const half = 3.3 * text.length + 3;
  pen.beginPath();
  pen.roundRect(x - half, y - 7, 2 * half, 14, 7);
  pen.fillStyle = color;
  pen.fill();
  pen.lineWidth = 1;
  pen.strokeStyle = colors.outline;
  pen.stroke();
  write(pen, text, x, y + 0.5, 9.5, over(color));
}

function drawMarks(pen, frame, marks, strength) {
  if (strength <= 0) return;
  pen.globalAlpha = strength;
  for (const [left, right, low, high, score] of marks) {
    const x = frame.x(left), y = frame.y(high), wide = frame.scale * (right - left), tall = frame.scale * (high - low);
    pen.fillStyle = pen.strokeStyle = colors.mark;
    if (tall > 0) {
      pen.save();
      pen.globalAlpha = 0.3 * strength;
      pen.fillRect(x, y, wide, tall);
      pen.restore();
      pen.lineWidth = 1.5;
      pen.strokeRect(x, y, wide, tall);
      write(pen, signed(score, 1), x + wide / 2, y + tall / 2, 13, colors.ink);
    } else {
      pen.fillRect(x, y + 5, wide, 3);
      write(pen, signed(score, 2), x + wide / 2, y + 18, 12, colors.mark);
    }
  }
  pen.globalAlpha = 1;
}

function drawOption(pen, frame, option, poses, gone) {
  const episode = current();
  pen.strokeStyle = colors.choice;
  option.blocks.forEach((id, argument) => {
    const block = episode.ids.indexOf(id);
    if (gone[block]) return;
    trace(pen, frame, poses[block], episode.sides[block], 3.5);
    pen.lineWidth = 2;
    pen.setLineDash(argument ? [5, 4] : []);
    pen.stroke();
  });
  pen.setLineDash([5, 4]);
  if (option.target !== null) {
    pen.beginPath();
    pen.moveTo(frame.x(option.target), 34);
    pen.lineTo(frame.x(option.target), frame.y(0));
    pen.lineWidth = 1.5;
    pen.stroke();
  }
  pen.setLineDash([]);
}

function drawMean(pen, frame, width, poses, gone) {
  const there = poses.filter((_, block) => !gone[block]);
  if (!there.length) return;
  const mean = there.reduce((sum, pose) => sum + pose[1], 0) / there.length, y = frame.y(mean);
  pen.fillStyle = colors.mark;
  pen.fillRect(34, Math.round(y) - 0.5, width - 44, 1.5);
  write(pen, mean.toFixed(2), width - 10, y - 9, 12, colors.mark, { align: "right" });
}

function drawStage() {
  const episode = current(), [pen, width, height] = sharp(stage);
  const tick = Math.min(Math.floor(state.time), lastTick()), next = Math.min(tick + 1, lastTick());
  const frame = scaled(width, height, episode.view, 26);
  const gone = episode.ids.map((_, block) => isGone(episode, tick, block));
  const poses = episode.ids.map((_, block) => (
    between(poseAt(episode, tick, block), poseAt(episode, next, block), state.time - tick)
  ));
  drawTable(pen, width, height, frame, { labels: true });
  const index = optionAt(tick), option = episode.options[index];
  const done = index < 0 || tick >= option.until;
  if (game.task === "high-towers") drawMean(pen, frame, width, poses, gone);
  poses.forEach((pose, block) => { if (!gone[block]) drawBlock(pen, frame, episode, block, pose); });
  if (!done) drawOption(pen, frame, option, poses, gone);
  const held = heldAt(episode, tick);
  if (held >= 0 && !gone[held]) drawGrip(pen, frame.x(poses[held][0]), frame.y(poses[held][1]));
  poses.forEach((pose, block) => { if (!gone[block]) drawName(pen, frame, episode, block, pose); });
  drawMarks(pen, frame, episode.marks[index + 1], seen(episode, index, tick));
  if (index >= 0 && !done) drawMarks(pen, frame, episode.marks[index], 1 - (state.time - option.from) / game.rate);
  write(pen, index < 0 ? "drop" : inWords(option), 14, 18, 15, colors.ink, { align: "left" });
  write(pen, `${game.score} ${signed(scoreAt(episode, index, tick), 2)}`, width - 14, 18, 13, colors.grey, { align: "right", weight: 400 });
}

function seen(episode, index, tick) {
  // Marks belong to states in which nothing moves: before the first option, and once one is over.
  const { options } = episode;
  if (index >= 0) return tick >= options[index].until || tick >= lastTick() ? 1 : 0;
  return !options.length && tick >= lastTick() ? 1 : 0;
}

function scoreAt(episode, index, tick) {
  const done = index >= 0 && (tick >= episode.options[index].until || tick >= lastTick());
  return done ? episode.options[index].score : index > 0 ? episode.options[index - 1].score : episode.first;
}

function drawGrip(pen, x, y) {
  for (const [color, thickness] of [["#ffffff", 5], [colors.grip, 2.5]]) {
    pen.beginPath();
    pen.arc(x, y, 11, 0, 2 * Math.PI);
    pen.strokeStyle = color;
    pen.lineWidth = thickness;
    pen.stroke();
  }
}

function drawSmall(id, tick, marks) {
  const episode = current(), [pen, width, height] = sharp(find(id));
  const frame = scaled(width, height, episode.rest, 9);
  drawTable(pen, width, height, frame, { labels: false });
  episode.ids.forEach((_, block) => {
    if (!isGone(episode, tick, block)) drawBlock(pen, frame, episode, block, poseAt(episode, tick, block));
  });
  for (const [left, right, low, high] of marks) {
    pen.globalAlpha = 0.5;
    pen.fillStyle = colors.mark;
    const tall = frame.scale * (high - low);
    pen.fillRect(frame.x(left), frame.y(high) + (tall ? 0 : 3), frame.scale * (right - left), tall || 2);
    pen.globalAlpha = 1;
  }
}

function inWords(option) {
  const parts = option.blocks.map(String);
  if (option.target !== null) parts.push(`x = ${signed(option.target, 1)}`);
  return parts.length ? `${option.name}(${parts.join(", ")})` : option.name;
}

function chip(id) {
  const episode = current(), color = episode.colors[episode.ids.indexOf(id)];
  return make("span", String(id), { class: "chip", style: `background: ${color}; color: ${over(color)}` });
}

function chipped(option) {
  // "put 3 on 1", with the blocks in their colours.
  const words = make("span", `${option.name} `);
  option.blocks.forEach((id, argument) => words.append(argument ? " on " : "", chip(id)));
  if (option.target !== null) words.append(` to ${signed(option.target, 1)}`);
  return words;
}

function plus(value) {
  // Not "-0.00", nor "+0.00".
  const rounded = Number(value.toFixed(2)) || 0;
  return `${rounded > 0 ? "+" : ""}${signed(rounded, 2)}`;
}

function moments() {
  return current().options.map((option) => ({
    from: option.from,
    cells: [cell(seconds(option.from), "n"), cell(chipped(option)), cell(option.duration.toFixed(1), "n"), cell(plus(option.reward), "n")],
  }));
}

let shown = "";

function tell(tick) {
  const episode = current(), index = optionAt(tick), option = episode.options[index];
  const which = `${state.episode}/${index}`;
  if (which !== shown) {
    shown = which;
    tellOption(episode, index, option);
  }
  return tick >= lastTick() ? `${game.score} ${signed(scoreAt(episode, index, tick), 2)}` : "";
}

function tellOption(episode, index, option) {
  const said = find("said"), first = episode.options.length ? episode.options[0].from : lastTick();
  const { left, right, high } = episode.rest;
  find("change").style.setProperty("--flatness", Math.min(Math.max((right - left) / (high + 4), 0.9), 2.2));
  find("length").textContent = seconds(lastTick());
  find("total").textContent = plus(episode.total);
  if (option) {
    said.replaceChildren(chipped(option), make("small", `${option.duration.toFixed(1)} s, reward ${plus(option.reward)}`));
  } else {
    said.replaceChildren("The blocks fall onto the table", make("small", `for ${seconds(first)} s`));
  }
  find("worse").textContent = option ? signed(index ? episode.options[index - 1].score : episode.first, 2) : "";
  find("better").textContent = signed(option ? option.score : episode.first, 2);
  drawChange();
}

function drawChange() {
  const episode = current(), index = optionAt(Math.floor(state.time)), option = episode.options[index];
  const first = episode.options.length ? episode.options[0].from : lastTick();
  drawSmall("before", option ? option.from : 0, option ? episode.marks[index] : []);
  drawSmall("after", Math.min(option ? option.until : first, lastTick()), episode.marks[index + 1]);
}

function paintStrip(pen, width, height, x) {
  const { options } = current();
  options.forEach((option, index) => {
    const from = x(option.from), until = x(Math.min(option.until, lastTick()));
    pen.fillStyle = index % 2 ? colors.edge : colors.wood;
    pen.fillRect(from, 0, Math.max(until - from - 1, 1), height);
  });
}

find("legend").textContent = LEGENDS[game.task];
find("before").addEventListener("click", () => { pause(); seek((current().options[optionAt(Math.floor(state.time))] || { from: 0 }).from); });
find("after").addEventListener("click", () => {
  const option = current().options[optionAt(Math.floor(state.time))];
  pause();
  // Just before the next option begins.
  seek(option ? option.until - 1 : (current().options[0] || { from: lastTick() }).from - 1);
});
startPlayer({
  rate: game.rate,
  stops: true,
  aspect: ASPECT,
  colors: ["sky", "level", "wood", "edge", "mark", "ink", "grey", "choice", "track", "outline", "grip"],
  last: (episode) => episode.ticks - 1,
  name: (episode) => `total ${plus(episode.total)}`,
  moments,
  draw: drawStage,
  strip: paintStrip,
  tell,
});
new ResizeObserver(drawChange).observe(find("before"));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", drawChange);
