// The least-squares step of least length, with small singular values left out: redundant equations are harmless.

// Eigenvalues and eigenvectors (columns) of a symmetric matrix, by Jacobi's rotations.
function eigen(A) {
  const n = A.length;
  const V = A.map((_, i) => A.map((_, j) => Number(i === j)));
  for (let sweep = 0; sweep < 30; sweep++) {
    let off = 0;
    let trace = 0;
    for (let i = 0; i < n; i++) {
      trace += Math.abs(A[i][i]);
      for (let j = 0; j < i; j++) off += Math.abs(A[i][j]);
    }
    if (off <= 1e-16 * trace) break;
    for (let p = 0; p < n; p++) {
      for (let q = p + 1; q < n; q++) if (A[p][q] !== 0) rotate(A, V, p, q);
    }
  }
  return { values: A.map((row, i) => row[i]), vectors: V };
}

function rotate(A, V, p, q) {
  const theta = (A[q][q] - A[p][p]) / (2 * A[p][q]);
  const t = (theta < 0 ? -1 : 1) / (Math.abs(theta) + Math.hypot(1, theta));
  const c = 1 / Math.hypot(1, t);
  const s = t * c;
  for (const row of A) [row[p], row[q]] = [c * row[p] - s * row[q], s * row[p] + c * row[q]];
  const [P, Q] = [A[p], A[q]];
  for (let k = 0; k < A.length; k++) [P[k], Q[k]] = [c * P[k] - s * Q[k], s * P[k] + c * Q[k]];
  for (const row of V) [row[p], row[q]] = [c * row[p] - s * row[q], s * row[p] + c * row[q]];
}

// x of least length that minimises |J x - r|, without singular values below a share of the largest.
// J: rows of numbers. Works on the smaller of J J' and J' J.
export function leastSquares(J, r, share) {
  const [rows, columns] = [J.length, J[0].length];
  const tall = rows > columns;
  const n = tall ? columns : rows;
  const gram = Array.from({ length: n }, () => new Array(n).fill(0));
  for (let i = 0; i < n; i++) {
    for (let j = 0; j <= i; j++) {
      let sum = 0;
      if (tall) for (let k = 0; k < rows; k++) sum += J[k][i] * J[k][j];
      else for (let k = 0; k < columns; k++) sum += J[i][k] * J[j][k];
      gram[i][j] = gram[j][i] = sum;
    }
  }
  const right = tall ? timesTransposed(J, r) : r;
  const { values, vectors } = eigen(gram);
  const smallest = share * share * Math.max(...values);
  const y = new Array(n).fill(0);
  for (let e = 0; e < n; e++) {
    if (!(values[e] > smallest)) continue;
    let part = 0;
    for (let i = 0; i < n; i++) part += vectors[i][e] * right[i];
    for (let i = 0; i < n; i++) y[i] += (vectors[i][e] * part) / values[e];
  }
  return tall ? y : timesTransposed(J, y);
}

function timesTransposed(J, y) {
  return J[0].map((_, column) => J.reduce((sum, row, i) => sum + row[column] * y[i], 0));
}
