// The Convert button: runs `stepbot convert`, says how far it is, and where its files are.

import { copyable, element, place } from "./dom.js";
import { ask } from "./live.js";
import { app } from "./main.js";

const { state } = app;
let result = null;
let failure = "";
const press = element("button.small.primary", { type: "button", id: "convert", onclick: run }, "Convert");

async function run() {
  press.disabled = true;
  [result, failure, state.converting] = [null, "", "start"];
  state.tell("proof");
  try {
    result = await ask("convert", {});
  } catch (error) {
    failure = error.message;
  }
  state.converting = null;
  press.disabled = false;
  state.tell("proof");
}

// How the robot is loaded where most people load it: a line for each program, with the file that it takes.
function loading({ folder, files }) {
  const lines = [
    [[".scene.xml", ".xml"], (path) => `python -m mujoco.viewer --mjcf="${path}"`],
    [[".urdf"], (path) => `pybullet.loadURDF("${path}")`],
    [[".world.sdf"], (path) => `gz sim "${path}"`], // it opens no file without a world
  ];
  const plain = files.filter((name) => !name.includes("/"));
  return lines.flatMap(([suffixes, line]) => {
    const [name] = suffixes.flatMap((suffix) => plain.filter((one) => one.endsWith(suffix)));
    return name ? [copyable(line(`${folder}/${name}`))] : [];
  });
}

function outcome() {
  if (state.converting) return [element("p.warn", { role: "status" }, `Converting: ${state.converting} …`)];
  if (failure) return [element("p.bad", { role: "alert" }, failure)];
  if (!result) return [];
  const { folder, files, written } = result;
  if (!files.length) return [element("p.bad", { role: "alert" }, "Nothing was written; Findings says why.")];
  const words = written ? ["p.good", "✓ Converted and proven; the files are in"] : ["p.bad", "✗ The proof failed; the files, for inspection, are in"];
  const links = files.filter((name) => !name.includes("/")).flatMap((name) => [element("a", { href: `files/${encodeURIComponent(name)}`, ...(name.endsWith(".html") ? { target: "_blank" } : { download: name }) }, name), " "]);
  return [element(words[0], { role: "status" }, words[1]), copyable(folder), element("p", {}, links), ...(written ? loading(result) : [])];
}

const node = element("div", { id: "converted" }, press);

export function converted() {
  place(node, [press, ...outcome()]);
  return [node];
}
