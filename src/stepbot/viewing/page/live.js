// A page with a server behind it: takes new scenes as they come, asks about faces, says when the server has ended.

import { byId, copyable, element } from "./dom.js";
import { app } from "./main.js";
import { millimetres } from "./numbers.js";
import { add, minus, scaled, unit } from "./vectors.js";

const { state } = app;
let revision = -1;

// Functions that hear of every scene event.
export const live = [];

function status(tone, text) {
  Object.assign(byId("live"), { className: tone, textContent: text });
}

export async function ask(name, content) {
  const answer = await fetch(`ask/${name}`, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(content) });
  if (!answer.ok) throw new Error(await answer.text());
  return answer.json();
}

async function take(newer) {
  if (newer === revision) return;
  const answer = await fetch("scene");
  const scene = await answer.json();
  revision = newer;
  state.load(scene);
}

// One after the other: a scene is fetched before what follows it is shown.
let last = Promise.resolve();
const next = (act) => (last = last.then(act).catch((error) => status("bad", error.message)));

// Resolves when the page shows the scene of a revision or a later one.
export const arrive = (newer) => next(() => (newer > revision ? take(newer) : null));

function connect() {
  const events = new EventSource("events");
  const on = (name, act) => events.addEventListener(name, (event) => next(() => act(JSON.parse(event.data))));
  on("scene", async (content) => {
    await take(content.revision);
    live.forEach((heard) => heard(content));
    status("good", "live");
  });
  on("busy", ({ text }) => status("busy", text));
  on("proof", ({ proof, diagnostics, proving }) => {
    Object.assign(state.scene, { proof, diagnostics });
    state.proving = proving;
    state.tell("proof");
  });
  on("converting", ({ stage }) => {
    state.converting = stage;
    state.tell("proof");
  });
  on("findings", ({ diagnostics }) => {
    Object.assign(state.scene, { diagnostics });
    state.tell("proof");
    status("bad", "errors; this is the last good robot");
  });
  events.onerror = () => status("bad", "the server has ended");
}

// Which links overlap where the robot is: one question at a time, the last one for the last pose.
let comparing = false;
let moved = false;

async function compare() {
  moved = true;
  if (comparing) return;
  comparing = true;
  try {
    while (moved) {
      moved = false;
      const { scene } = state;
      const { pairs, why } = await ask("contacts", { q: state.q() });
      if (why) status("bad", `links are not compared: ${why}`);
      if (scene !== state.scene || !pairs) continue;
      state.contacts = pairs.map(({ link_a, link_b, depth, point }) => ({ links: [link_a, link_b], depth, point }));
      state.tell("contacts");
    }
  } catch (error) {
    status("bad", error.message);
  } finally {
    comparing = false;
  }
}

state.listen((what) => {
  if (what === "scene" || what === "motion") compare();
});

// The axis of a clicked face, or of one that meets the clicked edge.
export async function faceOf({ component, triangle, edge }) {
  for (const one of [triangle, ...(edge?.triangles ?? [])]) {
    const face = await ask("face", { component, triangle: one });
    if (face.origin) return face;
  }
  if (!edge) return { why: "This face has no axis." };
  return edge.isCurved ? { why: "This edge is curved, and no round face meets it." } : straight(component, edge.ends);
}

// The line of a straight edge, as an origin by numbers and an axis, in the frame of its part.
function straight(component, [from, to]) {
  const { quoted } = state.scene.components.find(({ path }) => path === component);
  const along = unit(minus(to, from));
  const main = [0, 1, 2].find((i) => Math.abs(along[i]) > 1 - 1e-6);
  const direction = main === undefined ? along.map((value) => Number(value.toFixed(6))) : [0, 1, 2].map((i) => (i === main ? Math.sign(along[i]) : 0));
  const point = scaled(add(from, to), 0.5);
  const middle = point.map((value) => `${Number((1e3 * value).toFixed(3))} mm`);
  const axis = main === undefined ? `[${direction.join(", ")}]` : `${direction[main] < 0 ? "-" : ""}${"xyz"[main]}`;
  return { kind: "straight edge", origin: `{xyz: [${middle.join(", ")}], relative_to: ${quoted}}`, axis, line: { component, point, direction } };
}

// What the axis of a clicked face is called in a sidecar.
state.listen(async (what) => {
  const { selection } = state;
  if (what !== "selection" || !selection?.triangle || !selection.component || selection.face) return;
  selection.face = {};
  try {
    const face = await faceOf(selection);
    if (state.selection !== selection) return;
    Object.assign(selection, { face, line: face.line });
    state.tell("selection");
  } catch (error) {
    status("bad", error.message);
  }
});

export function faceCard(selection) {
  const { face } = selection;
  if (!selection.triangle || !face) return [];
  if (!face.origin) return face.why ? [element("p.quiet", {}, face.why)] : [];
  const words = face.axis ? face.kind : `${face.kind} face${face.radius ? `, radius ${millimetres(face.radius)}` : ""}`;
  return [element("p.quiet", {}, `${words}. Its axis:`), copyable(`origin: ${face.origin}`, { id: "origin" }), ...(face.axis ? [copyable(`axis: ${face.axis}`, { id: "axis" })] : [])];
}

app.extras.push(faceCard);
status("busy", "loading");
connect();
