// Triangles of shapes: decoded meshes, primitives, normals that keep sharp edges sharp, and those edges as lines.

const SMOOTH = Math.cos((32 * Math.PI) / 180);
const ROUND = 40;

function bytes(text) {
  const raw = atob(text);
  const data = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) data[i] = raw.charCodeAt(i);
  return data.buffer;
}

// Vertices [m] and indices of a packed mesh.
export function unpacked(mesh) {
  const steps = new Uint16Array(bytes(mesh.vertices));
  const vertices = new Float32Array(steps.length);
  for (let i = 0; i < steps.length; i++) vertices[i] = mesh.low[i % 3] + (mesh.size[i % 3] * steps[i]) / 65535;
  const buffer = bytes(mesh.faces);
  return { vertices, faces: mesh.wide ? new Uint32Array(buffer) : new Uint16Array(buffer) };
}

// The same for a primitive.
export function meshOf(shape) {
  if (shape.shape === "box") return box(shape.size);
  if (shape.shape === "sphere") return revolved(arc(shape.radius, 0, -90, 90));
  if (shape.shape === "cylinder") {
    const half = shape.length / 2;
    return revolved([[0, -half], [shape.radius, -half], [shape.radius, half], [0, half]]);
  }
  const half = shape.length / 2;
  return revolved([...arc(shape.radius, -half, -90, 0), ...arc(shape.radius, half, 0, 90)]);
}

function arc(radius, height, from, to) {
  const steps = Math.max(2, Math.round((ROUND / 360) * (to - from)));
  return Array.from({ length: steps + 1 }, (_, i) => {
    const angle = ((from + ((to - from) * i) / steps) * Math.PI) / 180;
    return [Math.abs(angle) === Math.PI / 2 ? 0 : radius * Math.cos(angle), height + radius * Math.sin(angle)];
  });
}

function box(size) {
  const [x, y, z] = size.map((length) => length / 2);
  const vertices = [];
  for (let i = 0; i < 8; i++) vertices.push(i & 1 ? x : -x, i & 2 ? y : -y, i & 4 ? z : -z);
  const faces = [0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5];
  return { vertices: new Float32Array(vertices), faces: new Uint16Array(faces) };
}

// The solid that a profile of [radius, height] points sweeps around z.
function revolved(profile) {
  const vertices = [];
  const faces = [];
  const rings = profile.map(([radius, height]) => {
    const count = radius ? ROUND : 1;
    const first = vertices.length / 3;
    for (let i = 0; i < count; i++) {
      const angle = (2 * Math.PI * i) / ROUND;
      vertices.push(radius * Math.cos(angle), radius * Math.sin(angle), height);
    }
    return (i) => first + (count === 1 ? 0 : i % ROUND);
  });
  for (let ring = 0; ring + 1 < rings.length; ring++) {
    const [below, above] = [rings[ring], rings[ring + 1]];
    for (let i = 0; i < ROUND; i++) {
      if (below(i) !== below(i + 1)) faces.push(below(i), below(i + 1), above(i + 1));
      if (above(i) !== above(i + 1)) faces.push(below(i), above(i + 1), above(i));
    }
  }
  return { vertices: new Float32Array(vertices), faces: new Uint16Array(faces) };
}

// What the graphics card draws: positions and normals of every corner, and sharp edges as pairs of points; `sharp`: those edges
// as pairs of vertices.
export function drawable({ vertices, faces }) {
  const count = faces.length / 3;
  const { normals, weights } = faceNormals(vertices, faces);
  const around = neighbours(faces, vertices.length / 3);
  const positions = new Float32Array(9 * count);
  const smooth = new Float32Array(9 * count);
  for (let corner = 0; corner < faces.length; corner++) {
    const [vertex, face] = [faces[corner], Math.floor(corner / 3)];
    let [x, y, z] = [0, 0, 0];
    for (let k = around.start[vertex]; k < around.start[vertex + 1]; k++) {
      const other = around.faces[k];
      if (cosine(normals, face, other) < SMOOTH) continue;
      x += normals[3 * other] * weights[other];
      y += normals[3 * other + 1] * weights[other];
      z += normals[3 * other + 2] * weights[other];
    }
    const length = Math.hypot(x, y, z) || 1;
    for (let i = 0; i < 3; i++) positions[3 * corner + i] = vertices[3 * vertex + i];
    smooth[3 * corner] = x / length;
    smooth[3 * corner + 1] = y / length;
    smooth[3 * corner + 2] = z / length;
  }
  const sharp = sharpEdges(faces, normals, around);
  const edges = new Float32Array(3 * sharp.length);
  sharp.forEach((vertex, i) => edges.set(vertices.subarray(3 * vertex, 3 * vertex + 3), 3 * i));
  return { positions, normals: smooth, edges, sharp };
}

// A mesh with fewer triangles: the vertices within each cell of a grid become one, in their middle. `count`: cells along the
// longest side.
export function clustered({ vertices, faces, low, high }, count) {
  const size = Math.max(...high.map((end, i) => end - low[i])) / count || 1;
  const cells = new Map();
  const merged = []; // of each cell: the sum of its vertices, and how many
  const cellOf = new Uint32Array(vertices.length / 3);
  for (let vertex = 0; vertex < cellOf.length; vertex++) {
    const key = [0, 1, 2].reduce((sum, i) => sum * (count + 1) + Math.floor((vertices[3 * vertex + i] - low[i]) / size), 0);
    if (!cells.has(key)) cells.set(key, merged.push([0, 0, 0, 0]) - 1);
    const cell = (cellOf[vertex] = cells.get(key));
    for (let i = 0; i < 3; i++) merged[cell][i] += vertices[3 * vertex + i];
    merged[cell][3]++;
  }
  const kept = [];
  const known = new Set();
  for (let i = 0; i < faces.length; i += 3) {
    const [a, b, c] = [cellOf[faces[i]], cellOf[faces[i + 1]], cellOf[faces[i + 2]]];
    if (a === b || b === c || c === a) continue;
    const key = [a, b, c].sort((x, y) => x - y).join();
    if (known.has(key)) continue; // of two faces of a thin wall either is enough
    known.add(key);
    kept.push(a, b, c);
  }
  return { vertices: new Float32Array(merged.flatMap(([x, y, z, n]) => [x / n, y / n, z / n])), faces: new Uint32Array(kept) };
}

function cosine(normals, a, b) {
  const [i, j] = [3 * a, 3 * b];
  return normals[i] * normals[j] + normals[i + 1] * normals[j + 1] + normals[i + 2] * normals[j + 2];
}

// Unit normals, and areas as weights.
function faceNormals(vertices, faces) {
  const normals = new Float32Array(faces.length);
  const weights = new Float32Array(faces.length / 3);
  for (let face = 0; face < weights.length; face++) {
    const [a, b, c] = [3 * faces[3 * face], 3 * faces[3 * face + 1], 3 * faces[3 * face + 2]];
    const [ux, uy, uz] = [vertices[b] - vertices[a], vertices[b + 1] - vertices[a + 1], vertices[b + 2] - vertices[a + 2]];
    const [vx, vy, vz] = [vertices[c] - vertices[a], vertices[c + 1] - vertices[a + 1], vertices[c + 2] - vertices[a + 2]];
    const n = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    const length = Math.hypot(...n);
    weights[face] = length;
    for (let i = 0; i < 3; i++) normals[3 * face + i] = n[i] / (length || 1);
  }
  return { normals, weights };
}

// For each vertex the faces around it, as one list with the start of each vertex.
function neighbours(faces, count) {
  const start = new Uint32Array(count + 1);
  for (const vertex of faces) start[vertex + 1]++;
  for (let i = 0; i < count; i++) start[i + 1] += start[i];
  const next = start.slice();
  const list = new Uint32Array(faces.length);
  for (let corner = 0; corner < faces.length; corner++) list[next[faces[corner]]++] = Math.floor(corner / 3);
  return { start, faces: list };
}

// Pairs of vertices of the edges whose two faces meet at an angle.
function sharpEdges(faces, normals, around) {
  const ends = [];
  for (let corner = 0; corner < faces.length; corner++) {
    const face = Math.floor(corner / 3);
    const [a, b] = [faces[corner], faces[3 * face + ((corner + 1) % 3)]];
    for (let k = around.start[a]; k < around.start[a + 1] && around.faces[k] < face; k++) {
      const other = 3 * around.faces[k]; // the first face with both vertices
      if (faces[other] !== b && faces[other + 1] !== b && faces[other + 2] !== b) continue;
      if (cosine(normals, face, around.faces[k]) < SMOOTH) ends.push(a, b);
      break;
    }
  }
  return new Uint32Array(ends);
}
