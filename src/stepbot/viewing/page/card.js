// The card of what is selected: a part, a link, a joint.

import { copyable, element, pairs, place } from "./dom.js";
import { mass, millimetres, short, shown, unitOf, vector } from "./numbers.js";
import { position, turn } from "./vectors.js";

const MOST_OPEN = 6; // parts that are listed without asking

export function card(state, node, extras = () => []) {
  const close = element("button.close", { type: "button", "aria-label": "close", onclick: () => state.select(null) }, "×");
  let facts = [];
  const update = () => {
    const { selection } = state;
    node.hidden = !selection;
    if (!selection) return;
    const { scrollTop } = node;
    const focused = [...(document.activeElement?.attributes ?? [])].find(({ name }) => node.contains(document.activeElement) && name.startsWith("data-"));
    const content = selection.connection ? connectionCard(state, selection) : partCard(state, selection);
    // What has not changed stays: it may have the focus, or a press of a button in it is not over.
    facts = content.map((one) => facts.find((former) => former.isEqualNode(one)) ?? one);
    place(node, [close, ...facts, ...extras(selection)]);
    node.scrollTop = scrollTop;
    if (focused && !node.contains(document.activeElement)) node.querySelector(`[${focused.name}="${CSS.escape(focused.value)}"]`)?.focus();
  };
  state.listen((what) => {
    if (["selection", "scene", "written"].includes(what)) update();
  });
}

function partCard(state, selection) {
  const link = state.link.get(selection.link);
  const component = state.scene.components.find((one) => one.path === selection.component);
  const { mass: body } = link;
  if (selection.picked?.length > 1) {
    const pick = (former) => (path) => state.select({ ...state.selection, add: false, component: path, picked: selection.picked.map((one) => (one === former ? path : one)) });
    return [element("h2", {}, `${selection.picked.length} parts`), element("details", { "data-group": "picked", open: selection.picked.length <= MOST_OPEN }, element("summary", {}, "which"), element("ul", {}, selection.picked.map((path) => element("li", {}, path, ancestors(path, pick(path))))))];
  }
  const source = link.sources.find((one) => one.component === selection.component);
  const lines = [element("h2", {}, selection.component || `link ${link.name}`)];
  if (selection.component) {
    lines.push(ancestors(selection.component, (path) => state.select({ link: state.linkOf(path), component: path })), copyable(component?.quoted ?? selection.component, { id: "path" }));
    lines.push(pairs([
      ["link", link.name],
      ["product", component?.product],
      ["material", component?.material],
      ["mass", source?.mass ? mass(source.mass) : null],
      ["from", source?.origin],
      ["density", source?.density ? `${short(source.density)} kg/m³` : null],
    ]));
    return lines.filter(Boolean);
  }
  lines.push(pairs([
    ["mass", body.mass > 0 ? mass(body.mass) : "none"],
    ["centre of mass", body.mass > 0 ? vector(body.com) : null],
    ["inertia", body.mass > 0 ? inertia(body.inertia) : null],
    ["parts", String(link.components.length || "")],
    ["collision", count(link.collisions.length, "shape")],
  ]));
  return lines;
}

// The subassemblies above a part, each to select as a whole.
function ancestors(component, select) {
  const names = component.match(/(?:\\.|[^/\\])+/g) ?? [];
  const paths = names.slice(0, -1).map((_, i) => names.slice(0, i + 1).join("/"));
  if (!paths.length) return null;
  return element("p.above.quiet", {}, "in ", paths.map((path, i) => [
    i ? " / " : "",
    element("button", { type: "button", "data-above": path, onclick: () => select(path) }, names[i]),
  ]));
}

const count = (number, noun) => `${number} ${noun}${number === 1 ? "" : "s"}`;

function inertia(I) {
  const entries = [["xx", I[0][0]], ["yy", I[1][1]], ["zz", I[2][2]], ["xy", I[0][1]], ["xz", I[0][2]], ["yz", I[1][2]]];
  // Rounding errors of products of inertia are shown as what they are: zero.
  const largest = Math.max(...entries.map(([, value]) => Math.abs(value)));
  const shown = (value) => short(Math.abs(value) < 1e-9 * largest ? 0 : value, 3);
  return element("span.number", {}, `${entries.map(([name, value]) => `${name} ${shown(value)}`).join("  ")} kg m²`);
}

// A direction as the joint table of `check` writes it: `+z`, or its components.
function directed(axis) {
  const main = [0, 1, 2].find((i) => axis.every((value, j) => j === i || Math.abs(value) <= 1e-6));
  return main === undefined ? `[${axis.map((value) => short(value)).join(", ")}]` : `${axis[main] > 0 ? "+" : "-"}${"xyz"[main]}`;
}

// Where parts of its links meet, found by `init` from the drawn pose.
function stopList(one, [joint]) {
  if (!joint || !one.stops.length) return null;
  const line = ({ position, parts }) => element("li", {}, `${short(shown(joint, joint.drawn + position))} ${unitOf(joint)}: ${parts}`);
  return element("div.stops", {}, "found by collision; a limit may be closer", element("ul", {}, one.stops.map(line)));
}

function connectionCard(state, selection) {
  const one = state.find(selection);
  const joints = one.coordinates.map((name) => state.tree.joints[state.tree.column.get(name)]);
  const range = (joint) => (joint.lower === null && joint.upper === null ? "no limits" : [joint.lower, joint.upper].map((end) => (end === null ? "–" : `${short(shown(joint, end))} ${unitOf(joint)}`)).join(" to "));
  const closure = one.closes ? state.scene.motion.closures.findIndex(({ name }) => name === one.name) : -1;
  const gap = closure < 0 ? null : millimetres(state.loops.gaps(state.X)[closure].distance);
  return [
    element("h2", {}, one.name),
    one.doubt ? element("p.warn", {}, `Review: ${one.doubt}`) : null,
    pairs([
      ["type", one.kind + (one.closes ? " closure" : "")],
      ["links", `${one.parent} → ${one.child}`],
      ["at", one.at || vector(position(state.pose(one.child)))],
      ["axis", one.along || (one.axis ? directed(turn(state.pose(one.child), one.axis)) : null)],
      ["range", joints.map(range).join("; ")],
      ["stops", stopList(one, joints)],
      ["velocity", one.limits?.velocity ? `${short(one.limits.velocity)} ${joints[0]?.turn ? "rad/s" : "m/s"}` : null],
      ["effort", one.limits?.effort ? `${short(one.limits.effort)} ${joints[0]?.turn ? "N m" : "N"}` : null],
      ["follows", one.mimic ? `${short(one.mimic[1])} × ${one.mimic[0]}` : null],
      ["found by", one.evidence],
      ["gap", gap],
    ]),
    ...(one.others.length ? [element("details.others", {}, element("summary", {}, `${one.others.length} other lines`), element("ul", {}, one.others.map((text) => element("li", {}, text))))] : []),
  ].filter(Boolean);
}
