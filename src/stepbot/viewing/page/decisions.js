// What is left to decide, the most decisive first: each with its places on the robot, and the answers that settle it.

import { edit } from "./changes.js";
import { element, place } from "./dom.js";
import { button } from "./form.js";
import { ask } from "./live.js";
import { app } from "./main.js";
import { settingField } from "./settings.js";
import { subject, valueAt } from "./written.js";

const { state } = app;

export function decisionsPanel() {
  const section = element("section");
  const bar = element("progress", { "aria-label": "decided", value: 0 });
  const words = element("span.quiet");
  const list = element("ol");
  section.append(element("div.line.progress", {}, bar, words), list);
  let entries = new Map();
  let most = 0; // decisions that were open at once
  state.listen((what) => {
    if (what !== "written") return;
    const open = state.written.decisions;
    most = Math.max(most, open.length);
    Object.assign(bar, { max: Math.max(1, most), value: most ? most - open.length : 1 });
    words.textContent = open.length ? `${most - open.length} of ${most} decided` : "Nothing is left to decide.";
    // An entry that stays keeps its node: it may have the focus, or a press of a button in it is not over.
    const former = entries;
    entries = new Map(open.map((one) => [JSON.stringify(one), one]).map(([key, one]) => [key, former.get(key) ?? entry(one)]));
    place(list, [...entries.values()]);
  });
  return section;
}

const SECTIONS = new Set(["links", "joints", "closures", "frames", "actuators", "sensors", "parts", "materials"]);
const TITLES = { axis: "Does it move like this?", review: "Is this right?", todo: "Not known yet", finding: "Finding" };

function entry(one) {
  const places = one.keys.map((keys) => {
    const there = subject(keys);
    const label = keys.length > 1 && SECTIONS.has(keys[0]) ? keys[1] : keys[0];
    return there ? button(label, () => state.select(there), "button.place") : element("span.quiet", {}, label);
  });
  const title = one.kind === "finding" ? `${one.severity} ${one.code}` : TITLES[one.kind];
  return element("li.decision", { "data-kind": one.kind, "data-code": one.code || null },
    element("div", {}, element("b", {}, title), " ", places.flatMap((place) => [place, " "])),
    element("p", {}, one.text), one.help.map((text) => element("p.quiet.hint", {}, text)),
    element("div.acts", {}, answers(one)));
}

const all = (one, question, words) => edit("all", { edits: one.keys.map(question) }, words);

// The axis of a joint as it is: the line that it lies on is selected explicitly.
async function confirmed([, joint]) {
  const { radius, near } = (await ask("lines", { joint })).lines.find(({ chosen }) => chosen) ?? {};
  return { action: "confirm", joint, radius, near };
}

function answers(one) {
  const many = one.keys.length > 1 ? `, all ${one.keys.length}` : "";
  if (one.kind === "axis") {
    return [
      act("right", `right${many}`, () => edit("all", async () => ({ edits: await Promise.all(one.keys.map(confirmed)) }))),
      one.keys[0][0] === "joints" ? act("merge", `it does not move${many}`, () => all(one, ([, joint]) => ({ action: "merge", joint }))) : null,
      act("other", "another axis or type", () => state.select(subject(one.keys[0]))),
    ];
  }
  if (one.kind === "review") return [todo(one.keys[0]).map(settingField), act("right", "right", () => all(one, (keys) => ({ action: "settle", keys }))), act("other", "change it", () => show(one.keys[0]))];
  if (one.kind === "todo") return settingField(one.keys[0]);
  return one.severity === "error" ? [] : [act("ignore", "ignore it here", () => edit("ignore", { keys: one.keys[0] ?? ["robot"], code: one.code }))];
}

// Placeholders of an element.
const todo = (keys) => Object.entries(valueAt(keys) ?? {}).filter(([, value]) => value === "todo").map(([key]) => [...keys, key]);

function show(keys) {
  const there = subject(keys);
  if (there) state.select(there);
  else app.reveal(keys[0]);
}

function act(name, label, onclick) {
  const made = button(label, onclick);
  made.dataset.decide = name;
  return made;
}
