// A perspective camera that orbits around a point, z up; drag to orbit, shift-drag or two fingers to pan, wheel or
// pinch to zoom.

import { add, cross, dot, minus, norm, scaled, unit } from "./vectors.js";

const FIELD = (28 * Math.PI) / 180;
const STEEPEST = 1.5533;

export class Camera {
  constructor() {
    this.target = [0, 0, 0];
    this.distance = 1;
    this.azimuth = -0.9;
    this.elevation = 0.42;
    this.size = 1;
    this.aspect = 1;
    this.field = FIELD;
  }

  // Show a sphere.
  fit(center, radius) {
    this.target = center;
    this.size = radius || 1;
    this.distance = (1.05 * this.size) / Math.sin(FIELD / 2) / Math.min(1, this.aspect);
  }

  look(azimuth, elevation) {
    this.azimuth = azimuth;
    this.elevation = elevation;
  }

  // Unit vectors: towards the viewer, to the right, up.
  axes() {
    const [c, s] = [Math.cos(this.elevation), Math.sin(this.elevation)];
    const back = [c * Math.cos(this.azimuth), c * Math.sin(this.azimuth), s];
    const right = [-Math.sin(this.azimuth), Math.cos(this.azimuth), 0];
    return { back, right, up: cross(back, right) };
  }

  get eye() {
    return add(this.target, scaled(this.axes().back, this.distance));
  }

  // Column-major matrix from the world to clip space.
  matrix() {
    const { back, right, up } = this.axes();
    const eye = this.eye;
    const near = Math.max(this.distance - 4 * this.size, this.distance * 0.02);
    const far = this.distance + 6 * this.size;
    const f = 1 / Math.tan(FIELD / 2);
    const rows = [right, up, back].map((axis) => [...axis, -dot(axis, eye)]);
    const a = (far + near) / (near - far);
    const b = (2 * far * near) / (near - far);
    const clip = [
      rows[0].map((v) => (v * f) / this.aspect),
      rows[1].map((v) => v * f),
      rows[2].map((v, i) => a * v + (i === 3 ? b : 0)),
      rows[2].map((v) => -v),
    ];
    return new Float32Array([0, 1, 2, 3].flatMap((column) => clip.map((row) => row[column])));
  }

  // Where a point of the world is on the canvas, in shares of its width and height from the top left.
  project(point) {
    return this.projection()(point);
  }

  // The same as a function, for many points.
  projection() {
    const { back, right, up } = this.axes();
    const { eye, aspect } = this;
    const half = 0.5 / Math.tan(FIELD / 2);
    return (point) => {
      const d = minus(point, eye);
      const depth = -dot(d, back);
      return { x: 0.5 + (half * dot(d, right)) / depth / aspect, y: 0.5 - (half * dot(d, up)) / depth, depth };
    };
  }

  // The ray through a point of the canvas.
  ray(x, y) {
    const { back, right, up } = this.axes();
    const t = Math.tan(FIELD / 2);
    const direction = add(add(scaled(right, (2 * x - 1) * t * this.aspect), scaled(up, (1 - 2 * y) * t)), scaled(back, -1));
    return { origin: this.eye, direction: unit(direction) };
  }

  orbit(dx, dy) {
    this.azimuth -= dx * 0.008;
    this.elevation = Math.max(-STEEPEST, Math.min(STEEPEST, this.elevation + dy * 0.008));
  }

  pan(dx, dy, height) {
    const { right, up } = this.axes();
    const perPixel = (2 * this.distance * Math.tan(FIELD / 2)) / height;
    this.target = add(this.target, add(scaled(right, -dx * perPixel), scaled(up, dy * perPixel)));
  }

  // Zoom; what is at a place of the canvas, in shares of its size, stays there.
  zoom(factor, x = 0.5, y = 0.5) {
    const former = this.distance;
    this.distance = Math.max(0.02 * this.size, Math.min(30 * this.size, former * factor));
    const { right, up } = this.axes();
    const half = Math.tan(FIELD / 2) * (former - this.distance);
    this.target = add(this.target, add(scaled(right, (2 * x - 1) * half * this.aspect), scaled(up, (1 - 2 * y) * half)));
  }
}

const KEY_STEP = 24; // [px] that a key is worth

// Connect a camera to the gestures on a canvas. A press without motion is a click. `framing` takes the drags that it starts.
export function steer(canvas, camera, { changed, clicked, framing }) {
  const fingers = new Map();
  let travelled = 0;
  let corner = null; // where a frame started
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    const here = [event.clientX, event.clientY];
    if (!fingers.size) [travelled, corner] = [0, framing.starts(event) ? here : null];
    fingers.set(event.pointerId, here);
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = fingers.get(event.pointerId);
    if (!last) return;
    const here = [event.clientX, event.clientY];
    const [dx, dy] = [here[0] - last[0], here[1] - last[1]];
    travelled += Math.abs(dx) + Math.abs(dy);
    if (corner) framing.drawn(corner, here);
    else if (fingers.size === 2) {
      const [other] = [...fingers].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
      const apart = (place) => norm([place[0] - other[0], place[1] - other[1], 0]) || 1;
      camera.zoom(apart(last) / apart(here));
      camera.pan(dx / 2, dy / 2, canvas.clientHeight);
    } else if (event.shiftKey || event.buttons === 2 || event.buttons === 4) camera.pan(dx, dy, canvas.clientHeight);
    else camera.orbit(dx, dy);
    fingers.set(event.pointerId, here);
    changed();
  });
  const released = (event) => {
    const pressed = fingers.delete(event.pointerId);
    if (!pressed || fingers.size) return;
    const isDone = event.type === "pointerup";
    if (corner) framing.drawn(null);
    if (isDone && travelled < 6) clicked(event);
    else if (isDone && corner) framing.taken(corner, [event.clientX, event.clientY]);
    corner = null;
  };
  canvas.addEventListener("pointerup", released);
  canvas.addEventListener("pointercancel", released);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const { left, top, width, height } = canvas.getBoundingClientRect();
    camera.zoom(Math.exp(event.deltaY * (event.deltaMode ? 0.05 : 0.0012)), (event.clientX - left) / width, (event.clientY - top) / height);
    changed();
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const [x, y] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key] ?? [0, 0];
    const factor = { "+": 0.85, "=": 0.85, "-": 1 / 0.85 }[event.key] ?? 1;
    if ((!x && !y && factor === 1) || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    if (event.shiftKey && factor === 1) camera.pan(KEY_STEP * x, KEY_STEP * y, canvas.clientHeight);
    else camera.orbit(KEY_STEP * x, KEY_STEP * y);
    camera.zoom(factor);
    changed();
  });
}
