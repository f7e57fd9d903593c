// Numbers for people: degrees, millimetres, grams.

export function short(value, digits = 4) {
  if (!Number.isFinite(value)) return "–";
  return String(Number(value.toPrecision(digits)));
}

export const degrees = (angle) => (angle * 180) / Math.PI;
export const mass = (kg) => (kg >= 1 ? `${short(kg)} kg` : `${short(kg * 1e3)} g`);
export const millimetres = (length) => `${short(length * 1e3)} mm`;
export const vector = (v) => `[${v.map((x) => short(x * 1e3)).join(", ")}] mm`;

// A position to a thousandth of a degree or millimetre.
export const fine = (value) => short(Math.round(value * 1e3) / 1e3 + 0, 6);

// A joint's position as shown: degrees or millimetres.
export const shown = (joint, q) => (joint.turn ? degrees(q) : q * 1e3);
export const unitOf = (joint) => (joint.turn ? "°" : "mm");
export const internal = (joint, value) => (joint.turn ? (value * Math.PI) / 180 : value / 1e3);
