// The scene on a stage, and what the model says about it; `evaluate` and `model` are defined above.
const scene = JSON.parse(document.getElementById("scene").textContent);
const find = id => document.getElementById(id);
const shades = ["#0072B2", "#E69F00", "#009E73", "#CC79A7", "#D55E00", "#56B4E9", "#F0E442"];
const [left, right, low, high] = scene.view;
// The longer side of the stage has this many units, about as many as pixels.
const scale = 600 / Math.max(right - left, scene.y < 0 ? 0 : high - low);
const width = (right - left) * scale, height = scene.y < 0 ? 200 : (high - low) * scale;
const start = scene.objects.map(values => values.map(value => value === null ? NaN : value));
let objects = start.map(values => [...values]);
let picked = 0;
let answer = null;

// Adds an element, of SVG within a drawing.
function made(parent, name, attributes = {}, text = "") {
  const node = document.createElementNS(parent.namespaceURI, name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(text);
  parent.append(node);
  return node;
}

function short(value) {
  return Number.isNaN(value) ? "unknown" : String(Number(value.toPrecision(3)));
}

// Where an object is drawn; what is not known or not drawn is spread over the stage.
function placed(number) {
  const spread = (number + 0.5) / objects.length;
  const x = scene.x < 0 ? NaN : objects[number][scene.x], y = scene.y < 0 ? NaN : objects[number][scene.y];
  return [
    Number.isNaN(x) ? spread * width : (x - left) * scale,
    Number.isNaN(y) ? (scene.y < 0 ? 0.2 + 0.6 * spread : 0.97) * height : (high - y) * scale,
  ];
}

function move(number, x, y) {
  if (scene.x >= 0) objects[number][scene.x] = left + Math.min(Math.max(x, 0), width) / scale;
  if (scene.y >= 0) objects[number][scene.y] = high - Math.min(Math.max(y, 0), height) / scale;
  update();
}

const groups = objects.map((_, number) => {
  const group = made(find("stage"), "g", {tabindex: 0, role: "button", "aria-label": `object ${scene.ids[number]}`});
  for (const [kind, radius] of [["hit", 20], ["ring", 14], ["dot", 9]]) made(group, "circle", {class: kind, r: radius});
  made(group, "line", {class: "heading"});
  made(group, "text", {class: "id", y: 24}, objects.length > 12 ? "" : scene.ids[number]);
  made(group, "text", {class: "name", y: -16});
  made(group, "title", {}, scene.ids[number]);
  group.addEventListener("pointerdown", event => {
    pick(number);
    group.focus({preventScroll: true});
    group.setPointerCapture(event.pointerId);
    event.preventDefault();
  });
  // Otherwise a finger would scroll the page.
  group.addEventListener("touchstart", event => event.preventDefault(), {passive: false});
  group.addEventListener("pointermove", event => {
    if (!group.hasPointerCapture(event.pointerId)) return;
    const frame = find("stage").getBoundingClientRect();
    move(number, (event.clientX - frame.left) / frame.width * width, (event.clientY - frame.top) / frame.height * height);
  });
  group.addEventListener("focus", () => pick(number));
  group.addEventListener("keydown", event => {
    const way = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[event.key];
    if (way === undefined) return;
    event.preventDefault();
    const [x, y] = placed(number), step = event.shiftKey ? 30 : 3;
    move(number, x + step * way[0], y + step * way[1]);
  });
  return group;
});

function pick(number) {
  if (number !== picked) {
    picked = number;
    fillForm();
    update();
  }
}

// The attributes of the chosen object as fields that can be changed.
function fillForm() {
  const form = find("chosen");
  form.replaceChildren();
  made(form, "strong", {}, scene.ids[picked]);
  made(form, "span");
  model.columns.forEach(({name, kind, categories}, column) => {
    made(form, "label", {for: `field${column}`}, kind === "angle" ? `${name} (rad)` : name);
    if (kind !== "category") {
      made(form, "input", {id: `field${column}`, type: "number", step: "any"}).addEventListener("input", event => {
        const value = event.target.value === "" ? NaN : Number(event.target.value);
        objects[picked][column] = kind === "angle" ? wrapped(value) : value;
        update(column);
      });
      return;
    }
    const field = made(form, "select", {id: `field${column}`});
    made(field, "option", {value: ""}, "unknown");
    categories.forEach((category, place) => made(field, "option", {value: place}, category));
    field.addEventListener("change", () => {
      objects[picked][column] = field.value === "" ? NaN : Number(field.value);
      update(column);
    });
  });
}

// Names of the objects that decide in the first tree, which is the only one of a tree.
function decisive() {
  const names = new Map();
  if (model.says.length > 0) {
    answer.trees[0].path[0].found.bound.forEach((place, variable) => names.set(letter(variable), place));
  }
  return names;
}

function drawStage(names) {
  const called = new Map();
  scene.arguments.forEach((place, number) => called.set(place, [model.parameters[number]]));
  for (const [name, place] of names) called.set(place, [name, ...(called.get(place) ?? []).filter(each => each !== name)]);
  const witnesses = new Set(names.values());
  // The stage shrinks on narrow screens; objects and their names do not.
  const unit = width / (find("stage").clientWidth || width);
  groups.forEach((group, number) => {
    const [x, y] = placed(number), values = objects[number];
    group.setAttribute("transform", `translate(${x.toFixed(2)} ${y.toFixed(2)}) scale(${unit.toFixed(3)})`);
    group.classList.toggle("argument", scene.arguments.includes(number));
    group.classList.toggle("witness", witnesses.has(number));
    group.classList.toggle("picked", number === picked);
    group.classList.toggle("unknown", [scene.x, scene.y].some(column => column >= 0 && Number.isNaN(values[column])));
    const shade = scene.color < 0 ? NaN : values[scene.color];
    group.querySelector(".dot").style.fill = Number.isNaN(shade) ? "" : shades[shade % shades.length];
    group.querySelector(".name").textContent = (called.get(number) ?? []).join(", ");
    const heading = scene.heading < 0 ? NaN : values[scene.heading], line = group.querySelector(".heading");
    line.setAttribute("x2", Number.isNaN(heading) ? 0 : 15 * Math.cos(heading));
    line.setAttribute("y2", Number.isNaN(heading) ? 0 : -15 * Math.sin(heading));
  });
}

function tellShares() {
  const list = find("shares"), {shares, scores} = answer;
  list.replaceChildren();
  if (shares === null) {
    made(list, "li", {class: "said"}, short(scores[0]));
    return;
  }
  const chosen = shares.length === 2 ? Number(shares[1] >= model.threshold) : shares.indexOf(Math.max(...shares));
  shares.forEach((share, place) => {
    const item = made(list, "li", place === chosen ? {class: "said"} : {});
    made(item, "span", {}, model.classes[place]);
    made(item, "span", {}, share.toFixed(3));
    made(item, "i").style.setProperty("--share", share);
  });
}

function letter(variable) {
  return variable < 26 ? String.fromCharCode(65 + variable) : `V${variable}`;
}

function named(name, place) {
  const role = model.parameters[model.says.length ? name.charCodeAt(0) - 65 : -1];
  return `${name}${role === undefined || role === name ? "" : ` (${role})`} = ${place < 0 ? "no object" : scene.ids[place]}`;
}

// The answers on the way to the leaf of a single tree, or the conditions of the trees that add most.
function tellReasons(names) {
  find("witnesses").textContent = [...names].map(([name, place]) => named(name, place)).join(", ");
  const list = find("reasons");
  list.replaceChildren();
  if (model.says.length > 0) {
    const {leaf, path} = answer.trees[0];
    find("leaf").textContent = `Leaf ${leaf}: ${model.says[leaf]}`;
    const {rule, found} = path.at(-1);
    rule.asked.forEach(({answer: given, said}, place) => {
      const item = made(list, "li");
      made(item, "span", {}, said);
      made(item, "b", {class: given}, given);
      if (given === "error") return;
      made(item, "small", {}, `density ${short(Math.exp(found.densities[place]))}`);
    });
    return;
  }
  const output = answer.scores.length - 1;
  const trees = answer.trees.map(({leaf, path}, number) => ({path, adds: model.values[number][leaf][output]}));
  trees.sort((one, other) => Math.abs(other.adds) - Math.abs(one.adds));
  find("leaf").textContent = `Score ${short(answer.scores[output])}: ${short(model.start[output])} and what ${trees.length} trees add`;
  for (const {path, adds} of trees.slice(0, 12)) {
    const item = made(list, "li");
    const {rule, found} = path.at(-1) ?? {rule: {said: "always", asked: []}, found: {bound: []}};
    const said = rule.said || rule.asked.map(asked => `${asked.said}: ${asked.answer}`).join("; ");
    made(item, "span", {}, found === null ? `it is not so that ${said}` : said);
    made(item, "b", {class: adds >= 0 ? "yes" : "no"}, `${adds >= 0 ? "+" : ""}${short(adds)}`);
    const deciding = found === null || rule.every ? [] : found.bound;
    const names = deciding.map((place, variable) => named(rule.names?.[variable] ?? letter(variable), place));
    made(item, "small", {}, names.join(", "));
  }
}

// The prediction in each cell of the stage if the chosen object stood there, some rows at a time.
let unfinished = 0;
function drawMap() {
  cancelAnimationFrame(unfinished);
  const map = find("map"), isDrawn = find("mapped").checked && scene.x >= 0;
  map.hidden = !isDrawn;
  if (!isDrawn) return;
  const columns = Math.round(width / 12), rows = scene.y < 0 ? 1 : Math.round(height / 12);
  Object.assign(map, {width: columns, height: rows});
  const pen = map.getContext("2d"), before = objects[picked];
  const numbers = model.values.flatMap(values => values.map(leaf => leaf[0]));
  const [least, most] = [Math.min(...numbers), Math.max(...numbers)];
  let row = 0;
  function drawRows() {
    const end = performance.now() + 8;
    while (row < rows && performance.now() < end) {
      for (let column = 0; column < columns; column++) {
        objects[picked] = [...before];
        objects[picked][scene.x] = left + (column + 0.5) / columns * (right - left);
        if (scene.y >= 0) objects[picked][scene.y] = high - (row + 0.5) / rows * (high - low);
        const {shares, scores} = evaluate(objects, scene.arguments);
        const share = shares === null ? (scores[0] - least) / (most - least || 1) : shares.at(-1);
        pen.fillStyle = `color-mix(in srgb, #0072b2 ${Math.round(100 * Math.min(Math.max(share, 0), 1))}%, #d55e00)`;
        pen.fillRect(column, row, 1, 1);
      }
      row += 1;
    }
    objects[picked] = before;
    if (row < rows) unfinished = requestAnimationFrame(drawRows);
  }
  unfinished = requestAnimationFrame(drawRows);
}

function update(edited = -1) {
  performance.mark("moved");
  answer = evaluate(objects, scene.arguments);
  const names = decisive();
  drawStage(names);
  tellShares();
  tellReasons(names);
  performance.measure("answer", "moved");
  model.columns.forEach((_, column) => {
    const field = find(`field${column}`), value = objects[picked]?.[column];
    if (field && column !== edited) field.value = Number.isNaN(value) ? "" : field.type === "number" ? Number(value.toPrecision(6)) : value;
  });
  drawMap();
}

find("frame").style.setProperty("--aspect", width / height);
find("stage").setAttribute("viewBox", `0 0 ${width} ${height}`);
find("outcome").textContent = `${model.link === "number" ? "Predicted:" : "Probability of"} ${model.outcome}`;
addEventListener("resize", () => update());
find("mapped").addEventListener("change", drawMap);
find("reset").addEventListener("click", () => {
  objects = start.map(values => [...values]);
  update();
});
if (scene.color >= 0) {
  const {name, categories} = model.columns[scene.color];
  find("legend").append(`${name}: `);
  categories.forEach((category, place) => {
    made(find("legend"), "span", {}, " \u25cf ").style.color = shades[place % shades.length];
    find("legend").append(category);
  });
}
fillForm();
update();
// Browsers compile what has run often: so the first drag is answered at once.
setTimeout(() => {
  const end = performance.now() + 150;
  for (let count = 0; count < 50 && performance.now() < end; count++) evaluate(objects, scene.arguments);
}, 50);
