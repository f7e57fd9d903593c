// Editing: parts to links, a joint between two parts, axes, limits. The server checks every change before it is written.

import { edit, nextClick, say } from "./changes.js";
import { byId, copyable, element } from "./dom.js";
import { button, choice, field } from "./form.js";
import { jointForm, nameOf } from "./jointform.js";
import { jointTools, nameField } from "./jointtools.js";
import { converted } from "./convert.js";
import { app } from "./main.js";
import { decisionsPanel } from "./decisions.js";
import { extras } from "./proof.js";
import { alikeTools, rulesForm } from "./several.js";
import { robotPanel, selectedSheets } from "./settings.js";
import { moduleOf } from "./written.js";

const { state } = app;
let form = null; // for the link or parts that are picked: kept with what is in it, until a scene changes what it is about

// The paths that an edit is about: those picked, else the one selected.
const picked = (selection) => selection.picked ?? [selection.component];

function linkTools(selection) {
  if (form?.about !== selection) {
    const name = nameField("link", "name", () => form.about.link);
    form = { about: selection, name, nodes: [element("h3", {}, "Edit"), element("div.form", {}, name.node, linkActs(() => selection.link))] };
  }
  form.name.update();
  return form.nodes;
}

function linkActs(link) {
  const joint = () => state.scene.connections.find(({ closes, child }) => !closes && child === link())?.name;
  if (!joint() || state.written?.described) return null;
  const merge = button("merge into its parent", () => edit("merge", () => ({ joint: joint() })));
  const root = button("make it the root", () => edit("root", () => ({ link: link() })));
  Object.assign(merge.dataset, { edit: "merge" });
  Object.assign(root.dataset, { edit: "root" });
  return element("div.acts", {}, merge, root);
}

function partTools(selection) {
  const paths = picked(selection);
  const about = JSON.stringify([paths, paths.map((path) => state.linkOf(path)), selection.link, state.scene.links.map(({ name }) => name), Boolean(state.vocabulary)]);
  if (form?.about === about) return form.nodes;
  const more = button("pick another part", () => nextClick("Click the next part. Esc ends it.", (clicked) => joined({ ...clicked, add: true })));
  const joint = paths.length === 2 ? [jointForm(paths)] : [];
  const others = paths.length === 1 ? alikeTools(paths[0]) : state.vocabulary ? rulesForm(paths) : [];
  form = { about, nodes: [...joint, element("h3", {}, paths.length > 1 ? "Move these parts" : "Edit"), assignForm(paths, selection), element("div.acts", {}, more, paths.length > 1 ? null : others), ...(paths.length > 1 ? others : [])] };
  return form.nodes;
}

function assignForm(paths, selection) {
  const links = state.scene.links.map((link) => [link.name, link.name]);
  const link = choice([...links, ["", "a new link, fixed to this one"]], selection.link, { "data-edit": "link" });
  const name = element("input", { type: "text", value: state.free(nameOf(paths[0])), "data-edit": "new-link" });
  const nameLine = Object.assign(field("its name", name), { hidden: true });
  link.addEventListener("change", () => (nameLine.hidden = link.value !== ""));
  const move = button("move to link", () => {
    if (link.value === "") split(paths, name.value.trim());
    else if (link.value === state.linkOf(paths[0])) say(`'${paths[0]}' is in link '${link.value}' already; choose another link.`);
    else edit("assign", { paths, link: link.value });
  });
  move.dataset.edit = "assign";
  return element("div.form", {}, field("link", link), nameLine, move);
}

// Parts become a link of their own; the type and the axis of its joint are chosen there.
async function split(paths, child) {
  const name = state.free(`${child}_joint`);
  if (await edit("add_joint", { name, kind: "fixed", parent: state.linkOf(paths[0]), child, paths })) state.select({ connection: name });
}

// What is selected after a click that adds to the parts picked before, as with Ctrl; a second one takes a part away.
function joined(selection) {
  const before = state.selection;
  if (!selection?.component || !selection.add || !before?.component) return selection;
  const [former, more] = [picked(before), picked(selection)];
  const isAgain = !selection.picked && former.length > 1 && former.includes(selection.component);
  const paths = isAgain ? former.filter((path) => path !== selection.component) : [...new Set([...former, ...more])];
  const component = isAgain ? paths.at(-1) : selection.component;
  return { ...selection, component, link: state.linkOf(component), picked: paths, triangle: null, line: null };
}

state.picking = (selection) => (state.waiting ? state.waiting(selection) : joined(selection));
app.extras.push((selection) => {
  const module = moduleOf(selection);
  if (module) return [element("p.quiet", {}, `In module '${module.name}', which is edited in its own file:`), copyable(module.edit, { id: "module" })];
  const tools = selection.connection ? jointTools : selection.component ? partTools : linkTools;
  return [...tools(selection), ...selectedSheets(selection)];
});
extras.push(converted);
const { section, reveal } = robotPanel();
app.add("robot", "Robot", section, 2);
app.add("todo", "To do", decisionsPanel(), 0);
app.reveal = (key) => {
  app.open("robot");
  reveal(key);
};
state.listen((what) => {
  if (what === "written") Object.assign(app.counts.get("todo"), { textContent: String(state.written.decisions.length || ""), className: "count warn" });
});
app.open("todo");
byId("toolbar").after(element("p", { id: "hint" }));
state.listen((what) => {
  if (what === "written") {
    byId("hint").textContent = state.written.described
      ? `This page writes changes of ${state.written.described} to its sidecar; the file itself stays as it is. Click a joint or a link.`
      : "This page edits the sidecar. Click a part to move it or to put a joint on it; to select several, press Box or Ctrl-drag.";
  }
  if (what === "selection" && state.selection) byId("hint").hidden = true;
  if (!state.selection?.link) form = null;
});
document.body.classList.add("editing");
