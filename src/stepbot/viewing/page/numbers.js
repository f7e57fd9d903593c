// Numbers for people: degrees, millimetres, grams.

export function short(value, digits = 4) {
  if (!Number.isFinite(value)) return "–";
  return String(Number(value.toPrecision(digits)));
}

export const degrees = (angle) => (angle * 180) / Math.PI;
export const mass = (kg) => (kg >= 1 ? `${short(kg)} kg` : `${short(kg * 1e3)} g`);
export const millimetres = (length) => `${short(Math.abs(length) < 5e-10 ? 0 : length * 1e3)} mm`; // to a nanometre
export const vector = (v) => `[${v.map((x) => short(x * 1e3)).join(", ")}] mm`;

// A position to a thousandth of a degree or millimetre.
export const fine = (value) => short(Math.round(value * 1e3) / 1e3 + 0, 6);

// A joint's position as shown: degrees or millimetres.
export const shown = (joint, q) => (joint.turn ? degrees(q) : q * 1e3);
export const unitOf = (joint) => (joint.turn ? "°" : "mm");
export const internal = (joint, value) => (joint.turn ? (value * Math.PI) / 180 : value / 1e3);

const UNITS = {
  "°": [true, Math.PI / 180], deg: [true, Math.PI / 180], degree: [true, Math.PI / 180], degrees: [true, Math.PI / 180], rad: [true, 1],
  mm: [false, 1e-3], cm: [false, 1e-2], m: [false, 1], in: [false, 0.0254],
};

// A position as typed [rad] or [m]: `30`, `30 deg`, `0.5 rad`, `12,5 mm`; null if it is none of that joint.
export function parsed(joint, text) {
  const [, number, unit] = text.trim().match(/^([-+−]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:e[-+]?\d+)?)\s*([^\s\d]*)$/i) ?? [];
  const [turn, factor] = UNITS[unit?.toLowerCase() || (joint.turn ? "deg" : "mm")] ?? [];
  if (number === undefined || turn !== Boolean(joint.turn)) return null;
  return Number(number.replace(",", ".").replace("−", "-")) * factor;
}

export const mistyped = (joint, text) => `'${text}' is not ${joint.turn ? "an angle, such as 30, 30 deg or 0.5 rad" : "a length, such as 12, 12 mm or 0.012 m"}.`;
