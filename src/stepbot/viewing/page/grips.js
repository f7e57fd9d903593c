// Handles on the robot for the selected joint: where it is, and what a panel adds, such as its limits. Each is dragged along
// the arc or bar of its joint. For the keyboard a panel has a slider for each.

import { element } from "./dom.js";
import { onGlyph } from "./glyphs.js";
import { fine, shown, unitOf } from "./numbers.js";
import { position } from "./vectors.js";

const STEPS = 40; // places that are compared, to each side of the last one
const FINER = 3; // times

// Grips { label, joint, value(), range, take(q), done() } for where the joints of the selection are.
function positions(state) {
  const { selection, scene, tree } = state;
  const one = selection?.connection && state.find(selection);
  return scene.motion.driven.filter(({ name }) => one?.coordinates.includes(name)).map(({ name, range }) => {
    const column = tree.column.get(name);
    return { label: "", joint: tree.joints[column], range, value: () => state.positions[column], take: (q) => state.drive(name, q), done() {} };
  });
}

export class Grips {
  constructor(state, view) {
    Object.assign(this, { state, view, nodes: [], sources: [() => positions(state)] });
  }

  // Put each handle where the camera sees it.
  place() {
    const found = this.sources.flatMap((source) => source());
    while (this.nodes.length > found.length) this.nodes.pop().remove();
    found.forEach((grip, i) => {
      const node = (this.nodes[i] ??= this.node());
      node.grip = grip;
      node.textContent = `${grip.label} ${fine(shown(grip.joint, grip.value()))}${grip.joint.turn ? "" : " "}${unitOf(grip.joint)}`.trim();
      node.classList.toggle("end", grip.label !== "");
      const { x, y, depth } = this.seen(grip, grip.value());
      node.hidden = depth <= 0;
      // Limits are written outwards of the axis, so that they do not hide each other.
      const axis = this.onCanvas(position(this.state.pose(grip.joint.child)));
      const apart = grip.label ? Math.hypot(x - axis.x, y - axis.y) || 1 : Infinity;
      node.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(${(-50 + (55 * (x - axis.x)) / apart).toFixed(0)}%, ${(-50 + (80 * (y - axis.y)) / apart).toFixed(0)}%)`;
    });
  }

  node() {
    const node = element("span.grip", { "aria-hidden": "true" });
    node.addEventListener("pointerdown", (event) => {
      node.setPointerCapture(event.pointerId);
      event.preventDefault();
    });
    node.addEventListener("pointermove", (event) => {
      if (node.hasPointerCapture(event.pointerId)) node.grip.take(this.nearest(node.grip, event));
    });
    node.addEventListener("lostpointercapture", () => node.grip.done());
    this.view.tags.after(node);
    return node;
  }

  // Where a position of a grip's joint is on the canvas [px].
  seen({ joint }, q) {
    const { state, view } = this;
    const now = state.positions[state.tree.column.get(joint.name)];
    return this.onCanvas(onGlyph(state.pose(joint.child), joint, q - now, view.glyphSize(joint)));
  }

  onCanvas(point) {
    const { camera, canvas } = this.view;
    const { x, y, depth } = camera.project(point);
    return { x: x * canvas.clientWidth, y: y * canvas.clientHeight, depth };
  }

  // The position near the last one that is drawn closest to the pointer.
  nearest(grip, { clientX, clientY }) {
    const { left, top } = this.view.canvas.getBoundingClientRect();
    let best = grip.value();
    let reach = grip.joint.turn ? 0.8 : this.view.radius;
    for (let time = 0; time < FINER; time++) {
      const from = best;
      let least = Infinity;
      for (let i = -STEPS; i <= STEPS; i++) {
        const q = Math.min(grip.range[1], Math.max(grip.range[0], from + (reach * i) / STEPS));
        const { x, y } = this.seen(grip, q);
        const distance = Math.hypot(x - (clientX - left), y - (clientY - top));
        if (distance < least) [least, best] = [distance, q];
      }
      reach /= STEPS / 2;
    }
    return best;
  }
}
