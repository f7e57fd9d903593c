// What the page shows: the scene, a configuration, what is selected, what is visible. Panels and view listen.

import { Loops } from "./loops.js";
import { Tree } from "./tree.js";

export class State {
  constructor() {
    this.listeners = [];
    this.show = { joints: true, names: false, frames: false, masses: false, collisions: false, visuals: true, sensors: true, byLink: false };
    this.hidden = new Set();
    this.selection = null;
    this.preview = {}; // for joints by name, limits to draw that were not written yet
    this.renames = []; // pairs of names, the former one first; the latest pair last
    this.tab = "joints";
  }

  // The types that an edit may give a joint, or a closure.
  kinds(closes) {
    const types = Object.entries(this.scene.joint_types);
    return types.filter(([, one]) => !closes || one.closes).map(([kind]) => kind);
  }

  // Show a scene; joints of the same name keep their positions where the new robot allows it.
  load(scene) {
    const former = this.scene ? this.q() : {};
    const same = this.scene && this.scene.name === scene.name;
    this.scene = scene;
    this.contacts = null;
    this.tree = new Tree(scene.motion);
    this.loops = new Loops(this.tree, scene.motion, scene.joint_types);
    this.link = new Map(scene.links.map((link, i) => [link.name, { ...link, index: i }]));
    this.note = "";
    this.drawn = this.loops.closed(this.tree.drawn()) ?? this.tree.drawn();
    this.settle(this.drawn);
    if (same) this.restore(former);
    if (this.wanted && this.find(this.wanted)) [this.selection, this.wanted] = [this.wanted, null];
    if (this.selection) this.selection = this.again(this.selection);
    this.tell("scene");
  }

  // The same selection in a new scene, where a part may be in another link; null if it is gone.
  again(selection) {
    const { component } = selection;
    if (component && !this.scene.components.some((one) => one.path === component)) return null;
    if (component) return { ...selection, link: this.linkOf(component) };
    // The same object under its new name; an undone change gives back the former one.
    const key = selection.connection ? "connection" : "link";
    const names = [selection[key], ...this.renames.filter((pair) => pair.includes(selection[key])).map(([from, to]) => (from === selection[key] ? to : from)).reverse()];
    const name = names.find((one) => this.find({ [key]: one }));
    return name === undefined ? null : Object.assign(selection, { [key]: name });
  }

  // The link of a part or of the first part below it.
  linkOf(path) {
    const { components, links } = this.scene;
    const owner = components.find((one) => one.link && (one.path === path || one.path.startsWith(`${path}/`)));
    return owner?.link ?? links[0].name;
  }

  // A name that no link, joint, frame or sensor has.
  free(name) {
    const taken = new Set([...this.scene.links, ...this.scene.connections, ...this.scene.frames, ...this.scene.sensors].map((one) => one.name));
    let found = name;
    for (let i = 2; taken.has(found); i++) found = `${name}_${i}`;
    return found;
  }

  restore(former) {
    const targets = this.scene.motion.driven
      .filter(({ name }) => name in former)
      .map(({ name, range: [low, high] }) => [this.tree.row.get(name), Math.min(Math.max(former[name], low), high)]);
    if (targets.length) this.settle(this.loops.move(this.u, targets).u);
  }

  settle(u) {
    this.u = u;
    this.positions = this.tree.follow(u);
    this.X = this.tree.frames(this.positions);
  }

  // Move one driven joint, as far as limits and loops allow.
  drive(name, value) {
    const { u, why } = this.loops.move(this.u, [[this.tree.row.get(name), value]]);
    this.note = why;
    this.settle(u);
    this.tell("motion");
  }

  reset() {
    this.note = "";
    this.settle(this.drawn);
    this.tell("motion");
  }

  // Positions of all moving joints by name.
  q() {
    return Object.fromEntries(this.tree.joints.map((joint, i) => [joint.name, this.positions[i]]));
  }

  // Links that overlap: where the robot is, if a server compares them, else as drawn.
  overlapping() {
    return this.contacts ?? this.scene.proof?.overlaps ?? [];
  }

  overlaps(link) {
    return this.overlapping().some(({ links }) => links.includes(link));
  }

  pose(link) {
    return this.X[this.tree.linkIndex.get(link)];
  }

  // selection: { link, component, triangle, point, X }, the triangle in the frame at X, { link, overlapped } or { connection }.
  // What the scene does not have yet is selected when it comes.
  select(selection) {
    this.wanted = selection && !this.find(selection) ? selection : null;
    if (this.wanted) return;
    this.selection = this.picking ? this.picking(selection) : selection;
    this.tell("selection");
  }

  // Whether a part is one of those selected, or below one of them.
  isPicked(component) {
    const { selection, picked } = this;
    if (!component || !selection?.component) return false;
    if (picked?.selection !== selection) this.picked = { selection, paths: new Set(selection.picked ?? [selection.component]) };
    const { paths } = this.picked;
    for (let end = component.length; end > 0; end = component.lastIndexOf("/", end - 1)) {
      if (paths.has(component.slice(0, end))) return true;
    }
    return false;
  }

  find(selection) {
    if (selection.connection) return this.scene.connections.find((one) => one.name === selection.connection);
    return this.link.get(selection.link);
  }

  // The joint, closure or link that a text is about, as a selection: `joint 'elbow': ...`; null for none.
  mentioned(text) {
    for (const [, , name] of text.matchAll(/(^|[\s(:,])'([^']+)'/g)) {
      const found = [{ connection: name }, { link: name }].find((one) => this.find(one));
      if (found) return found;
    }
    return this.link.has(text) ? { link: text } : this.find({ connection: text }) ? { connection: text } : null;
  }

  set(name, value) {
    this.show[name] = value;
    this.tell("show");
  }

  toggle(link) {
    if (!this.hidden.delete(link)) this.hidden.add(link);
    this.tell("show");
  }

  listen(heard) {
    this.listeners.push(heard);
  }

  tell(what) {
    this.listeners.forEach((heard) => heard(what));
  }
}

// A colour for each link, far from that of its neighbours in the list.
export function linkColor(index) {
  const hue = (index * 137.508 + 212) % 360;
  const [s, l] = [0.46, 0.6];
  const channel = (n) => {
    const k = (n + hue / 30) % 12;
    return l - s * Math.min(l, 1 - l) * Math.max(-1, Math.min(k - 3, 9 - k, 1));
  };
  return [channel(0), channel(8), channel(4), 1];
}

export const css = (color) => `rgb(${color.slice(0, 3).map((c) => Math.round(255 * c)).join(" ")})`;
