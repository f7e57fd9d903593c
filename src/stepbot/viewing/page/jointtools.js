// Edits of one joint or closure: its name, type, axis, limits.

import { edit, say } from "./changes.js";
import { element } from "./dom.js";
import { button, choice, field, options } from "./form.js";
import { ask } from "./live.js";
import { app } from "./main.js";
import { fine, internal, mistyped, parsed, shown, unitOf } from "./numbers.js";

const { state } = app;
const KINDS = ["revolute", "continuous", "prismatic", "fixed"];

export function jointTools(selection) {
  const one = state.find(selection);
  if (!one) return [];
  const acts = [];
  if (one.axis) acts.push(act("flip", "flip axis", () => edit("flip", { joint: one.name })));
  acts.push(act("remove", one.closes ? "remove closure" : "remove joint", async () => {
    if (await edit("remove_joint", { joint: one.name })) state.select(null);
  }));
  const joint = one.coordinates.length === 1 ? state.tree.joints[state.tree.column.get(one.coordinates[0])] : null;
  const limited = joint && ["revolute", "prismatic"].includes(one.kind);
  return [
    element("h3", {}, "Edit"),
    element("div.form", {}, nameField("joint", one.name), ...(one.closes ? [] : [nameField("link", one.child), typeField(one)]), ...lineField(one)),
    ...(limited ? limitTools(one, joint) : []),
    element("div.acts", {}, acts),
  ];
}

function act(name, label, onclick) {
  const made = button(label, onclick);
  made.dataset.edit = name;
  return made;
}

// The name of the joint, or of its child link; all references to it follow.
function nameField(what, former) {
  const box = element("input", { type: "text", value: former, "data-edit": `${what}-name`, onchange: async () => {
    const name = box.value.trim();
    if (name === former) return;
    const done = await edit("rename", { what, from: former, to: name });
    if (!done) box.value = former;
    else if (what === "joint") state.select({ connection: name });
  } });
  return field(what === "joint" ? "name" : "child link", box);
}

function typeField(one) {
  const kinds = KINDS.includes(one.kind) ? KINDS : [one.kind, ...KINDS];
  const select = choice(kinds.map((kind) => [kind, kind]), one.kind, { "data-edit": "type", onchange: async () => {
    if (!(await edit("type", { joint: one.name, kind: select.value }))) select.value = one.kind;
  } });
  return field("type", select);
}

// The lines that could be its axis: choosing one writes the origin.
function lineField(one) {
  if (!one.axis) return [];
  let lines = [];
  let current = "";
  const select = choice([["", "looking for axes"]], "", { "data-edit": "origin", onchange: async () => {
    const { radius, near } = lines[Number(select.value)];
    if (!(await edit("origin", { joint: one.name, radius, near }))) select.value = current;
  } });
  const words = element("p.quiet.hint");
  const made = element("div.form", { hidden: true }, field("axis", select), words); // shown if there is a choice
  ask("lines", { joint: one.name }).then((found) => {
    lines = found.lines;
    current = String(lines.findIndex((line) => line.chosen));
    options(select, lines.map((line, i) => [String(i), line.words]), current);
    words.textContent = lines[Number(current)]?.words ?? "";
    made.hidden = lines.length < 2;
  }).catch((error) => say(error.message));
  return [made];
}

// A slider and a box for each limit; the change is written when one is released and both are set.
function limitTools(one, joint) {
  const driven = state.scene.motion.driven.find(({ name }) => name === joint.name);
  const travel = driven ? driven.range.map(Math.abs) : [0.2];
  const widest = joint.turn ? Math.PI : Math.max(...travel, 2 * Math.abs(joint.lower ?? 0), 2 * Math.abs(joint.upper ?? 0));
  const known = { lower: joint.lower ?? -widest, upper: joint.upper ?? widest };
  const far = Math.max(widest, Math.abs(known.lower), Math.abs(known.upper));
  const hint = element("p.quiet.hint", { hidden: true }, "Set the other limit, too.");
  const rows = ["lower", "upper"].map((end) => {
    const text = () => (joint[end] === null ? "not set" : `${fine(shown(joint, known[end]))} ${unitOf(joint)}`);
    const take = (value) => {
      known[end] = joint[end] = value;
      box.value = text();
      bar.value = shown(joint, value);
      app.view.request();
    };
    const write = () => {
      const whole = joint.lower !== null && joint.upper !== null;
      hint.hidden = whole;
      if (whole) edit("limits", { joint: one.name, ...known });
    };
    const box = element("input.number", { type: "text", "aria-label": `${end} limit [${unitOf(joint)}]`, "data-end": end, onchange: () => {
      const value = parsed(joint, box.value);
      if (value === null) {
        say(mistyped(joint, box.value));
        box.value = text();
        return;
      }
      take(value);
      write();
    } });
    const bar = element("input", { type: "range", min: shown(joint, -far), max: shown(joint, far), step: joint.turn ? 1 : 0.5, "aria-label": `${end} limit`, "data-limit": end,
      oninput: () => take(internal(joint, Number(bar.value))), onchange: write });
    bar.value = shown(joint, known[end]);
    box.value = text();
    return element("div.limit", {}, element("span.quiet", {}, end), bar, box);
  });
  return [...rows, hint];
}
