// Joints without limits, one line each: both ends are typed.

import { edit, say } from "./changes.js";
import { element, place } from "./dom.js";
import { mark } from "./form.js";
import { app } from "./main.js";
import { mistyped, parsed, unitOf } from "./numbers.js";

const { state } = app;
const ENDS = ["lower", "upper"];

// A line that stays while others come and go: it may have the focus, or half of its limits.
export function limitLines() {
  const list = element("div.form");
  const node = element("li.decision", { "data-kind": "todo" }, element("div", {}, element("b", {}, "How far does it move?")), list);
  let lines = new Map();
  const update = (names) => {
    lines = new Map(names.map((name) => [name, lines.get(name) ?? line(name)]));
    place(list, [...lines.values()]);
  };
  return { node, update };
}

function line(name) {
  const one = state.find({ connection: name });
  const joint = state.tree.joints[state.tree.column.get(one.coordinates[0])];
  const boxes = ENDS.map((end) => element("input.number", { type: "text", placeholder: end, "aria-label": `${end} limit of ${name} [${unitOf(joint)}]`, "data-limits": `${name} ${end}`, onchange: () => write() }));
  async function write() {
    const typed = boxes.filter((box) => box.value.trim());
    const wrong = typed.find((box) => parsed(joint, box.value) === null);
    for (const box of boxes) mark(box, box === wrong);
    if (wrong) say(mistyped(joint, wrong.value));
    else if (typed.length === 2) {
      const [lower, upper] = boxes.map((box) => parsed(joint, box.value));
      const done = await edit("limits", { joint: name, lower, upper });
      for (const box of boxes) mark(box, !done);
    }
  }
  return element("div.limits", {},
    element("button.place", { type: "button", tabindex: -1, onclick: () => state.select({ connection: name }) }, name),
    element("div.range", {}, boxes[0], " to ", boxes[1], unitOf(joint)));
}
