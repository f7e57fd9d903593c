// What the sidecar says: its values, the lines that they are on, and what is left to decide; asked for after each scene.

import { ask } from "./live.js";
import { app } from "./main.js";

const { state } = app;
state.written = null;
state.vocabulary = null;

let asked = 0;
state.listen(async (what) => {
  if (what !== "scene") return;
  const mine = (asked += 1);
  const { scene } = state;
  const found = await Promise.all([ask("written", {}), state.vocabulary ?? ask("vocabulary", {})]).catch(() => null); // with errors in the file the last good one stays
  if (!found || mine !== asked) return;
  [state.written, state.vocabulary] = found;
  state.writtenOf = scene;
  state.tell("written");
});

// The value at keys; undefined for none.
export const valueAt = (keys) => keys.reduce((at, key) => at?.[key], state.written?.data);

// The module that a link or joint is in, if it is edited in that module's file; undefined for one of this file.
export function moduleOf({ link, connection }) {
  const { data, modules } = state.written ?? {};
  const name = connection ? state.find({ connection })?.child : link;
  const isOwn = connection ? (data?.joints?.[connection] ?? data?.closures?.[connection]) : data?.links?.[link];
  return isOwn ? undefined : modules?.findLast(({ links }) => links.includes(name));
}

// Names of elements of the robot, as a page selects them: what the keys of the sidecar are about.
export function subject([section, name] = []) {
  if (section === "joints" || section === "closures") return { connection: name };
  if (section === "links") return { link: name };
  const { data } = state.written;
  const one = data[section]?.[name];
  if (section === "actuators") return { connection: one?.joint ?? name };
  if (section === "frames" || section === "sensors") return one?.link ? { link: one.link } : null;
  const part = section === "parts" && state.scene.components.find(({ path, product }) => path === name || name === `**/${product}`);
  return part ? { link: state.linkOf(part.path), component: part.path } : null;
}

// Lines of the file from the key to the last value below it, with their numbers.
export function excerpt(keys) {
  const place = state.written?.places.find(([one]) => one.length === keys.length && one.every((key, i) => key === keys[i]));
  if (!place) return "";
  const [, first, last] = place;
  return state.written.lines.slice(first - 1, last).map((line, i) => `${String(first + i).padStart(4)}  ${line}`).join("\n");
}
