// Editing: parts to links, a joint between two parts, axes, limits. The server checks every change before it is written.

import { byId, element } from "./dom.js";
import { ask, live } from "./live.js";
import { app } from "./main.js";
import { fine, internal, shown, unitOf } from "./numbers.js";

const { state } = app;
const trouble = element("p.bad.refusal", { role: "alert" });
let picking = false;
let steps = null;

async function send(name, question) {
  trouble.textContent = "";
  try {
    steps = await ask(name, question);
    showSteps();
    return true;
  } catch (error) {
    trouble.textContent = error.message;
    trouble.scrollIntoView?.({ block: "nearest" });
    return false;
  }
}

const edit = (action, question) => send("edit", { action, ...question });

// Undo and redo.
const undo = element("button.chip", { type: "button", id: "undo", onclick: () => send("undo", {}) }, "Undo");
const redo = element("button.chip", { type: "button", id: "redo", onclick: () => send("redo", {}) }, "Redo");
byId("live").before(element("div", { id: "steps" }, undo, redo));

function showSteps() {
  undo.disabled = !steps?.undo;
  redo.disabled = !steps?.redo;
}

live.push((content) => {
  steps = content.edit ?? steps;
  showSteps();
});
addEventListener("keydown", (event) => {
  if (event.target instanceof HTMLInputElement || !(event.ctrlKey || event.metaKey) || event.key !== "z") return;
  event.preventDefault();
  send(event.shiftKey ? "redo" : "undo", {});
});

const button = (label, onclick, kind = "button.small") => element(kind, { type: "button", onclick }, label);
const field = (label, input) => element("label.field", {}, element("span", {}, label), input);

function choice(options, chosen, attributes = {}) {
  const made = element("select", attributes, options.map(([value, label]) => element("option", { value }, label)));
  if (chosen !== undefined) made.value = chosen;
  return made;
}

// The paths that an edit is about: those picked, else the one selected.
const picked = (selection) => selection.picked ?? [selection.component];

function partTools(selection) {
  if (!selection.component) return [];
  const paths = picked(selection);
  const more = button(picking ? "click the next part" : "pick another part", () => {
    picking = true;
    state.tell("selection");
  });
  const joint = paths.length === 2 ? [jointForm(paths)] : [];
  return [...joint, trouble, element("h3", {}, paths.length > 1 ? "Move these parts" : "Edit"), assignForm(paths, selection), more];
}

function assignForm(paths, selection) {
  const links = [...state.scene.links.map((link) => [link.name, link.name]), ["", "new link …"]];
  const name = element("input", { type: "text", placeholder: "name of the new link", "data-edit": "new-link", hidden: true });
  const link = choice(links, selection.link, { "data-edit": "link", onchange: () => (name.hidden = link.value !== "") });
  const move = button("move to link", () => edit("assign", { paths, link: link.value || name.value }));
  move.dataset.edit = "assign";
  return element("div.form", {}, field("link", link), name, move);
}

// A joint between the first picked part, on the parent link, and the second. If the second one's link hangs on a joint
// already, the new one closes a loop.
function jointForm([a, b]) {
  const parent = linkOf(a);
  const same = linkOf(b) === parent;
  const closes = !same && state.scene.connections.some((one) => !one.closes && one.child === linkOf(b));
  const kinds = closes ? ["revolute", "ball", "prismatic", "fixed"] : ["revolute", "continuous", "prismatic", "fixed"];
  const stem = b.split("/").pop().replace(/[^\w-]+/g, "_").replace(/^_+|_+$/g, "") || "part";
  const child = element("input", { type: "text", value: same ? free(stem) : linkOf(b), "data-edit": "child", disabled: !same });
  const name = element("input", { type: "text", value: free(`${child.value}_joint`), "data-edit": "name" });
  const kind = choice(kinds.map((one) => [one, one]), "revolute", { "data-edit": "kind" });
  const lower = element("input.number", { type: "text", value: "-90", "data-edit": "lower" });
  const upper = element("input.number", { type: "text", value: "90", "data-edit": "upper" });
  const range = element("div.range", {}, lower, " to ", upper, element("span.quiet", { "data-edit": "unit" }, "° (a guess)"));
  const origin = choice([["", "looking for shared axes"]], "", { "data-edit": "origin" });
  let lines = [];
  kind.addEventListener("change", () => {
    rangeField.hidden = closes || !["revolute", "prismatic"].includes(kind.value);
    range.lastChild.textContent = kind.value === "prismatic" ? "mm (a guess)" : "° (a guess)";
  });
  origin.addEventListener("change", () => draw());
  const draw = () => {
    const line = lines[Number(origin.value)];
    if (line && state.selection?.picked) {
      state.selection.line = { component: line.component, point: line.point, direction: line.direction };
      app.view.request();
    }
  };
  ask("between", { a, b }).then((found) => {
    lines = found.lines;
    const options = lines.map((line, i) => [String(i), `${line.chosen ? "" : i ? "" : "ambiguous: "}${line.words}`]);
    origin.replaceChildren(...(options.length ? options : [["", "no shared axis: faces of the links decide"]]).map(([value, label]) => element("option", { value }, label)));
    const chosen = lines.findIndex((line) => line.chosen);
    if (lines.length) origin.value = String(Math.max(0, chosen));
    draw();
  }).catch((error) => (trouble.textContent = error.message));
  const rangeField = field("range", range);
  rangeField.hidden = closes;
  const add = button(closes ? "close the loop here" : "joint here", async () => {
    const line = lines[Number(origin.value)];
    const unit = { turn: kind.value !== "prismatic" };
    const made = await edit(closes ? "add_closure" : "add_joint", {
      name: name.value, kind: kind.value, parent, child: child.value, paths: [b],
      origin: line && origin.value !== "" ? { mate: [a, b], radius: line.radius, near: line.near } : null,
      lower: internal(unit, Number.parseFloat(lower.value)), upper: internal(unit, Number.parseFloat(upper.value)),
    });
    if (made) state.select({ connection: name.value });
  }, "button.small.primary");
  add.dataset.edit = "add";
  return element("div.form", { id: "joint-form" },
    element("h3", {}, closes ? "Close a loop here" : "Joint here"), element("p.quiet", {}, `from ${parent}`),
    field("name", name), field("to link", child), field("type", kind), field("axis", origin), rangeField, add);
}

function linkOf(path) {
  const owner = state.scene.components.find((one) => one.path === path)?.link;
  if (owner) return owner;
  const below = state.scene.components.find((one) => one.link && one.path.startsWith(`${path}/`));
  return below?.link ?? state.scene.links[0].name;
}

function free(name) {
  const taken = new Set([...state.scene.links, ...state.scene.connections, ...state.scene.frames].map((one) => one.name));
  let found = name;
  for (let i = 2; taken.has(found); i++) found = `${name}_${i}`;
  return found;
}

function jointTools(selection) {
  const one = state.find(selection);
  if (!one) return [];
  const tools = [element("h3", {}, "Edit")];
  const acts = [];
  if (one.axis) acts.push(button("flip axis", () => edit("flip", { joint: one.name })));
  acts.push(button(one.closes ? "remove closure" : "remove joint", async () => {
    if (await edit("remove_joint", { joint: one.name })) state.select(null);
  }));
  acts[0].dataset.edit = one.axis ? "flip" : "remove";
  acts.at(-1).dataset.edit = "remove";
  const joint = one.coordinates.length === 1 ? state.tree.joints[state.tree.column.get(one.coordinates[0])] : null;
  if (joint && ["revolute", "prismatic"].includes(one.kind)) tools.push(...limitTools(one, joint));
  tools.push(element("div.acts", {}, acts), trouble);
  return tools;
}

// Two sliders for the limits; the change is written when one is released and both are set.
function limitTools(one, joint) {
  const widest = joint.turn ? Math.PI : Math.max(0.2, 2 * Math.abs(joint.lower ?? 0), 2 * Math.abs(joint.upper ?? 0));
  const known = { lower: joint.lower ?? -widest, upper: joint.upper ?? widest };
  const far = Math.max(widest, Math.abs(known.lower), Math.abs(known.upper));
  return ["lower", "upper"].map((end) => {
    const value = element("span.number.quiet", { "data-end": end }, joint[end] === null ? "not set" : text(joint, known[end]));
    const bar = element("input", { type: "range", min: shown(joint, -far), max: shown(joint, far), step: joint.turn ? 1 : 0.5, "aria-label": `${end} limit`, "data-limit": end,
      oninput: () => {
        known[end] = internal(joint, Number(bar.value));
        value.textContent = text(joint, known[end]);
        joint[end] = known[end];
        app.view.request();
      },
      onchange: () => {
        if (joint.lower !== null && joint.upper !== null) edit("limits", { joint: one.name, ...known });
        else trouble.textContent = "Set the other limit, too.";
      } });
    bar.value = shown(joint, known[end]);
    return element("label.limit", {}, element("span.quiet", {}, end), bar, value);
  });
}

const text = (joint, value) => `${fine(shown(joint, value))} ${unitOf(joint)}`;

state.picking = (selection) => {
  // A click after `pick another part`, or with Ctrl, adds to the parts picked before.
  const before = state.selection;
  const adds = selection?.component && (picking || selection.add) && before?.component;
  picking = false;
  if (!adds) return selection;
  const paths = [...new Set([...picked(before), selection.component])];
  return { ...selection, picked: paths, triangle: null, line: null };
};
app.extras.push((selection) => (selection.connection ? jointTools(selection) : partTools(selection)));
document.body.classList.add("editing");
showSteps();
