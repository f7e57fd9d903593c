// The triangle under the pointer: a ray against boxes, then triangles.

import { add, apply, dot, inverse, minus, norm, scaled, turn } from "./vectors.js";

// The nearest hit of a ray in the world; null for none.
// items: { geometry: { vertices, faces, low, high }, X }.
export function pick(ray, items) {
  let best = null;
  const met = items.flatMap((item) => {
    const X_GW = inverse(item.X);
    const [origin, direction] = [apply(X_GW, ray.origin), turn(X_GW, ray.direction)];
    const enter = meetsBox(origin, direction, item.geometry);
    return enter === null ? [] : [{ item, origin, direction, enter }];
  });
  for (const { item, origin, direction, enter } of met.sort((a, b) => a.enter - b.enter)) {
    if (best && enter > best.distance) break;
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

// How far along a ray a box begins; null if the ray misses it.
function meetsBox(origin, direction, { low, high }) {
  let [enter, leave] = [0, Infinity];
  for (let i = 0; i < 3; i++) {
    const a = (low[i] - origin[i]) / direction[i];
    const b = (high[i] - origin[i]) / direction[i];
    if (Number.isNaN(a) || Number.isNaN(b)) continue;
    enter = Math.max(enter, Math.min(a, b));
    leave = Math.min(leave, Math.max(a, b));
  }
  return enter <= leave * (1 + 1e-9) + 1e-12 ? enter : null;
}

// The nearest triangle that a ray meets (Möller and Trumbore).
function nearest(origin, direction, { vertices, faces }, limit) {
  let found = -1;
  // In numbers, not vectors: of millions of triangles no array each.
  const [ox, oy, oz] = origin;
  const [dx, dy, dz] = direction;
  for (let i = 0; i < faces.length; i += 3) {
    const [a, b, c] = [3 * faces[i], 3 * faces[i + 1], 3 * faces[i + 2]];
    const [ax, ay, az] = [vertices[a], vertices[a + 1], vertices[a + 2]];
    const [ux, uy, uz] = [vertices[b] - ax, vertices[b + 1] - ay, vertices[b + 2] - az];
    const [vx, vy, vz] = [vertices[c] - ax, vertices[c + 1] - ay, vertices[c + 2] - az];
    const [hx, hy, hz] = [dy * vz - dz * vy, dz * vx - dx * vz, dx * vy - dy * vx];
    const det = ux * hx + uy * hy + uz * hz;
    if (det === 0) continue;
    const [sx, sy, sz] = [ox - ax, oy - ay, oz - az];
    const x = (sx * hx + sy * hy + sz * hz) / det;
    if (x < 0 || x > 1) continue;
    const [qx, qy, qz] = [sy * uz - sz * uy, sz * ux - sx * uz, sx * uy - sy * ux];
    const y = (dx * qx + dy * qy + dz * qz) / det;
    if (y < 0 || x + y > 1) continue;
    const distance = (vx * qx + vy * qy + vz * qz) / det;
    if (distance > 0 && distance < limit) [limit, found] = [distance, i];
  }
  if (found < 0) return null;
  const at = (vertex) => [vertices[3 * vertex], vertices[3 * vertex + 1], vertices[3 * vertex + 2]];
  return { distance: limit, triangle: [at(faces[found]), at(faces[found + 1]), at(faces[found + 2])] };
}

const BENT = [Math.cos((0.5 * Math.PI) / 180), Math.cos((35 * Math.PI) / 180)]; // between the pieces of a curve

// The sharp edge of a geometry that is nearest to a point and at most `reach` from it: its ends, the triangles that meet
// there, and whether it is a piece of a curve; null for none.
export function edgeAt({ vertices, faces, sharp }, point, reach) {
  let found = null;
  const at = (vertex) => [vertices[3 * vertex], vertices[3 * vertex + 1], vertices[3 * vertex + 2]];
  for (let i = 0; i < sharp.length; i += 2) {
    const ends = [at(sharp[i]), at(sharp[i + 1])];
    const along = minus(ends[1], ends[0]);
    const share = Math.min(1, Math.max(0, dot(minus(point, ends[0]), along) / (dot(along, along) || 1)));
    const distance = norm(minus(add(ends[0], scaled(along, share)), point));
    if (distance > reach) continue;
    reach = distance;
    found = { ends, corners: [sharp[i], sharp[i + 1]] };
  }
  if (!found) return null;
  const triangles = [];
  for (let i = 0; i < faces.length; i += 3) {
    const three = [faces[i], faces[i + 1], faces[i + 2]];
    if (found.corners.every((corner) => three.includes(corner))) triangles.push(three.map(at));
  }
  const isCurved = found.corners.some((corner, end) => {
    const along = minus(found.ends[1 - end], found.ends[end]);
    for (let i = 0; i < sharp.length; i++) {
      const other = sharp[i % 2 ? i - 1 : i + 1];
      if (sharp[i] !== corner || other === found.corners[1 - end]) continue;
      const next = minus(found.ends[end], at(other));
      const cosine = dot(along, next) / (norm(along) * norm(next));
      if (cosine < BENT[0] && cosine > BENT[1] && norm(next) > norm(along) / 3) return true;
    }
    return false;
  });
  return { ends: found.ends, triangles, isCurved };
}
