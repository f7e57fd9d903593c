// Loop closures: residuals, their Jacobian, Newton's method, and motion of one driven joint along the mechanism's
// branch. The same method as stepbot.robot.closures.

import { leastSquares } from "./leastsquares.js";
import { across, add, cross, dot, inverse, minus, norm, position, scaled, times, turn, turnBack } from "./vectors.js";

const MOST_ITERATIONS = 50;
const SHORTEST = 1 / 64;

export class Loops {
  constructor(tree, motion, types) {
    this.tree = tree;
    this.solver = motion.solver;
    this.closures = motion.closures.map((closure) => ({
      ...closure,
      isHinge: types[closure.kind].hinge,
      a: tree.linkIndex.get(closure.a),
      b: tree.linkIndex.get(closure.b),
      across: across(closure.axis),
    }));
    const reach = Math.max(0, ...motion.closures.flatMap((one) => [one.X_AF, one.X_BF].map((X) => norm(position(X)))));
    this.perLength = 1 / (reach || 1);
    this.driven = new Set(motion.driven.map((one) => tree.row.get(one.name)));
    this.ranges = new Map(motion.driven.map((one) => [tree.row.get(one.name), one.range]));
    this.free = tree.independent.map((_, i) => i).filter((i) => !this.driven.has(i));
  }

  // Distance [m] and angle [rad] between the constrained frames of each closure.
  gaps(X) {
    return this.closures.map((closure) => {
      const X_FG = times(inverse(times(X[closure.a], closure.X_AF)), times(X[closure.b], closure.X_BF));
      const p = position(X_FG);
      const axis = closure.axis;
      if (closure.isHinge) {
        const turned = turn(X_FG, axis);
        return { distance: norm(p), angle: Math.atan2(norm(cross(axis, turned)), dot(axis, turned)) };
      }
      const slides = closure.kind === "prismatic";
      return {
        distance: norm(slides ? minus(p, scaled(axis, dot(axis, p))) : p),
        angle: closure.kind === "ball" ? 0 : Math.atan2(2 * norm(twistOf(X_FG)), X_FG[0] + X_FG[4] + X_FG[8] - 1),
      };
    });
  }

  // Whether all closures are closed.
  isClosed(u) {
    const gaps = this.gaps(this.tree.frames(this.tree.follow(u)));
    return gaps.every((g) => g.distance <= this.solver.closed_distance && g.angle <= this.solver.closed_angle);
  }

  // Residual and Jacobian over the free joints; lengths in units of the mechanism's reach.
  constraints(u) {
    const { tree, perLength } = this;
    const X = tree.frames(tree.follow(u));
    const lines = tree.lines(X);
    const place = new Map(this.free.map((index, i) => [index, i]));
    const residual = [];
    const J = [];
    for (const closure of this.closures) {
      const X_WF = times(X[closure.a], closure.X_AF);
      const X_WG = times(X[closure.b], closure.X_BF);
      const X_FG = times(inverse(X_WF), X_WG);
      for (let i = 9; i < 12; i++) X_FG[i] *= perLength;
      const start = residual.length;
      residual.push(...residualOf(closure, X_FG));
      for (let i = start; i < residual.length; i++) J.push(new Array(this.free.length).fill(0));
      const columns = new Set([...tree.above[closure.a], ...tree.above[closure.b]]);
      for (const column of columns) {
        const index = place.get(tree.leader[column]);
        if (index === undefined) continue;
        const none = [[0, 0, 0], [0, 0, 0]];
        const moves = (link, point) => (tree.above[link].includes(column) ? tree.twist(lines, column, point) : none);
        const [wF, vF] = moves(closure.a, position(X_WF)).map((v) => turnBack(X_WF, v));
        const [wG, vG] = moves(closure.b, position(X_WG)).map((v) => turnBack(X_WF, v));
        // F turns under the lever arm from F to G.
        const v = add(scaled(minus(vG, vF), perLength), cross(position(X_FG), wF));
        const rates = ratesOf(closure, X_FG, minus(wG, wF), v);
        const multiplier = tree.joints[column].multiplier;
        rates.forEach((rate, i) => (J[start + i][index] += multiplier * rate));
      }
    }
    return { residual, J };
  }

  // The closed configuration nearest to a guess, driven joints unchanged; null if there is none.
  closed(guess) {
    let u = [...guess];
    if (!this.closures.length) return u;
    let { residual, J } = this.constraints(u);
    for (let round = 0; this.free.length && round < MOST_ITERATIONS; round++) {
      const step = leastSquares(J, residual, this.solver.rank);
      const length = Math.max(...step.map(Math.abs));
      if (length < 1e-14) break;
      const moved = this.stepped(u, step.map((value) => -value * Math.min(1, 0.5 / length)), residual);
      if (!moved) break;
      ({ u, residual, J } = moved);
    }
    return this.isClosed(u) ? u : null;
  }

  // After the longest halving of a step that reduces the residual; null if none does.
  stepped(u, step, residual) {
    for (let halving = 0; halving < 8; halving++) {
      const moved = [...u];
      this.free.forEach((index, i) => (moved[index] += step[i] * 0.5 ** halving));
      const next = this.constraints(moved);
      if (Math.hypot(...next.residual) < Math.hypot(...residual)) return { u: moved, ...next };
    }
    return null;
  }

  // Move driven joints from a closed configuration towards targets ([index, value] pairs), as far as the loops allow.
  // Returns the configuration, and why it ends before the targets: "" if it does not.
  move(start, targets) {
    const goal = [...start];
    for (const [index, value] of targets) goal[index] = value;
    if (!this.closures.length) return { u: goal, why: "" };
    const strides = Math.max(...targets.map(([index, value]) => Math.abs(value - start[index]) / this.stride(index)));
    if (!(strides > 0)) return { u: [...start], why: "" };
    const longest = Math.min(1, 1 / strides);
    let [u, gone, step, why] = [[...start], 0, longest, ""];
    while (gone < 1 && step > longest * SHORTEST) {
      const share = Math.min(1, gone + step);
      const guess = [...u];
      for (const [index] of targets) guess[index] = start[index] + share * (goal[index] - start[index]);
      const next = this.closed(guess);
      why = next ? this.objection(u, next) : "the loops do not close further";
      if (why) {
        step *= 0.5;
        continue;
      }
      [u, gone] = [next, share];
    }
    return { u, why };
  }

  // Why a closed configuration must not follow another one: a limit, or a jump to another branch.
  objection(former, next) {
    for (const index of this.free) {
      if (Math.abs(next[index] - former[index]) > this.solver.jump) return "the loops would jump to another branch";
    }
    const q = this.tree.follow(next);
    const before = this.tree.follow(former);
    for (const [i, joint] of this.tree.joints.entries()) {
      const below = joint.lower !== null && q[i] < joint.lower - 1e-9 && q[i] < before[i];
      const above = joint.upper !== null && q[i] > joint.upper + 1e-9 && q[i] > before[i];
      if (below || above) return `${joint.name} is at its limit`;
    }
    return "";
  }

  stride(index) {
    if (this.tree.independent[index].turn) return this.solver.step;
    const [low, high] = this.ranges.get(index);
    return this.solver.step * Math.max(high - low, 1e-9);
  }
}

function twistOf(X) {
  return scaled([X[7] - X[5], X[2] - X[6], X[3] - X[1]], 0.5);
}

function residualOf(closure, X_FG) {
  const p = position(X_FG);
  const [x, y] = closure.across;
  if (closure.kind === "ball") return p;
  if (closure.isHinge) {
    const turned = turn(X_FG, closure.axis);
    return [...p, dot(x, turned), dot(y, turned)];
  }
  if (closure.kind === "prismatic") return [dot(x, p), dot(y, p), ...twistOf(X_FG)];
  return [...p, ...twistOf(X_FG)];
}

function ratesOf(closure, X_FG, w, v) {
  const [x, y] = closure.across;
  if (closure.kind === "ball") return v;
  if (closure.isHinge) {
    const swept = cross(w, turn(X_FG, closure.axis));
    return [...v, dot(x, swept), dot(y, swept)];
  }
  if (closure.kind === "prismatic") return [dot(x, v), dot(y, v), ...w];
  return [...v, ...w];
}
