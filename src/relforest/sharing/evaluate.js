"use strict";
// Evaluates a model in plain JavaScript; compare `relforest.sharing.program`. The measures of the model are
// functions, written by `relforest.sharing.page` with the operations of the library's kernels.

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

function answerTo(measure, value) {
  if (Number.isNaN(value)) return "error";
  const {comparison, limit} = measure;
  const isYes = comparison === "<=" ? value <= limit : comparison === ">=" ? value >= limit : value > limit;
  return isYes ? "yes" : "no";
}

// The logarithm of the density at a squared distance, relative to the peak.
function logDensity(measure, squared) {
  const {sharpness, circular} = measure;
  return circular ? sharpness * (Math.cos(Math.sqrt(squared)) - 1.0) : -0.5 * sharpness * squared;
}

// Objects are arrays of numbers, NaN = undefined; arguments are places among them, -1 = no object.
function evaluator(model, functions) {
  const none = model.columns.map(() => NaN);
  const nArguments = model.parameters.length;
  const rules = model.rules.map(rule => ({...rule, depths: byDepth(rule)}));

  // Which answers of a rule are known once so many free objects are bound.
  function byDepth(rule) {
    const depths = Array.from({length: rule.free + 1}, () => []);
    rule.asked.forEach((asked, place) => {
      const last = Math.max(...model.measures[asked.measure].variables);
      depths[Math.max(last - nArguments + 1, 0)].push(place);
    });
    return depths;
  }

  // Returns the places of the objects that decide and what was measured, or null if the rule does not hold.
  // In SMRF trees the sequence with the largest product of densities decides, the first of equal ones.
  function search(rule, objects, given) {
    const bound = [...given, ...new Array(rule.free).fill(-1)];
    const rows = bound.map(place => place < 0 ? none : objects[place]);
    const values = new Array(rule.asked.length).fill(NaN);
    let count = 0, best = null;

    function isTrue(depth) {
      return rule.depths[depth].every(place => {
        const asked = rule.asked[place], measure = model.measures[asked.measure];
        const [a, b, c] = measure.variables;
        values[place] = functions[asked.measure](rows[a], rows[b], rows[c]);
        return answerTo(measure, values[place]) === asked.answer;
      });
    }

    // Calls `then` with every object that is free, until it returns true.
    function anyFree(depth, then) {
      const at = nArguments + depth;
      let isFree = false;
      for (let place = 0; place < objects.length; place++) {
        let repeated = false;
        for (let earlier = 0; earlier < at; earlier++) repeated ||= bound[earlier] === place;
        if (repeated) continue;
        isFree = true;
        bound[at] = place;
        rows[at] = objects[place];
        if (then()) return true;
      }
      if (isFree || !rule.orNone) return false;
      bound[at] = -1;
      rows[at] = none;
      return then();
    }

    function visit(depth) {
      if (!isTrue(depth)) return false;
      if (depth < rule.free) return anyFree(depth, () => visit(depth + 1));
      count += 1;
      let total = 0.0;
      if (rule.orNone) {
        rule.asked.forEach((asked, place) => {
          if (asked.answer !== "error") total += logDensity(model.measures[asked.measure], values[place]);
        });
      }
      if (best === null || !rule.orNone || total > best.total) best = {bound: [...bound], values: [...values], total};
      return !rule.orNone && count >= rule.atLeast;
    }

    if (rule.every) {
      let some = false;
      const lonely = anyFree(0, () => {
        some = true;
        return !(isTrue(0) && isTrue(1) && anyFree(1, () => isTrue(2)));
      });
      return some && !lonely ? {bound: [...given, -1, -1], values, total: 0.0} : null;
    }
    visit(0);
    return count >= rule.atLeast ? best : null;
  }

  function walk(tree, objects, given) {
    const path = [];
    // A step is a leaf, or pairs of a rule and the step that follows if it holds, with a last step.
    let step = tree;
    while (typeof step !== "number") {
      step = step.find(option => {
        if (typeof option === "number") return true;
        const found = search(rules[option[0]], objects, given);
        path.push({rule: rules[option[0]], found});
        return found !== null;
      });
      if (typeof step !== "number") step = step[1];
    }
    return {leaf: step, path};
  }

  return function evaluate(objects, given) {
    const trees = model.trees.map(tree => walk(tree, objects, given));
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
    const most = Math.max(...scores);
    const parts = scores.map(score => logistic ? Math.exp(score - most) : Math.max(score, 0.0));
    const whole = parts.reduce((sum, part) => sum + part, 0.0);
    return parts.map(part => whole > 0.0 ? part / whole : 1.0 / parts.length);
  }
}
