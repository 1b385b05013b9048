"use strict";
// Evaluates a model in plain JavaScript; compare `relforest.sharing.program`. The measures of the model are
// functions, written by `relforest.sharing.page` with the operations of the library's kernels.

const [YES, NO, ERROR, UNKNOWN] = [0, 1, 2, 255];
// Answers about tuples of objects are kept while there are no more tuples than this.
const MOST_KEPT = 4e6;

function rint(x) {
  const nearest = Math.round(x);
  return Math.abs(x % 1) === 0.5 && nearest % 2 !== 0 ? nearest - 1 : nearest;
}

function wrapped(angle) {
  return angle - 2.0 * Math.PI * rint(angle / (2.0 * Math.PI));
}

function differs(x, y) {
  return x === y ? 0.0 : x < y || x > y ? 1.0 : NaN;
}

// Returns whether a measure is as asked, and the logarithm of the density relative to the peak.
function judged({comparison, limit, sharpness, circular}, value) {
  if (Number.isNaN(value)) return [ERROR, -Infinity];
  const isYes = comparison === "<=" ? value <= limit : comparison === ">=" ? value >= limit : value > limit;
  const log = circular ? sharpness * (Math.cos(Math.sqrt(value)) - 1.0) : -0.5 * sharpness * value;
  return [isYes ? YES : NO, log];
}

// Objects are arrays of numbers, NaN = undefined; arguments are places among them, -1 = no object.
function evaluator(model, functions) {
  const none = model.columns.map(() => NaN);
  const nArguments = model.parameters.length;
  const rules = model.rules.map(rule => ({...rule, depths: byDepth(rule)}));
  let objects = [], kept = null, density = 0.0;

  // Which answers of a rule are known once so many free objects are bound.
  function byDepth(rule) {
    const depths = Array.from({length: rule.free + 1}, () => []);
    for (const asked of rule.asked) {
      const last = Math.max(...model.measures[asked.measure].variables);
      depths[Math.max(last - nArguments + 1, 0)].push(asked);
    }
    return depths;
  }

  function begin(given) {
    objects = given;
    const sizes = model.measures.map(({variables}) => (objects.length + 1) ** variables.length);
    if (kept?.length === objects.length) kept.answers.forEach(answers => answers.fill(UNKNOWN));
    else if (sizes.reduce((sum, size) => sum + size, 0) > MOST_KEPT) kept = null;
    else {
      const answers = sizes.map(size => new Uint8Array(size).fill(UNKNOWN));
      kept = {length: objects.length, answers, densities: sizes.map(size => new Float64Array(size))};
    }
  }

  // Returns the answer about bound objects, and leaves its density in `density`.
  function answer(number, bound) {
    const {variables} = model.measures[number], side = objects.length + 1;
    let at = bound[variables[0]] + 1;
    if (variables.length > 1) at = at * side + bound[variables[1]] + 1;
    if (variables.length > 2) at = at * side + bound[variables[2]] + 1;
    if (kept !== null) {
      const known = kept.answers[number][at];
      if (known !== UNKNOWN) {
        density = kept.densities[number][at];
        return known;
      }
    }
    const [a, b, c] = variables.map(variable => objects[bound[variable]] ?? none);
    const [found, log] = judged(model.measures[number], functions[number](a, b, c));
    if (kept !== null) {
      kept.answers[number][at] = found;
      kept.densities[number][at] = log;
    }
    density = log;
    return found;
  }

  function isBound(bound, before, place) {
    for (let earlier = 0; earlier < before; earlier++) if (bound[earlier] === place) return true;
    return false;
  }

  // Binds the variable `at` to every object that is not bound before, until `then` returns true; returns how
  // many there were, or -1 if it did.
  function eachFree(bound, at, then) {
    let count = 0;
    for (let place = 0; place < objects.length; place++) {
      if (isBound(bound, at, place)) continue;
      count += 1;
      bound[at] = place;
      if (then()) return -1;
    }
    return count;
  }

  // Returns the leaf of a SMRF tree that decides: the most probable one that any sequence of objects reaches,
  // and of its sequences the first with the largest product of densities.
  function decide({nodes, asked}, given) {
    const bound = [...given], densities = [];
    let best = {rank: Infinity, total: -Infinity};

    function visit(at, depth, met, total) {
      let node = nodes[at];
      while (node.measure >= 0) {
        const found = answer(node.measure, bound);
        densities[met] = density;
        met += 1;
        if (found !== ERROR) total += density;
        node = nodes[node.children[found]];
      }
      // Further densities only lower the sum.
      if (node.rank > best.rank || (node.rank === best.rank && total <= best.total)) return;
      if (node.leaf >= 0) {
        best = {rank: node.rank, total, leaf: node.leaf, bound: bound.slice(0, depth), densities: densities.slice(0, met)};
        return;
      }
      const child = node.children[0];
      let isFree = depth < nArguments;
      if (isFree) {
        bound[depth] = given[depth];
        visit(child, depth + 1, met, total);
      }
      for (let place = 0; depth >= nArguments && place < objects.length; place++) {
        if (isBound(bound, depth, place)) continue;
        isFree = true;
        bound[depth] = place;
        visit(child, depth + 1, met, total);
      }
      if (isFree) return;
      bound[depth] = -1;
      visit(child, depth + 1, met, total);
    }

    visit(0, 0, 0, 0.0);
    return {leaf: best.leaf, path: [{rule: {asked: asked[best.leaf]}, found: best}]};
  }

  // Returns the objects that decide that a condition holds, or null.
  function search(rule, given) {
    const bound = [...given, -1, -1].slice(0, nArguments + rule.free);
    let count = 0;
    const isTrue = depth => rule.depths[depth].every(asked => answer(asked.measure, bound) === YES);

    function visit(depth) {
      if (!isTrue(depth)) return false;
      if (depth < rule.free) return eachFree(bound, nArguments + depth, () => visit(depth + 1)) < 0;
      count += 1;
      return count >= rule.atLeast;
    }

    if (rule.every) {
      const hasOther = () => isTrue(0) && isTrue(1) && eachFree(bound, nArguments + 1, () => isTrue(2)) < 0;
      return eachFree(bound, nArguments, () => !hasOther()) > 0 ? {bound: given} : null;
    }
    return visit(0) ? {bound} : null;
  }

  // A step is a leaf, or pairs of a rule and the step that follows if it holds, with a last step.
  function walk(tree, given) {
    const path = [];
    let step = tree;
    while (typeof step !== "number") {
      step = step.find(option => {
        if (typeof option === "number") return true;
        const found = search(rules[option[0]], given);
        path.push({rule: rules[option[0]], found});
        return found !== null;
      });
      if (typeof step !== "number") step = step[1];
    }
    return {leaf: step, path};
  }

  return function evaluate(given, places) {
    begin(given);
    const trees = model.trees.map(tree => tree.nodes ? decide(tree, places) : walk(tree, places));
    const scores = [...model.start];
    trees.forEach(({leaf}, number) => {
      model.values[number][leaf].forEach((value, output) => { scores[output] += value; });
    });
    return {trees, scores, shares: shares(scores)};
  };

  function shares(scores) {
    if (model.link === "number") return null;
    const logistic = model.link === "logistic";
    if (model.classes.length === 2) {
      const p = logistic ? 1.0 / (1.0 + Math.exp(-scores[0])) : Math.min(Math.max(scores[0], 0.0), 1.0);
      return [1.0 - p, p];
    }
    if (model.link === "shares") return scores;
    const most = Math.max(...scores);
    const parts = scores.map(score => logistic ? Math.exp(score - most) : Math.max(score, 0.0));
    const whole = parts.reduce((sum, part) => sum + part, 0.0);
    return parts.map(part => whole > 0.0 ? part / whole : 1.0 / parts.length);
  }
}
