// Lines that explain a robot: frames, joint axes, arcs of limits, centres of mass, ground.

import { add, across, apply, cross, minus, norm, position, scaled, turn } from "./vectors.js";

export const AXIS_COLORS = [[0.86, 0.24, 0.22, 1], [0.22, 0.62, 0.26, 1], [0.20, 0.42, 0.88, 1]];

export function frame(X, size, fade = 1) {
  const origin = position(X);
  return AXIS_COLORS.map((color, i) => {
    const axis = [X[i], X[3 + i], X[6 + i]];
    return [origin, add(origin, scaled(axis, size)), [...color.slice(0, 3), fade]];
  });
}

// A joint: its axis with an arrow head, and the range of its position as an arc or a bar. X_WL is the frame of its
// child link, q its position.
export function joint(X, one, q, size, color) {
  const origin = position(X);
  const axis = turn(X, one.axis);
  const tip = add(origin, scaled(axis, size));
  const [side, other] = across(axis);
  const heads = [side, other].flatMap((d) => [d, scaled(d, -1)]);
  const lines = [[add(origin, scaled(axis, -0.6 * size)), tip, color]];
  for (const d of heads) lines.push([tip, add(tip, add(scaled(axis, -0.18 * size), scaled(d, 0.07 * size))), color]);
  return [...lines, ...(one.turn ? arc(X, one, q, ARC * size, color) : bar(X, one, q, 0.12 * size, color))];
}

const ARC = 0.7; // radius of the arc of a joint, of the size of its glyph

// Where a glyph has the position that is `by` more than the one of its link.
export function onGlyph(X, one, by, size) {
  if (!one.turn) return add(position(X), scaled(turn(X, one.axis), by));
  const [u, v] = across(one.axis).map((axis) => scaled(turn(X, axis), 1.12 * ARC * size));
  return add(position(X), add(scaled(u, Math.cos(by)), scaled(v, Math.sin(by))));
}

function arc(X, one, q, radius, color) {
  const origin = position(X);
  const axis = turn(X, one.axis);
  const u = turn(X, across(one.axis)[0]);
  const v = cross(axis, u);
  // u turns with the link: the limits are at lower - q and upper - q from it.
  const limited = one.lower !== null && one.upper !== null && one.upper - one.lower < 2 * Math.PI;
  const [from, to] = limited ? [one.lower - q, one.upper - q] : [0, 2 * Math.PI];
  const at = (angle) => add(origin, add(scaled(u, radius * Math.cos(angle)), scaled(v, radius * Math.sin(angle))));
  const faint = [...color.slice(0, 3), 0.8 * color[3]];
  const steps = Math.max(6, Math.ceil((to - from) / 0.12));
  const lines = [];
  for (let i = 0; i < steps; i++) {
    lines.push([at(from + ((to - from) * i) / steps), at(from + ((to - from) * (i + 1)) / steps), faint]);
  }
  if (limited) for (const angle of [from, to]) lines.push([origin, at(angle), faint]);
  lines.push([add(origin, scaled(minus(at(0), origin), 0.75)), add(origin, scaled(minus(at(0), origin), 1.1)), color]);
  return lines;
}

function bar(X, one, q, size, color) {
  if (one.lower === null || one.upper === null) return [];
  const axis = turn(X, one.axis);
  const sides = across(axis);
  const at = (value) => add(position(X), scaled(axis, value - q));
  const lines = [[at(one.lower), at(one.upper), color]];
  for (const value of [one.lower, one.upper, q]) {
    for (const side of sides) {
      lines.push([add(at(value), scaled(side, -size)), add(at(value), scaled(side, size)), color]);
    }
  }
  return lines;
}

// The three outlines of a solid ellipsoid in a link's frame, and a cross at its centre.
export function ellipsoid(X, mass, color) {
  const center = apply(X, mass.com);
  const { R, radii } = mass.ellipsoid;
  const axes = [0, 1, 2].map((i) => scaled(turn(X, [R[i], R[3 + i], R[6 + i]]), radii[i]));
  const lines = axes.map((axis) => [add(center, scaled(axis, -0.25)), add(center, scaled(axis, 0.25)), color]);
  for (const [a, b] of [[0, 1], [1, 2], [2, 0]]) {
    const at = (angle) => add(center, add(scaled(axes[a], Math.cos(angle)), scaled(axes[b], Math.sin(angle))));
    for (let i = 0; i < 40; i++) lines.push([at((Math.PI * i) / 20), at((Math.PI * (i + 1)) / 20), color]);
  }
  return lines;
}

// A mark that is seen from everywhere: a ring around a point, facing the viewer.
export function ring(center, radius, camera, color) {
  const { right, up } = camera.axes();
  const at = (angle) => add(center, add(scaled(right, radius * Math.cos(angle)), scaled(up, radius * Math.sin(angle))));
  return Array.from({ length: 28 }, (_, i) => [at((Math.PI * i) / 14), at((Math.PI * (i + 1)) / 14), color]);
}

// A grid on a horizontal plane around a point; lines fade with the distance.
export function ground(center, radius, height, color) {
  const step = 10 ** Math.floor(Math.log10(radius)) * (radius / 10 ** Math.floor(Math.log10(radius)) > 4 ? 1 : 0.5);
  const count = Math.ceil((2.2 * radius) / step);
  const start = [Math.round(center[0] / step) * step, Math.round(center[1] / step) * step];
  const lines = [];
  for (let i = -count; i <= count; i++) {
    for (let j = -count; j < count; j++) {
      for (const flip of [false, true]) {
        const [a, b] = [[i * step, j * step], [i * step, (j + 1) * step]].map((p) => (flip ? [p[1], p[0]] : p));
        const far = norm([(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, 0]) / (2.2 * radius);
        if (far >= 1) continue;
        const fade = color[3] * (1 - far) * ((i === 0 ? 1.8 : 1));
        const at = (p) => [start[0] + p[0], start[1] + p[1], height];
        lines.push([at(a), at(b), [...color.slice(0, 3), fade]]);
      }
    }
  }
  return lines;
}
