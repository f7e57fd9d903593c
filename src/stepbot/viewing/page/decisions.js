// What is left to decide, the most decisive first: each with its places on the robot, and the answers that settle it.

import { edit } from "./changes.js";
import { element, place } from "./dom.js";
import { button, field, submits } from "./form.js";
import { limitLines } from "./limitlines.js";
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
    entries = new Map(open.map((one) => [isLimits(one) ? `limits ${kindOf(one)}` : JSON.stringify(one), one]).map(([key, one]) => [key, former.get(key) ?? (isLimits(one) ? limitLines() : { node: entry(one) })]));
    for (const one of open.filter(isLimits)) entries.get(`limits ${kindOf(one)}`).update(one.keys.map(([, name]) => name));
    place(list, [...entries.values()].map(({ node }) => node));
  });
  return section;
}

const SECTIONS = new Set(["links", "joints", "closures", "frames", "actuators", "sensors", "parts", "materials"]);
const TITLES = { axis: "Does it move like this?", review: "Is this right?", todo: "Not known yet", fused: "Does it move?", motor: "Does a motor drive it?", finding: "Finding" };

const kindOf = ({ keys: [[, name]] }) => state.find({ connection: name })?.kind;
const isLimits = ({ kind, keys: [keys] }) => kind === "todo" && keys?.length === 3 && keys[0] === "joints" && keys[2] === "limits" && state.scene.joint_types[state.find({ connection: keys[1] })?.kind]?.bounded;


// What decides most: the questions of `init --interactive`. Another answer drafts the robot again.
function drafted({ questions }) {
  const answer = (name, value) => act("answer", value, () => confirm("Draft the robot again? What was changed since the draft goes; Undo brings it back.") && edit("answer", { name, value }, () => "drafted again; Undo brings back what was changed before"));
  return element("li.decision", { "data-kind": "question" },
    element("div", {}, element("b", {}, "What decides most")),
    questions.map(({ name, text, drafted, others }) => element("div", { "data-question": name },
      element("p", {}, text, " ", meant(name, drafted)), element("p.quiet.hint", {}, `drafted: ${drafted}`), element("div.acts", {}, others.map((value) => answer(name, value))))),
    element("p.quiet.hint", {}, "Another answer drafts the robot again: decide this first."),
    element("div.acts", {}, act("keep", questions.length > 1 ? "all as drafted" : "as drafted", () => edit("keep_draft", {}))));
}

// The parts that a question is about, to select.
function meant(name, drafted) {
  const names = [...name.split(" + "), drafted];
  const paths = state.scene.components.filter(({ path, product, link }) => link && (names.includes(path) || names.includes(product))).map(({ path }) => path);
  return paths.length ? button("show", () => state.select({ link: state.linkOf(paths[0]), component: paths[0], picked: paths }), "button.place") : null;
}

function entry(one) {
  if (one.kind === "question") return drafted(one);
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
  const many = one.keys.length > 1 ? ` all ${one.keys.length}` : "";
  if (one.kind === "axis") {
    return [
      act("right", many ? `right,${many}` : "right", () => edit("all", async () => ({ edits: await Promise.all(one.keys.map(confirmed)) }))),
      one.keys[0][0] === "joints" ? act("merge", many ? `they do not move,${many}` : "it does not move", () => all(one, ([, joint]) => ({ action: "merge", joint }))) : null,
      act("other", "another axis or type", () => {
        state.select(subject(one.keys[0]));
        const type = document.querySelector("#card select"); // the axis is below it
        type?.focus({ preventScroll: true });
        type?.scrollIntoView({ block: "start" });
      }),
    ];
  }
  if (one.kind === "fused") {
    const parts = one.keys.map(([, part]) => part);
    return [act("free", many ? `they move,${many}` : "it moves", () => edit("free", { parts })), act("drop", many ? `fixed,${many}` : "fixed", () => edit("free", { parts, drop: true }))];
  }
  if (one.kind === "motor") {
    const models = element("datalist", { id: `models-${one.keys[0][1]}` }, one.models.map((value) => element("option", { value })));
    const motor = element("input", { type: "text", list: models.id, value: one.models.length === 1 ? one.models[0] : "", placeholder: one.models[0], "data-decide": "model" });
    const joints = one.keys.map(([, joint]) => joint);
    const drive = act("drive", `drive${many || " it"}`, () => edit("drive", { joints, motor: motor.value.trim() }));
    return [submits(field("motor", motor), drive), models, drive, act("drop", "no motor", () => edit("drive", { joints, drop: true }))];
  }
  if (one.kind === "review") return [asked(one).map(settingField), act("right", "right", () => all(one, (keys) => ({ action: "settle", keys }))), act("other", "change it", () => show(one.keys[0]))];
  if (one.kind === "todo") return one.keys.map(settingField);
  const places = one.keys.length ? one.keys : [["robot"]];
  const bases = one.code === "SB874:base" ? ["fixed", "floating"].map((value) => act(value, value, () => edit("set", { keys: ["base"], value }))) : [];
  return [asked(one).map(settingField), ...bases, one.severity === "error" ? null : act("ignore", many ? `ignore${many}` : "ignore it here", () => edit("all", { edits: places.map((keys) => ({ action: "ignore", keys, code: one.code })) }))];
}

// Values that settle a decision: placeholders of its element, or a density in place of that of the STEP, which can be ignored then.
function asked({ kind, keys: [keys = []], text, help }) {
  const todo = Object.entries((kind === "review" && valueAt(keys)) || {}).filter(([, value]) => value === "todo").map(([key]) => [...keys, key]);
  return [text, ...help].join().includes("`step_density: ") ? [["defaults", "density"], ["step_density"]] : todo;
}

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
