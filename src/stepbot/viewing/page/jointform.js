// A joint between two parts that were picked, or a closure.

import { edit, say } from "./changes.js";
import { element } from "./dom.js";
import { button, choice, field, mark, options, submits } from "./form.js";
import { ask } from "./live.js";
import { app } from "./main.js";
import { mistyped, parsed } from "./numbers.js";

const { state } = app;

const FORMS = { mate: (a, b) => ({ mate: [a, b] }), auto: () => ({ auto: true }), second: (a, b) => ({ axis_of: b }), first: (a) => ({ axis_of: a }) };
const EXAMPLES = { pitch: "2 mm/rev", axis2: "x" };
const PARTS = { second: (a, b) => b, first: (a) => a };

// Between the first picked part, on the parent link, and the second. That becomes a link of its own, or the joint
// closes a loop to the link that it is in.
export function jointForm([a, b]) {
  const [parent, other] = [state.linkOf(a), state.linkOf(b)];
  const isRoot = !state.scene.connections.some((one) => !one.closes && one.child === other);
  const target = choice([["", "a new link"], ...(other === parent ? [] : [[other, `${other}, closing a loop`]])], isRoot || other === parent ? "" : other, { "data-edit": "target" });
  const child = element("input", { type: "text", value: state.free(nameOf(b)), "data-edit": "child" });
  const name = element("input", { type: "text", "data-edit": "name" });
  const kind = choice([], undefined, { "data-edit": "kind" });
  const needed = neededField();
  const lower = element("input.number", { type: "text", value: "-90", "data-edit": "lower" });
  const upper = element("input.number", { type: "text", value: "90", "data-edit": "upper" });
  const unit = element("span.quiet", { "data-edit": "unit" });
  const range = field("range", element("div.range", {}, lower, " to ", upper, unit));
  const origin = choice([["", "looking for shared axes"]], "", { "data-edit": "origin" });
  const title = element("h3");
  const add = button("", make, "button.small.primary");
  add.dataset.edit = "add";
  const childField = field("its name", child);
  const closes = () => target.value !== "";
  const isLimited = () => !closes() && state.scene.joint_types[kind.value]?.bounded;
  const words = element("p.quiet.hint");
  let lines = [];

  function retarget() {
    title.textContent = closes() ? "Close a loop here" : "Joint here";
    add.textContent = closes() ? "close the loop here" : "joint here";
    childField.hidden = closes();
    name.value = state.free(`${closes() ? other : child.value}_joint`);
    options(kind, state.kinds(closes()).map((one) => [one, one]), "revolute");
    retype();
  }
  function retype() {
    range.hidden = !isLimited();
    needed.show(kind.value);
    unit.textContent = kind.value === "prismatic" ? "mm (a guess)" : "° (a guess)";
  }
  function draw() {
    const line = lines[Number(origin.value)];
    words.textContent = line?.words ?? "";
    if (!line || !state.selection?.picked) return;
    state.selection.line = { component: line.component, point: line.point, direction: line.direction };
    app.view.request();
  }
  async function make() {
    const joint = { turn: kind.value !== "prismatic" };
    const [low, high] = [lower, upper].map((box) => parsed(joint, box.value));
    for (const [box, value] of [[lower, low], [upper, high]]) mark(box, isLimited() && (value === null || (low !== null && high !== null && low >= high)));
    const wrong = [[lower, low], [upper, high]].find(([, value]) => value === null);
    if (isLimited() && wrong) return say(mistyped(joint, wrong[0].value));
    const line = origin.value === "" ? null : lines[Number(origin.value)];
    const made = await edit(closes() ? "add_closure" : "add_joint", {
      name: name.value, kind: kind.value, needed: needed.value(), parent, child: closes() ? other : child.value, paths: [b],
      origin: line ? { ...FORMS[line.form](a, b), radius: line.radius, near: line.near } : null,
      lower: low, upper: high,
    });
    if (made) state.select({ connection: name.value });
  }

  const alone = ({ form }) => (form in PARTS ? `of ${nameOf(PARTS[form](a, b))} alone, ` : "");
  target.addEventListener("change", retarget);
  kind.addEventListener("change", retype);
  origin.addEventListener("change", draw);
  ask("between", { a, b }).then((found) => {
    lines = found.lines;
    const chosen = lines.findIndex((line) => line.chosen);
    if (lines.length) options(origin, lines.map((line, i) => [String(i), `${alone(line)}${line.words}`]), String(Math.max(0, chosen)));
    else options(origin, [["", "no axis: neither part has a round face"]], "");
    if (lines.length && chosen < 0) origin.before(element("span.warn", {}, "ambiguous: choose one"));
    draw();
  }).catch((error) => say(error.message));
  retarget();
  return submits(element("div.form", { id: "joint-form" }, title, element("p.quiet", {}, `from ${parent}`),
    field("to", target), childField, field("name", name), field("type", kind), needed.node, element("div.field", {}, element("span", {}, "axis"), element("div", {}, origin)), words, range, add), add);
}

// What a type needs beside its axis, as the sidecar writes it: the pitch of a screw.
export function neededField() {
  const box = element("input", { type: "text", "data-edit": "needed" });
  const label = element("span");
  const node = element("label.field", { hidden: true }, label, box);
  const show = (kind) => {
    const key = state.scene.joint_types[kind]?.needs ?? "";
    [node.hidden, label.textContent, box.placeholder] = [!key, key, EXAMPLES[key] ?? ""];
    return !node.hidden;
  };
  return { node, box, show, value: () => (node.hidden ? null : box.value) };
}

// The last name of a path, as a name of a link.
export const nameOf = (path) => path.split("/").pop().replace(/[^\w-]+/g, "_").replace(/^_+|_+$/g, "") || "part";
