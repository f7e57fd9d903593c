// The triangle under the pointer: a ray against boxes, then triangles.

import { add, apply, cross, dot, inverse, minus, scaled, turn } from "./vectors.js";

// The nearest hit of a ray in the world; null for none.
// items: { geometry: { vertices, faces, low, high }, X }.
export function pick(ray, items) {
  let best = null;
  for (const item of items) {
    const X_GW = inverse(item.X);
    const origin = apply(X_GW, ray.origin);
    const direction = turn(X_GW, ray.direction);
    if (!meetsBox(origin, direction, item.geometry)) continue;
    const hit = nearest(origin, direction, item.geometry, best ? best.distance : Infinity);
    if (hit) best = { item, ...hit, point: add(ray.origin, scaled(ray.direction, hit.distance)) };
  }
  return best;
}

export function boxOf(vertices) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < vertices.length; i++) {
    low[i % 3] = Math.min(low[i % 3], vertices[i]);
    high[i % 3] = Math.max(high[i % 3], vertices[i]);
  }
  return { low, high };
}

function meetsBox(origin, direction, { low, high }) {
  let [enter, leave] = [0, Infinity];
  for (let i = 0; i < 3; i++) {
    const a = (low[i] - origin[i]) / direction[i];
    const b = (high[i] - origin[i]) / direction[i];
    if (Number.isNaN(a) || Number.isNaN(b)) continue;
    enter = Math.max(enter, Math.min(a, b));
    leave = Math.min(leave, Math.max(a, b));
  }
  return enter <= leave * (1 + 1e-9) + 1e-12;
}

// The nearest triangle that a ray meets (Möller and Trumbore).
function nearest(origin, direction, { vertices, faces }, limit) {
  let found = null;
  const at = (vertex) => [vertices[3 * vertex], vertices[3 * vertex + 1], vertices[3 * vertex + 2]];
  for (let i = 0; i < faces.length; i += 3) {
    const a = at(faces[i]);
    const u = minus(at(faces[i + 1]), a);
    const v = minus(at(faces[i + 2]), a);
    const h = cross(direction, v);
    const det = dot(u, h);
    if (det === 0) continue;
    const s = minus(origin, a);
    const x = dot(s, h) / det;
    if (x < 0 || x > 1) continue;
    const q = cross(s, u);
    const y = dot(direction, q) / det;
    if (y < 0 || x + y > 1) continue;
    const distance = dot(v, q) / det;
    if (distance > 0 && distance < limit) {
      limit = distance;
      found = { distance, triangle: [a, at(faces[i + 1]), at(faces[i + 2])] };
    }
  }
  return found;
}
