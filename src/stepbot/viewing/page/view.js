// The canvas: draws the state, finds what is under the pointer, places names.

import { Camera, steer } from "./camera.js";
import { element } from "./dom.js";
import { ellipsoid, frame, ground, joint as jointGlyph, ring } from "./glyphs.js";
import { Grips } from "./grips.js";
import { boxOf, edgeAt, pick } from "./picking.js";
import { Renderer } from "./renderer.js";
import { clustered, drawable, meshOf, unpacked } from "./shapes.js";
import { linkColor } from "./state.js";
import { add, apply, inverse, minus, norm, position, scaled, times, turn } from "./vectors.js";

const AXIS = [0.95, 0.55, 0.1, 1];
const PASSIVE = [0.55, 0.58, 0.64, 0.9];
const DOUBT = [0.85, 0.2, 0.5, 1];
const CONTACT = [0.9, 0.05, 0.05, 1];
const FRAME_SHARE = 0.12;
const SMALL = 14; // [px] below which a part has no edges
const TINY = 4; // [px] below which it is drawn as a box
const MANY = 300000; // triangles in view above which parts of modest size are drawn with fewer
const COARSE = [[16, 8], [48, 24]]; // [px] below which a part has so many cells along its longest side, of 2 px at most
const EDGE_REACH = 7; // [px] from an edge up to which a click means it

export class View {
  constructor(state, canvas, tags) {
    this.state = state;
    this.canvas = canvas;
    this.tags = tags;
    this.camera = new Camera();
    this.renderer = new Renderer(canvas);
    this.cube = this.renderer.upload(drawable(meshOf({ shape: "box", size: [1, 1, 1] })));
    this.items = [];
    this.uploaded = new Map();
    this.grips = new Grips(state, this);
    this.box = null; // set where parts can be selected with a frame: { starts(event), drawn(from, to), taken(paths) }
    steer(canvas, this.camera, {
      changed: () => this.request(),
      clicked: (event) => this.click(event),
      framing: {
        starts: (event) => Boolean(this.box?.starts(event)),
        drawn: (from, to) => this.box.drawn(from, to),
        taken: (from, to) => this.box.taken(this.within(from, to)),
      },
    });
    new ResizeObserver(() => this.request()).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.request());
    state.listen((what) => {
      if (what === "scene" || what === "motion") this.bounds = null;
      if (what === "scene") this.load();
      this.request();
    });
  }

  // Take the shapes of a new scene; the camera stays where it is, unless it is the first one.
  load() {
    const { scene } = this.state;
    const former = this.uploaded;
    this.uploaded = new Map();
    this.items = scene.links.flatMap((link, index) => [
      ...link.visuals.map((shape) => this.item(shape, former, { link: link.name, index, kind: "visual" })),
      ...link.collisions.map((shape) => this.item(shape, former, { link: link.name, index, kind: "collision" })),
    ]);
    for (const [key, { mesh, coarse }] of former) {
      if (!this.uploaded.has(key)) new Set([mesh, ...coarse.values()]).forEach((one) => this.renderer.release(one));
    }
    this.posed = null;
    this.radius = this.extent().radius;
    if (!this.fitted && this.items.length) this.fit();
  }

  // A shape in its place. What was drawn before, in the former scene or elsewhere in this one, is used again.
  item(shape, former, place) {
    const packed = shape.shape === "mesh" ? this.state.scene.meshes[shape.mesh] : null;
    const key = packed
      ? (packed.key ??= [packed.low, packed.size, packed.vertices, packed.faces].join())
      : [shape.shape, shape.size, shape.radius, shape.length].join();
    let shared = this.uploaded.get(key) ?? former.get(key);
    if (!shared) {
      const geometry = packed ? unpacked(packed) : meshOf(shape);
      const { sharp, ...drawn } = drawable(geometry);
      const { low, high } = boxOf(geometry.vertices);
      const [center, radius] = [scaled(add(low, high), 0.5), norm(minus(high, low)) / 2];
      shared = { geometry: { ...geometry, low, high, center, radius, sharp }, mesh: this.renderer.upload(drawn), coarse: new Map() };
    }
    this.uploaded.set(key, shared);
    return { ...shared, ...place, X_LG: shape.X, rgba: shape.color, component: shape.component ?? "" };
  }

  extent() {
    return (this.bounds ??= this.measured());
  }

  measured() {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (const item of this.placed()) {
      for (let corner = 0; corner < 8; corner++) {
        const at = apply(item.X, [0, 1, 2].map((i) => ((corner >> i) & 1 ? item.geometry.high[i] : item.geometry.low[i])));
        at.forEach((value, i) => {
          low[i] = Math.min(low[i], value);
          high[i] = Math.max(high[i], value);
        });
      }
    }
    if (!this.items.length) return { center: [0, 0, 0], radius: 0.5, low: [0, 0, 0] };
    return { center: scaled(add(low, high), 0.5), radius: norm(minus(high, low)) / 2, low };
  }

  fit() {
    const { center, radius } = this.extent();
    this.camera.aspect = this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight);
    this.camera.fit(center, radius);
    this.fitted = true;
    this.request();
  }

  request() {
    this.pending ??= requestAnimationFrame(() => {
      this.pending = null;
      this.draw();
    });
  }

  // All items, where the robot has them now.
  placed() {
    const { state } = this;
    if (this.posed !== state.X) for (const item of this.items) item.X = times(state.pose(item.link), item.X_LG);
    this.posed = state.X;
    return this.items;
  }

  visible() {
    const { show, hidden } = this.state;
    return this.placed().filter((item) => !hidden.has(item.link) && show[item.kind === "visual" ? "visuals" : "collisions"]);
  }

  draw() {
    const { state, camera } = this;
    if (!state.scene) return;
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    const ink = dark ? 1 : 0;
    const ends = state.selection?.connection ? this.ends() : null;
    const pixels = this.pixels();
    const sized = this.visible().map((item) => [item, pixels(item)]).filter(([, size]) => size > 0);
    const areMany = sized.reduce((sum, [item, size]) => sum + (size < TINY ? 0 : item.mesh.corners / 3), 0) > MANY;
    const drawn = sized.map(([item, size]) => {
      const color = this.color(item, ends);
      const edge = item.kind === "collision" ? [0.9, 0.45, 0.1, 0.5] : color[3] < 0.5 ? [ink, ink, ink, 0.12] : null;
      const [mesh, X] = size < TINY ? [this.cube, boxed(item)] : [areMany ? this.coarse(item, size) : item.mesh, item.X];
      return { mesh, X, color, glow: this.glow(item, ends), edge, isSmall: size < SMALL };
    });
    const { center, low } = this.extent();
    const floor = ground(center, this.radius, low[2], [ink, ink, ink, dark ? 0.1 : 0.13]);
    this.renderer.draw(camera, drawn, { below: floor, above: this.lines() }, dark ? [0, 0, 0, 0.45] : [0.05, 0.08, 0.14, 0.42]);
    this.placeTags();
    this.grips.place();
  }

  // A mesh of an item with fewer triangles, for its size on the canvas [px], made when it is first needed; its own if it has few.
  coarse({ geometry, mesh, coarse }, size) {
    const cells = COARSE.find(([below]) => size < below)?.[1];
    if (cells === undefined) return mesh;
    if (!coarse.has(cells)) {
      const { sharp, ...drawn } = drawable(clustered(geometry, cells));
      coarse.set(cells, 2 * drawn.positions.length < 3 * mesh.corners ? this.renderer.upload(drawn) : mesh);
    }
    return coarse.get(cells);
  }

  // A function: the size of an item on the canvas [px]; 0 for one that cannot be seen.
  pixels() {
    const project = this.camera.projection();
    const { clientWidth, clientHeight } = this.canvas;
    const scale = clientHeight / Math.tan(this.camera.field / 2);
    return ({ X, geometry: { center, radius } }) => {
      const { x, y, depth } = project(apply(X, center));
      if (depth <= radius) return depth > -radius ? Infinity : 0; // around the eye, or behind it
      const size = (radius * scale) / (depth - radius);
      const [right, down] = [size / clientWidth, size / clientHeight];
      return x < -right || x > 1 + right || y < -down || y > 1 + down ? 0 : size;
    };
  }

  color(item, ends) {
    if (item.kind === "collision") return this.state.overlaps(item.link) ? [0.9, 0.12, 0.12, 0.45] : [0.98, 0.6, 0.2, 0.28];
    const { show } = this.state;
    const base = show.byLink || !item.rgba ? linkColor(item.index) : item.rgba;
    const covered = show.collisions || show.masses || (ends && !ends.includes(item.link));
    return covered ? [...base.slice(0, 3), Math.min(base[3], 0.45)] : base;
  }

  ends() {
    const one = this.state.find(this.state.selection);
    return [one.parent, one.child];
  }

  glow(item, ends) {
    const { selection } = this.state;
    if (!selection || item.kind === "collision") return null;
    if (this.state.isPicked(item.component)) return [0.25, 0.55, 1, 0.75];
    if (ends) return ends[1] === item.link ? [0.25, 0.55, 1, 0.35] : null;
    return [selection.link, selection.overlapped].includes(item.link) && !selection.picked ? [0.25, 0.55, 1, 0.3] : null;
  }

  lines() {
    const { state, radius } = this;
    const { show, scene } = state;
    const size = FRAME_SHARE * radius;
    const lines = [];
    if (show.joints) lines.push(...this.jointLines(size));
    if (show.frames) {
      for (const link of scene.links) lines.push(...frame(state.pose(link.name), 0.6 * size));
      for (const one of scene.frames) lines.push(...frame(times(state.pose(one.link), one.X), size));
    }
    if (show.sensors) {
      for (const one of scene.sensors.filter((sensor) => sensor.placed)) {
        lines.push(...frame(times(state.pose(one.link), one.X), 0.7 * size));
      }
    }
    if (show.masses) {
      for (const link of scene.links.filter((one) => one.mass.ellipsoid && !state.hidden.has(one.name))) {
        lines.push(...ellipsoid(state.pose(link.name), link.mass, [...linkColor(state.link.get(link.name).index).slice(0, 3), 1]));
      }
    }
    if (show.collisions) lines.push(...this.contactPoints(0.2 * size));
    if (state.selection?.line) lines.push(...this.axisLine(state.selection.line));
    return lines;
  }

  // Where links overlap most.
  contactPoints(size) {
    return this.state.overlapping().filter(({ point }) => point).flatMap(({ links, point }) => {
      const X = this.state.pose(links[0]);
      const at = apply(X, point);
      const cross = [0, 1, 2].map((i) => [X[i], X[3 + i], X[6 + i]]).map((axis) => [add(at, scaled(axis, -size)), add(at, scaled(axis, size)), CONTACT]);
      return [...cross, ...ring(at, size, this.camera, CONTACT)];
    });
  }

  // The axis of a clicked face, given in the frame of the component's shape.
  axisLine({ component, point, direction }) {
    const item = this.items.find((one) => one.component === component);
    if (!item) return [];
    const X = times(this.state.pose(item.link), item.X_LG);
    const [p, d] = [apply(X, point), turn(X, direction)];
    const reach = 0.7 * this.radius;
    return [[add(p, scaled(d, -reach)), add(p, scaled(d, reach)), [0.15, 0.45, 1, 1]]];
  }

  jointLines(size) {
    const { state } = this;
    const lines = [];
    for (const one of state.scene.connections) {
      const chosen = state.selection?.connection === one.name;
      const color = one.doubt ? DOUBT : AXIS;
      for (const name of one.coordinates) {
        const column = state.tree.column.get(name);
        const joint = state.tree.joints[column];
        const passive = joint.leader !== name || !state.loops.driven.has(state.tree.row.get(name));
        const tint = passive && !chosen && !one.doubt ? PASSIVE : color;
        lines.push(...jointGlyph(state.pose(joint.child), { ...joint, ...state.preview[name] }, state.positions[column], this.glyphSize(joint), tint));
      }
      if (one.closes || one.doubt) lines.push(...ring(this.place(one), 0.28 * size, this.camera, color));
    }
    return lines;
  }

  // The size of the glyph of a joint of the tree.
  glyphSize(joint) {
    const one = this.state.scene.connections.find(({ coordinates }) => coordinates.includes(joint.name));
    return (this.state.selection?.connection === one.name ? 1.5 : 1) * (one.coordinates.length > 1 ? 0.45 : 1) * FRAME_SHARE * this.radius;
  }

  // Where a joint or closure is.
  place(one) {
    const { state } = this;
    if (!one.closes) return position(state.pose(one.child));
    const closure = state.scene.motion.closures.find(({ name }) => name === one.name);
    return position(times(state.pose(closure.a), closure.X_AF));
  }

  placeTags() {
    const { state } = this;
    const { show, scene } = state;
    const wanted = [];
    for (const one of scene.connections) {
      const chosen = state.selection?.connection === one.name;
      if (!(show.joints && (one.doubt || chosen)) && !show.names) continue;
      const text = one.doubt ? `? ${one.name}` : one.name;
      wanted.push({ text, at: this.place(one), doubt: one.doubt, chosen: () => state.select({ connection: one.name }) });
    }
    if (show.frames || show.names) {
      for (const one of scene.frames) wanted.push({ text: one.name, at: position(times(state.pose(one.link), one.X)) });
      for (const one of scene.sensors.filter((sensor) => sensor.placed)) {
        wanted.push({ text: one.name, at: position(times(state.pose(one.link), one.X)) });
      }
    }
    while (this.tags.children.length > wanted.length) this.tags.lastChild.remove();
    wanted.forEach((tag, i) => this.placeTag(tag, this.tags.children[i]));
  }

  placeTag({ text, at, doubt, chosen }, existing) {
    const tag = existing ?? this.tags.appendChild(element("span.tag"));
    const { x, y, depth } = this.camera.project(at);
    tag.textContent = text;
    tag.className = doubt ? "tag doubt" : "tag";
    tag.title = doubt ?? "";
    tag.onclick = chosen ?? null;
    tag.hidden = depth <= 0;
    tag.style.transform = `translate(${(x * this.canvas.clientWidth + 9).toFixed(1)}px, ${(y * this.canvas.clientHeight - 9).toFixed(1)}px)`;
  }

  // What is at a place of the window: a hit of picking.js with the link and the component, or null.
  hit(clientX, clientY) {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    const ray = this.camera.ray((clientX - left) / width, (clientY - top) / height);
    const hit = pick(ray, this.visible());
    if (!hit) return null;
    const { link, component, kind, geometry, X } = hit.item;
    const perPixel = (2 * norm(minus(hit.point, ray.origin)) * Math.tan(this.camera.field / 2)) / height;
    const edge = edgeAt(geometry, apply(inverse(X), hit.point), EDGE_REACH * perPixel);
    return { link, component, kind, point: hit.point, triangle: hit.triangle, X, edge };
  }

  // Paths of the parts that are wholly inside a frame of the window, whether or not others hide them.
  within(from, to) {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    const low = [0, 1].map((i) => Math.min(from[i], to[i]));
    const high = [0, 1].map((i) => Math.max(from[i], to[i]));
    const project = this.camera.projection();
    const isInside = ({ X, geometry: { vertices } }) => {
      for (let i = 0; i < vertices.length; i += 3) {
        const { x, y, depth } = project(apply(X, [vertices[i], vertices[i + 1], vertices[i + 2]]));
        const at = [left + x * width, top + y * height];
        if (depth <= 0 || at.some((value, axis) => value < low[axis] || value > high[axis])) return false;
      }
      return true;
    };
    const found = new Map();
    for (const item of this.visible().filter(({ kind, component }) => kind === "visual" && component)) {
      found.set(item.component, (found.get(item.component) ?? true) && isInside(item));
    }
    return [...found].filter(([, isIn]) => isIn).map(([path]) => path);
  }

  click(event) {
    const hit = this.hit(event.clientX, event.clientY);
    this.state.select(hit && { ...hit, add: event.ctrlKey || event.metaKey });
  }
}

// The pose of a unit cube that fills the box of an item.
function boxed({ X, geometry: { low, high, center } }) {
  const size = minus(high, low);
  return [...X.slice(0, 9).map((value, i) => value * size[i % 3]), ...apply(X, center)];
}
