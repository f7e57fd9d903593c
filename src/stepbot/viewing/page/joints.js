// A slider for every driven joint; every joint and closure with its evidence.

import { byModule, element } from "./dom.js";
import { fine, internal, mistyped, parsed, short, shown, unitOf } from "./numbers.js";

export function jointsPanel(state) {
  const section = element("section");
  let sliders = [];
  const build = () => {
    sliders = state.scene.motion.driven.map((one) => slider(state, one));
    const followers = state.scene.connections.filter((one) => !sliders.some((s) => one.coordinates.includes(s.name)));
    const head = element("div.line", {}, element("h3.label", {}, "Joints"), element("button.small", { type: "button", id: "reset", onclick: () => state.reset() }, "as drawn"));
    head.style.justifyContent = "space-between";
    section.replaceChildren(
      ...(sliders.length ? [head] : []),
      ...byModule(state.scene, sliders, ({ child }) => child, ({ node }) => node),
      ...(followers.length ? [element("h3", {}, sliders.length ? "Follow, or fixed" : "Fixed")] : []),
      ...byModule(state.scene, followers, ({ child }) => child, (one) => element("div.joint", { "data-joint": one.name }, heading(state, one), reading(state, one))),
    );
    if (!state.scene.connections.length) section.append(element("p.quiet", {}, "No joints."));
  };
  const move = () => {
    sliders.forEach((one) => one.update());
    for (const node of section.querySelectorAll("[data-reading]")) node.textContent = positionText(state, node.dataset.reading);
  };
  const choose = () => {
    for (const node of section.querySelectorAll(".joint")) node.classList.toggle("chosen", node.dataset.joint === state.selection?.connection);
  };
  state.listen((what) => {
    if (what === "scene") build();
    if (what === "scene" || what === "motion") move();
    if (what === "scene" || what === "selection") choose();
  });
  return section;
}

function heading(state, one, title = one.name) {
  return element("div.head", {},
    element("button" + (one.doubt ? ".warn" : ""), { type: "button", title: one.doubt, onclick: () => state.select({ connection: one.name }) }, one.doubt ? `? ${title}` : title),
    element("span.kind", {}, `${one.kind}${one.closes ? " closure" : ""}, ${one.parent} → ${one.child}`));
}

function reading(state, one) {
  return one.coordinates.length ? element("div.quiet.number", { "data-reading": one.name }) : null;
}

function positionText(state, name) {
  const one = state.scene.connections.find((connection) => connection.name === name);
  return one.coordinates.map((coordinate) => {
    const column = state.tree.column.get(coordinate);
    const joint = state.tree.joints[column];
    return `${fine(shown(joint, state.positions[column]))} ${unitOf(joint)}`;
  }).join(", ");
}

function slider(state, { name, range }) {
  const joint = state.tree.independent[state.tree.row.get(name)];
  const one = state.scene.connections.find((connection) => connection.coordinates.includes(name));
  const [low, high] = range.map((end) => shown(joint, end));
  const text = () => `${fine(shown(joint, state.u[state.tree.row.get(name)]))} ${unitOf(joint)}`;
  let mine = false; // whether the motion comes from this entry
  const move = (q) => {
    mine = true;
    state.drive(name, q);
    mine = false;
  };
  const bar = element("input", { type: "range", min: low, max: high, step: "any", "aria-label": name, "data-slider": name,
    oninput: () => move(internal(joint, Number(bar.value))), onchange: () => (bar.value = shown(joint, state.u[state.tree.row.get(name)])) });
  const box = element("input.number", { type: "text", inputmode: "decimal", "aria-label": `${name} [${unitOf(joint)}]`, "data-value": name, onchange: () => {
    const [typed, q] = [box.value, parsed(joint, box.value)];
    if (q !== null) move(Math.min(Math.max(q, range[0]), range[1]));
    box.value = text();
    bar.value = shown(joint, state.u[state.tree.row.get(name)]);
    if (q === null) why.textContent = mistyped(joint, typed);
    else if (q < range[0] || q > range[1]) why.textContent = `${typed} is beyond the limit ${short(q < range[0] ? low : high)} ${unitOf(joint)}. ${state.note}`;
  } });
  const why = element("p.why.warn");
  const title = one.coordinates.length > 1 ? name : one.name;
  const entry = element("div.joint", { "data-joint": one.name }, heading(state, one, title),
    element("div.slider", {}, bar, box),
    element("div.ends.number", {}, element("span", {}, `${short(low)} ${unitOf(joint)}`), element("span", {}, `${short(high)} ${unitOf(joint)}`)), why);
  const node = {
    name,
    child: one.child,
    node: entry,
    update() {
      if (document.activeElement !== box) box.value = text();
      if (!mine) bar.value = shown(joint, state.u[state.tree.row.get(name)]);
      why.textContent = mine ? state.note : "";
    },
  };
  return node;
}
