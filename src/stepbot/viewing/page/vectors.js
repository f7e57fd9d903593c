// Vectors of three numbers, and poses: twelve numbers, the rotation by rows and then the position.

export const IDENTITY = [1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0];

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scaled = (a, factor) => [a[0] * factor, a[1] * factor, a[2] * factor];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const norm = (a) => Math.hypot(a[0], a[1], a[2]);
export const unit = (a) => scaled(a, 1 / (norm(a) || 1));
export const position = (X) => [X[9], X[10], X[11]];

// R v: a direction in B, in A.
export function turn(X, v) {
  return [
    X[0] * v[0] + X[1] * v[1] + X[2] * v[2],
    X[3] * v[0] + X[4] * v[1] + X[5] * v[2],
    X[6] * v[0] + X[7] * v[1] + X[8] * v[2],
  ];
}

// R' v: a direction in A, in B.
export function turnBack(X, v) {
  return [
    X[0] * v[0] + X[3] * v[1] + X[6] * v[2],
    X[1] * v[0] + X[4] * v[1] + X[7] * v[2],
    X[2] * v[0] + X[5] * v[1] + X[8] * v[2],
  ];
}

export const apply = (X, p) => add(turn(X, p), position(X));

export function times(A, B) {
  const X = new Array(12);
  for (let i = 0; i < 3; i++) {
    const [a, b, c] = [A[3 * i], A[3 * i + 1], A[3 * i + 2]];
    for (let j = 0; j < 3; j++) X[3 * i + j] = a * B[j] + b * B[3 + j] + c * B[6 + j];
    X[9 + i] = a * B[9] + b * B[10] + c * B[11] + A[9 + i];
  }
  return X;
}

export function inverse(X) {
  const p = turnBack(X, position(X));
  return [X[0], X[3], X[6], X[1], X[4], X[7], X[2], X[5], X[8], -p[0], -p[1], -p[2]];
}

// Rotation by an angle about a unit axis (Rodrigues), and translation along it.
// 1 - cos as 2 sin^2 of half the angle keeps its digits at small angles.
export function screw(axis, angle, distance) {
  const [x, y, z] = axis;
  const s = Math.sin(angle);
  const c = 2 * Math.sin(angle / 2) ** 2;
  return [
    1 - c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y,
    c * x * y + s * z, 1 - c * (x * x + z * z), c * y * z - s * x,
    c * x * z - s * y, c * y * z + s * x, 1 - c * (x * x + y * y),
    x * distance, y * distance, z * distance,
  ];
}

// Roll, pitch and yaw [rad] about fixed axes of the rotation whose columns are x, y and z.
export function anglesOf([x, y, z]) {
  const pitch = Math.asin(Math.max(-1, Math.min(1, -x[2])));
  if (Math.abs(x[2]) > 1 - 1e-9) return [0, pitch, Math.atan2(-y[0], y[1])];
  return [Math.atan2(y[2], z[2]), pitch, Math.atan2(x[1], x[0])];
}

// Two unit vectors that are perpendicular to a direction and to each other; with it they are right-handed.
// The same choice as in stepbot's geometry: the first is as close as possible to x, or y if the direction is near x.
export function across(direction) {
  const z = unit(direction);
  const towards = Math.abs(z[0]) > 0.9 ? [0, 1, 0] : [1, 0, 0];
  const x = unit(minus(towards, scaled(z, dot(towards, z))));
  return [x, cross(z, x)];
}
