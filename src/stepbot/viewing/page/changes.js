// Sends edits to the server, which checks each before it is written, and shows what came of them.

import { byId, element } from "./dom.js";
import { isTyping } from "./layout.js";
import { arrive, ask, live } from "./live.js";
import { app } from "./main.js";

const { state } = app;
const words = element("span");
const close = element("button.close", { type: "button", "aria-label": "dismiss", onclick: () => say("") }, "×");
const notice = element("div", { id: "notice", role: "status", hidden: true }, words, close);
byId("stage").append(notice);
let steps = null;
let checking = 0;

// A message over the robot, which moves nothing in the card; tones: bad, good, busy.
export function say(text, tone = "bad") {
  notice.hidden = !text;
  notice.className = tone;
  words.textContent = text;
}

// One change after the other, each with the scene of the one before it on the page. A question that is a function is
// asked for then: names may have changed. `words` returns what to say of a change that was made. Resolves to whether it was.
let last = Promise.resolve();
export function send(name, question, words = () => "saved") {
  checking += 1;
  document.body.classList.add("checking");
  say("checking the change …", "busy");
  last = last.then(() => answered(name, question, words));
  return last;
}

async function answered(name, question, words) {
  try {
    const { revision, ...now } = await ask(name, typeof question === "function" ? await question() : question);
    steps = now;
    await arrive(revision);
    say(words(), "good");
    return true;
  } catch (error) {
    say(error.message);
    return false;
  } finally {
    checking -= 1;
    document.body.classList.toggle("checking", checking > 0);
    showSteps();
  }
}

// What the next click is for: `take` gets what was clicked and returns what is selected then. Esc ends it.
export function nextClick(words, take) {
  say(words, "busy");
  state.waiting = (selection) => {
    state.waiting = null;
    say("");
    return selection ? take(selection) : state.selection;
  };
}

export const edit = (action, question, words) => send("edit", async () => ({ action, ...(typeof question === "function" ? await question() : question) }), words);

// A new name for a joint or link; what is selected stays selected under it. `from` is a function.
export async function rename(what, from, to) {
  let pair;
  const done = await edit("rename", () => {
    pair = [from(), to];
    state.renames.push(pair);
    return { what, from: pair[0], to };
  });
  if (!done) state.renames = state.renames.filter((one) => one !== pair);
  return done;
}

const undo = element("button.chip", { type: "button", id: "undo", title: "Ctrl-Z", onclick: () => send("undo", {}) }, "Undo");
const redo = element("button.chip", { type: "button", id: "redo", title: "Shift-Ctrl-Z", onclick: () => send("redo", {}) }, "Redo");
byId("live").before(element("div", { id: "steps" }, undo, redo));

function showSteps() {
  undo.disabled = !steps?.undo;
  redo.disabled = !steps?.redo;
}

live.push((content) => {
  steps = content.edit ?? steps;
  showSteps();
});

// What was said about a part or joint does not stay when another one is selected.
let about = null;
state.listen((what) => {
  if (what !== "selection") return;
  const { selection } = state;
  const now = selection && (selection.connection ?? JSON.stringify(selection.picked ?? selection.component ?? selection.link));
  if (now !== about && !checking && notice.className === "bad") say("");
  about = now;
});

app.keys.push(["Ctrl-Z", "undo; with shift: redo"]);
addEventListener("keydown", (event) => {
  if (isTyping(event) || !(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z") return;
  event.preventDefault();
  send(event.shiftKey ? "redo" : "undo", {});
});
showSteps();
