// A form for any element of the sidecar, made from its JSON schema: one field for each key, one edit for each change.

import { edit } from "./changes.js";
import { element } from "./dom.js";
import { bound, button, choice, field, submits } from "./form.js";
import { app } from "./main.js";
import { across, anglesOf, apply, cross, dot, inverse, minus, norm, scaled, turn, turnBack, unit } from "./vectors.js";
import { excerpt, valueAt } from "./written.js";

const { state } = app;
const SHORT = /^-?[\w°%][\w .*/^°%+-]*$/; // texts that need no quotes in a field

// --- schema ---

function resolved(schema) {
  let found = schema ?? {};
  while (found.$ref) found = { ...state.vocabulary.schema.$defs[found.$ref.split("/").pop()], ...found, $ref: undefined };
  return found;
}

const alternatives = (schema) => (schema.properties ? [schema] : (schema.anyOf ?? [schema]).map(resolved));

// The one mapping that a value can be, if the only other alternative is a placeholder.
function mappingOf(schema) {
  const found = alternatives(resolved(schema));
  const mappings = found.filter((one) => one.properties);
  return mappings.length === 1 && found.every((one) => one.properties || one.const === "todo") ? mappings[0] : null;
}

export function schemaAt(keys) {
  return resolved(keys.reduce((at, key) => {
    const one = alternatives(resolved(at)).find(({ properties, additionalProperties }) => properties || additionalProperties) ?? {};
    return one.properties?.[key] ?? one.additionalProperties;
  }, state.vocabulary.schema));
}

// Words that a value can be.
const wordsOf = (schema) => alternatives(schema).flatMap((one) => one.enum ?? (one.const === undefined ? [] : [one.const]));
const isText = (schema) => alternatives(schema).every((one) => one.type === "string" && !one.enum && one.const === undefined && !/\\d/.test(one.pattern ?? ""));

// --- values ---

export function flow(value) {
  if (value === undefined || value === null) return "";
  if (Array.isArray(value)) return `[${value.map(flow).join(", ")}]`;
  if (typeof value === "object") return `{${Object.entries(value).map(([key, one]) => `${flow(key)}: ${flow(one)}`).join(", ")}}`;
  return typeof value === "string" && !SHORT.test(value) ? JSON.stringify(value) : String(value);
}

// What a field may suggest: names in the robot, materials, motors.
function suggestions(key, schema) {
  const { scene, vocabulary, written } = state;
  const names = (list) => list.map(({ name }) => [name, ""]);
  switch (key) {
    case "density": return Object.entries(vocabulary.densities).map(([name, density]) => [`${density} kg/m^3`, name]);
    case "material": return Object.keys(written.data.materials ?? {}).map((name) => [name, ""]);
    case "motor": return [...new Set([...Object.keys(written.data.motors ?? {}), ...vocabulary.motors])].map((name) => [name, ""]);
    case "joint": return names(scene.connections.filter(({ closes }) => !closes));
    case "link": case "link_a": case "link_b": case "parent": case "child": return names(scene.links);
    default: return wordsOf(schema).map((word) => [String(word), ""]);
  }
}

let lists = 0;

// A field for the value at keys. `draft` takes the place of the file for an element that is not in it yet.
export function valueField(keys, draft = null) {
  const key = keys.at(-1);
  const schema = schemaAt(keys);
  const words = wordsOf(schema);
  const isWord = words.length > 0 && alternatives(schema).every((one) => one.enum || one.const !== undefined);
  const isFlag = schema.type === "boolean";
  const usual = schema.default === undefined ? "" : flow(schema.default);
  const name = { "data-set": keys.join("."), title: schema.description ?? "" };
  let input;
  let list = null;
  if (isWord || isFlag) {
    const entries = (isFlag ? ["true", "false"] : words.map(String)).map((word) => [word, word]);
    input = choice([["", usual ? `default: ${usual}` : ""], ...entries], "", name);
  } else {
    input = element("input", { type: "text", placeholder: usual || (schema.examples ? `such as ${flow(schema.examples[0])}` : ""), ...name });
    const offered = suggestions(key, schema);
    if (offered.length) {
      list = element("datalist", { id: `offered-${(lists += 1)}` }, offered.map(([value, label]) => element("option", { value }, label)));
      input.setAttribute("list", list.id);
    }
  }
  const plain = isText(schema);
  const question = (typed) => {
    const text = typed.trim();
    return plain || (isWord && !isFlag) || text.startsWith("#") ? { action: "set", keys, value: text } : { action: "set", keys, text };
  };
  const read = () => {
    const value = valueAt(keys);
    if (value === "todo" && !isWord) return ""; // its field waits for a value
    return plain && value !== undefined ? String(value) : flow(value);
  };
  const update = draft ? () => {} : bound(input, read, (typed) => edit("set", question(typed)));
  update();
  return { node: [field(key.replaceAll("_", " "), input), list], update, question: () => question(input.value), isSet: () => input.value.trim() !== "", input };
}

// --- forms ---

// The field for one value alone.
export const settingField = (keys) => valueField(keys).node;

// Fields for all keys of the element at `keys`, except some; settings of their own are folded.
export function settings(keys, except = []) {
  const parts = Object.keys(mappingOf(schemaAt(keys))?.properties ?? {}).filter((key) => !except.includes(key)).map((key) => {
    const below = [...keys, key];
    if (!mappingOf(schemaAt(below))) return valueField(below);
    const inner = settings(below);
    const node = element("details", { "data-group": below.join("."), open: typeof valueAt(below) === "object" }, element("summary", {}, key.replaceAll("_", " ")), inner.node);
    return { node, update: inner.update };
  });
  return { node: element("div.form", {}, parts.map(({ node }) => node)), update: () => parts.forEach(({ update }) => update()) };
}

// The settings of an element with its lines in the file.
export function sheet(keys, except) {
  const form = settings(keys, except);
  const lines = element("pre.yaml", { tabindex: 0, "aria-label": "lines of the sidecar" });
  const update = () => {
    form.update();
    lines.textContent = excerpt(keys);
    lines.hidden = !lines.textContent;
  };
  update();
  return { node: element("div", { "data-sheet": keys.join(".") }, form.node, lines), update };
}

// What a new element of a section must have, or is made for.
const FIRST = { actuators: ["joint", "motor", "kind", "gains"], sensors: ["link", "joint", "origin"], materials: ["density"], parts: ["density"], joint_defaults: [] };

// A form that adds an element to a section; `given` fills in its fields.
export function adding(section, given = {}, done = () => {}) {
  const noun = section.replaceAll("_", " ").replace(/s$/, "");
  const name = element("input", { type: "text", "data-new": section, value: given.name ?? "" });
  const { required = [] } = mappingOf(schemaAt([section, ""])) ?? {};
  const fields = [...new Set([...required, ...(FIRST[section] ?? [])])].map((key) => {
    const one = valueField([section, "", key], {});
    if (given[key]) one.input.value = given[key];
    return [key, one];
  });
  const add = button(`add ${noun}`, async () => {
    const edits = fields.filter(([, one]) => one.isSet()).map(([key, one]) => ({ ...one.question(), keys: [section, name.value.trim(), key] }));
    if (await edit("all", { edits })) done(name.value.trim());
  });
  add.dataset.add = section;
  return element("details", { "data-group": `new ${section}` }, element("summary", {}, `new ${noun}`),
    submits(element("div.form", {}, field("name", name), fields.map(([, one]) => one.node), add), add));
}

// --- the robot as a whole ---

const ELSEWHERE = ["version", "step", "links", "joints", "closures", "modules", "variants", "answers"];
const OF_STEP = ["root", "materials", "defaults", "parts", "mass", "step_density", "step_encoding"]; // a description has no parts

export function robotPanel() {
  const section = element("section");
  const body = element("div.form");
  section.append(body);
  let shape = "";
  let parts = [];
  state.listen((what) => {
    if (what !== "written") return;
    const keys = Object.keys(state.vocabulary.schema.properties).filter((key) => !ELSEWHERE.includes(key) && !(state.written.described && OF_STEP.includes(key)));
    const named = keys.filter((key) => !mappingOf(schemaAt([key])) && schemaAt([key]).additionalProperties);
    const now = JSON.stringify(named.map((key) => Object.keys(valueAt([key]) ?? {})));
    if (now !== shape) {
      const opened = new Set([...body.querySelectorAll("details[open]")].map((node) => node.dataset.group));
      const groups = named.map((key) => members(key));
      const plain = keys.filter((key) => !named.includes(key)).map((key) => {
        if (!mappingOf(schemaAt([key]))) return valueField([key]);
        const inner = sheet([key]);
        return { node: element("details", { "data-group": key }, element("summary", {}, key.replaceAll("_", " ")), inner.node), update: inner.update };
      });
      parts = [...plain, ...groups];
      body.replaceChildren(...parts.flatMap(({ node }) => node).filter(Boolean));
      for (const node of body.querySelectorAll("details")) node.open ||= opened.has(node.dataset.group);
      shape = now;
    }
    parts.forEach(({ update }) => update());
  });
  // Show the settings of one section.
  const reveal = (key) => {
    const node = body.querySelector(`details[data-group="${CSS.escape(key)}"]`);
    if (node) node.open = true;
    (node ?? body.querySelector(`[data-set="${CSS.escape(key)}"]`))?.scrollIntoView({ block: "start" });
  };
  return { section, reveal };
}

// The elements of a section, each with its settings, and a form for another one.
function members(section) {
  const names = Object.keys(valueAt([section]) ?? {});
  const sheets = names.map((name) => {
    const inner = sheet([section, name]);
    const remove = button("remove", () => edit("set", { keys: [section, name], text: "" }));
    return { node: element("details", { "data-group": `${section}.${name}` }, element("summary", {}, name), inner.node, remove), update: inner.update };
  });
  const label = section.replaceAll("_", " ");
  return {
    node: element("details", { "data-group": section }, element("summary", {}, names.length ? `${label} (${names.length})` : label), element("div.branch", {}, sheets.map(({ node }) => node), adding(section))),
    update: () => sheets.forEach(({ update }) => update()),
  };
}

// --- what is selected ---

let current = { about: "", nodes: [], update() {} };

// The settings of the element that is selected; kept while it is the same one.
export function selectedSheets(selection) {
  if (!state.written) return [];
  const wanted = selection.connection ? ofConnection(selection) : selection.component ? ofPart(selection) : [[["links", selection.link], ["parts"]]];
  const isFlat = selection.triangle && (state.written.described || selection.face?.why);
  const place = state.written.described ? `{xyz: [0, 0, 0], relative_to: ${flow(selection.link)}}` : selection.face?.origin;
  const places = isFlat ? onFlat(selection) : place ? { frames: place, sensors: place } : null;
  const about = JSON.stringify(wanted);
  if (current.about !== about) {
    const sheets = wanted.map(([keys, except, words]) => {
      const { node, update } = sheet(keys, except);
      return { update, node: element("details", { "data-group": `selected ${keys[0]}`, open: keys[0] === "parts" || keys[0] === "actuators" }, element("summary", {}, words ?? "all settings"), node) };
    });
    const more = selection.connection ? newActuator(selection, wanted) : selection.component ? [...ruleChoice(selection), ...sheets.map(({ node }) => node)] : [];
    current = {
      about,
      nodes: selection.component ? more : [...sheets.map(({ node }) => node), ...more],
      update: () => sheets.forEach(({ update }) => update()),
    };
  }
  current.update();
  return selection.component || (places && !selection.connection) ? [...current.nodes, ...placed(selection.link, places ?? {})] : current.nodes;
}

let placing = { about: "", nodes: [] };

// Where a face without an axis was clicked: z of a frame points away from it, and so does x of a sensor, whose z is up.
// In the frame of the part, or of the link of a description.
function onFlat({ link, component, triangle: [a, b, c], point, X }) {
  const part = state.scene.components.find(({ path }) => path === component);
  const frame = part ? X : state.pose(link);
  const normal = unit(turnBack(frame, turn(X, cross(minus(b, a), minus(c, a)))));
  const up = turnBack(frame, [0, 0, 1]);
  const upright = minus(up, scaled(normal, dot(up, normal)));
  const z = norm(upright) > 1e-3 ? unit(upright) : across(normal)[0];
  const rounded = (value, digits) => Number(value.toFixed(digits)) + 0;
  const xyz = apply(inverse(frame), point).map((value) => `${rounded(1e3 * value, 3)} mm`);
  const origin = (axes) => {
    const rpy = anglesOf(axes).map((angle) => rounded((angle * 180) / Math.PI, 4));
    const turned = rpy.some(Boolean) ? `rpy: [${rpy.map((angle) => (angle ? `${angle} deg` : 0)).join(", ")}], ` : "";
    return `{xyz: [${xyz.join(", ")}], ${turned}relative_to: ${part ? part.quoted : flow(link)}}`;
  };
  return { frames: origin([...across(normal), normal]), sensors: origin([normal, cross(z, normal), z]) };
}

// Forms for a frame and a sensor where a face was clicked.
function placed(link, places) {
  const given = [["frames", "frame"], ["sensors", "sensor"]].map(([section, noun]) => [section, { link, origin: places[section], name: state.free(noun) }]);
  const about = JSON.stringify(given);
  if (placing.about !== about) {
    const nodes = given.map(([section, values], i) => Object.assign(adding(section, values), { open: Boolean(placing.nodes[i]?.open) }));
    placing = { about, nodes };
  }
  return placing.nodes;
}

function ofConnection(selection) {
  const one = state.find(selection);
  const driven = Object.entries(valueAt(["actuators"]) ?? {}).filter(([name, actuator]) => (actuator?.joint ?? name) === one.name);
  return [
    [[one.closes ? "closures" : "joints", one.name], ["type", "parent", "child", "link_a", "link_b"]],
    ...driven.map(([name]) => [["actuators", name], ["joint"], `actuator ${name}`]),
  ];
}

function newActuator(selection, wanted) {
  const one = state.find(selection);
  if (one.closes || !one.coordinates.length || wanted.length > 1) return [];
  return [adding("actuators", { name: one.name, joint: one.name })];
}

// --- rules for parts ---

let narrow = false; // whether a rule is for one part alone, not for all of its product

// The pattern for all parts of a product.
export const patternOf = (product) => `**/${product.replace(/[/*#]/g, "\\$&")}`;

const componentOf = ({ component }) => state.scene.components.find(({ path }) => path === component) ?? { path: component };

function patterns(selection) {
  const { path, product } = componentOf(selection);
  const equal = product ? state.scene.components.filter((one) => one.product === product).length : 1;
  const all = product && equal > 1 ? [[patternOf(product), `all ${equal} of ${product}`]] : [];
  return [...all, [path, "this part alone"]];
}

function ofPart(selection) {
  if (selection.picked?.length > 1) return [];
  const found = patterns(selection);
  const [pattern] = narrow ? found.at(-1) : found[0];
  return [[["parts", pattern], [], "material, mass, shape"]];
}

function ruleChoice(selection) {
  const found = selection.picked?.length > 1 ? [] : patterns(selection);
  if (found.length < 2) return [];
  const select = choice(found.map(([, words], i) => [String(i), words]), narrow ? "1" : "0", { "data-edit": "rule" });
  select.addEventListener("change", () => {
    narrow = select.value === "1";
    state.tell("written");
  });
  return [element("div.form", {}, field("settings of", select))];
}
