// Puts the page together.

import { card } from "./card.js";
import { byId, element } from "./dom.js";
import { findingsPanel } from "./findings.js";
import { jointsPanel } from "./joints.js";
import { dock, shortcuts, tabs } from "./layout.js";
import { mass } from "./numbers.js";
import { partsPanel } from "./parts.js";
import { proofPanel } from "./proof.js";
import { State } from "./state.js";
import { View } from "./view.js";

const CHIPS = [
  ["joints", "Joints"], ["names", "Names"], ["frames", "Frames"], ["masses", "Masses"],
  ["collisions", "Collision"], ["byLink", "Colour by link"],
];
const DIRECTIONS = [["Front", 0, 0], ["Side", -Math.PI / 2, 0], ["Top", -Math.PI / 2, Math.PI / 2]];

function toolbar(state, view) {
  const chips = CHIPS.map(([name, label]) => {
    const chip = element("button.chip", { type: "button", "data-show": name, onclick: () => state.set(name, !state.show[name]) }, label);
    state.listen(() => chip.setAttribute("aria-pressed", String(state.show[name])));
    return chip;
  });
  const looks = DIRECTIONS.map(([label, azimuth, elevation]) => element("button.chip", { type: "button", onclick: () => {
    view.camera.look(azimuth, Math.min(elevation, 1.5533));
    view.fit();
  } }, label));
  byId("toolbar").append(...chips, element("span.space"), element("button.chip", { type: "button", id: "fit", onclick: () => view.fit() }, "Fit"), ...looks);
}

function badge(state, id) {
  const { scene } = state;
  if (id === "joints") {
    const doubts = scene.connections.filter((one) => one.doubt).length;
    return { textContent: doubts ? `? ${doubts}` : "", className: "count warn" };
  }
  if (id === "findings") {
    const errors = scene.diagnostics.filter((one) => one.severity === "error").length;
    return { textContent: String(scene.diagnostics.length || ""), className: errors ? "count bad" : "count" };
  }
  const failed = scene.proof?.rows.filter((row) => row.status === "failed").length ?? 0;
  if (id === "proof" && failed) return { textContent: String(failed), className: "count bad" };
  const overlapping = id === "proof" ? state.overlapping().length : 0;
  return { textContent: String(overlapping || ""), className: "count warn", title: overlapping ? "pairs of links that overlap" : "" };
}

function title(state) {
  const { scene } = state;
  const of = (number, noun) => `${number} ${noun}${number === 1 ? "" : "s"}`;
  const freedom = scene.motion.driven.length;
  byId("name").textContent = scene.name;
  byId("facts").textContent = [
    scene.source, of(scene.links.length, "link"), `${freedom} ${freedom === 1 ? "degree" : "degrees"} of freedom`,
    scene.total.mass > 0 ? mass(scene.total.mass) : "",
  ].filter(Boolean).join(" · ");
}

function start() {
  const state = new State();
  let view;
  try {
    view = new View(state, byId("canvas"), byId("tags"));
  } catch (error) {
    byId("trouble").textContent = `The robot cannot be drawn: ${error.message}.`;
    byId("trouble").hidden = false;
    throw error;
  }
  toolbar(state, view);
  const toggle = dock();
  const extras = [];
  card(state, byId("card"), (selection) => extras.flatMap((extra) => extra(selection)));
  const { add, open, counts } = tabs();
  add("joints", "Joints", jointsPanel(state));
  add("parts", "Parts", partsPanel(state));
  add("proof", "Proof", proofPanel(state));
  add("findings", "Findings", findingsPanel(state));
  state.listen((what) => {
    if (what === "scene") title(state);
    if (["scene", "proof", "contacts"].includes(what)) for (const id of ["joints", "proof", "findings"]) Object.assign(counts.get(id), badge(state, id));
  });
  addEventListener("keydown", (event) => {
    if (event.key === "Escape" && !document.querySelector("dialog[open]")) state.select(null);
  });
  const step = (by) => () => {
    const names = state.scene.connections.map(({ name }) => name);
    const at = names.indexOf(state.selection?.connection);
    const to = at < 0 ? Math.min(by, 0) : at + by;
    if (names.length) state.select({ connection: names.at(to % names.length) });
  };
  const keys = [
    ["f", "fit the robot", () => view.fit()], ["p", "show or hide the panels", toggle],
    ["j", "next joint", step(1)], ["k", "joint before", step(-1)],
    ["arrows, + -", "in the 3D view: turn the robot, zoom; with shift: move it"],
    ["Esc", "select nothing"],
  ];
  shortcuts(keys);
  // For tests, and for people at the console.
  globalThis.stepbot = { state, view };
  const text = byId("scene").textContent.trim();
  if (text) state.load(JSON.parse(text));
  return { state, view, extras, keys, add, open, counts };
}

export const app = start();
