// Several parts at once: those like one of them, those in a frame, and one rule for all.

import { edit, say } from "./changes.js";
import { byId, element } from "./dom.js";
import { button, submits } from "./form.js";
import { app } from "./main.js";
import { patternOf, valueField } from "./settings.js";

const { state } = app;

// The parts like one of them, in a list of [what they have in common, their paths]; only where there is more than one.
function alike(path) {
  const { components, links } = state.scene;
  const { product } = components.find((one) => one.path === path) ?? {};
  const shapes = new Map(); // of each part the numbers of its meshes
  for (const { visuals } of links) {
    for (const { component, mesh } of visuals) shapes.set(component, `${shapes.get(component) ?? ""} ${mesh}`);
  }
  const ofProduct = product ? components.filter((one) => one.product === product).map((one) => one.path) : [];
  const ofShape = [...shapes].filter(([, shape]) => shape === shapes.get(path)).map(([one]) => one);
  const isOther = ofShape.length !== ofProduct.length || ofShape.some((one) => !ofProduct.includes(one));
  return [[`of ${product}`, ofProduct], ["of this shape", isOther ? ofShape : []]].filter(([, paths]) => paths.length > 1);
}

export function alikeTools(path) {
  return alike(path).map(([words, paths]) => {
    const one = button(`select all ${paths.length} ${words}`, () => state.select({ link: state.linkOf(path), component: path, picked: [path, ...paths.filter((other) => other !== path)] }));
    one.dataset.alike = words;
    return one;
  });
}

// One rule for all parts of a product that are picked, a rule for each other part; as one step.
export function rulesForm(paths) {
  const { components } = state.scene;
  const isWhole = ({ product }) => components.every((one) => one.product !== product || paths.includes(one.path));
  const patterns = [...new Set(paths.map((path) => {
    const one = components.find((other) => other.path === path);
    return one?.product && isWhole(one) ? patternOf(one.product) : path;
  }))];
  const fields = ["density", "mass", "material"].map((key) => valueField(["parts", "", key], {}));
  const set = button(`set for these ${paths.length} parts`, () => {
    const given = fields.filter((one) => one.isSet()).map((one) => one.question());
    if (!given.length) say("Type a density, a mass of each part, or a material first.");
    else edit("all", { edits: patterns.flatMap((pattern) => given.map((one) => ({ ...one, keys: ["parts", pattern, one.keys[2]] }))) });
  });
  set.dataset.edit = "rules";
  return [element("h3", {}, "Density, or mass of each"), submits(element("div.form", {}, fields.map(({ node }) => node), set), set)];
}

// A frame that is dragged selects the parts inside: with Ctrl, or after its button was pressed.
const rubber = element("div", { id: "rubber", hidden: true });
let isArmed = false;
const arm = () => {
  isArmed = !isArmed;
  chip.setAttribute("aria-pressed", String(isArmed));
};
const chip = element("button.chip", { type: "button", id: "box", title: "b; or Ctrl-drag", "aria-pressed": "false", onclick: arm }, "Box");
byId("fit").before(chip);
byId("stage").append(rubber);
app.keys.push(["b", "drag a box around parts; also Ctrl-drag", arm]);
app.view.box = {
  starts: (event) => isArmed || event.ctrlKey || event.metaKey,
  drawn(from, to) {
    rubber.hidden = !from;
    if (!from) return;
    const { left, top } = byId("stage").getBoundingClientRect();
    const [x, y, right, bottom] = [Math.min(from[0], to[0]), Math.min(from[1], to[1]), Math.max(from[0], to[0]), Math.max(from[1], to[1])];
    Object.assign(rubber.style, { left: `${x - left}px`, top: `${y - top}px`, width: `${right - x}px`, height: `${bottom - y}px` });
  },
  taken(paths) {
    if (isArmed) arm();
    if (paths.length) state.select({ link: state.linkOf(paths[0]), component: paths[0], picked: paths, add: true });
    else say("No part is wholly inside the box.");
  },
};
