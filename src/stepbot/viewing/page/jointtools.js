// Edits of one joint or closure: its name, type, axis, limits.

import { edit, nextClick, rename, say } from "./changes.js";
import { element } from "./dom.js";
import { bound, button, choice, field, options } from "./form.js";
import { followTools } from "./following.js";
import { neededField } from "./jointform.js";
import { limitTools } from "./limittools.js";
import { ask, faceOf } from "./live.js";
import { app } from "./main.js";
import { valueAt } from "./written.js";

const { state } = app;
let panel = null;

// The tools of the joint that is selected: made once, and kept at what each new scene has.
export function jointTools(selection) {
  const one = state.find(selection);
  const isSame = panel && one && (panel.selection === selection || panel.one.name === one.name) && panel.one.closes === one.closes;
  if (!isSame) {
    state.preview = {};
    panel = one ? jointPanel(one) : null;
  }
  return panel?.show(one, selection) ?? [];
}

app.view.grips.sources.push(() => panel?.grips() ?? []);

state.listen(() => {
  if (state.selection?.connection) return;
  state.preview = {};
  panel = null;
});

function jointPanel(first) {
  const name = () => made.one.name;
  const title = element("h3", {}, "Edit");
  const fields = [nameField("joint", "name", name)];
  if (!first.closes) fields.push(nameField("link", "child link", () => made.one.child), typeField(() => made.one));
  const axis = lineField(() => made.one);
  const follow = followTools(() => made.one);
  const form = element("div.form", {}, fields.map(({ node }) => node), axis.node, follow.node);
  const flip = act("flip", "flip axis", () => edit("flip", () => ({ joint: name() }), () => `axis flipped${hasLimits(made.one) ? "; limits mirrored, the motion is the same" : ""}`));
  const remove = act("remove", first.closes ? "remove closure" : "remove joint", async () => {
    if (await edit("remove_joint", () => ({ joint: name() }))) state.select(null);
  });
  const confirm = act("confirm", "", () => edit("confirm", async () => ({ joint: name(), ...(await axis.selectors()) })));
  const aim = act("aim", "axis from a click", () => nextClick("Click a bore, a shaft or an edge: its axis becomes that of the joint. Esc ends it.", (clicked) => {
    take(made.one, clicked);
    return state.selection;
  }));
  const acts = element("div.acts", {}, confirm, flip, aim, ...follow.acts, remove);
  let limits = null;
  const made = {
    one: first,
    selection: null,
    show(one, selection) {
      Object.assign(made, { one, selection });
      for (const { update } of [...fields, axis, follow]) update();
      flip.hidden = !one.axis;
      aim.hidden = Boolean(state.written?.described);
      remove.hidden = Boolean(state.written?.described);
      confirm.hidden = !one.doubt;
      confirm.textContent = one.axis ? "axis is right" : "reviewed";
      const joint = one.coordinates.length === 1 ? state.tree.joints[state.tree.column.get(one.coordinates[0])] : null;
      const isLimited = joint && state.scene.joint_types[one.kind].bounded;
      if (!isLimited || limits?.kind !== one.kind) limits = isLimited ? limitTools(one.kind, () => made.one) : null;
      limits?.update(joint);
      return [title, form, ...(limits?.nodes ?? []), acts];
    },
    grips: () => limits?.grips() ?? [],
  };
  return made;
}

// The axis of a face or edge becomes that of a joint.
async function take(joint, clicked) {
  if (!clicked.triangle) return say("That is no place on the robot; click a part in the 3D view.");
  const face = await faceOf(clicked).catch((error) => ({ why: error.message }));
  if (!face.origin) return say(face.why);
  const keys = [joint.closes ? "closures" : "joints", joint.name];
  const former = valueAt([...keys, "axis"]) ?? "";
  const axis = face.axis ?? (/^-?z?$/.test(former) ? former : ""); // along a line of faces z is the axis, in either direction
  const values = [["origin", face.origin], ...(joint.axis ? [["axis", axis]] : [])]; // a fixed joint may get its type later
  return edit("all", { edits: values.map(([key, text]) => ({ action: "set", keys: [...keys, key], text })) });
}

const hasLimits = ({ limits }) => limits && (limits.lower !== null || limits.upper !== null);

function act(name, label, onclick) {
  const made = button(label, onclick);
  made.dataset.edit = name;
  return made;
}

// The name of a joint or link, which `former` returns; all references to it follow.
export function nameField(what, label, former) {
  const box = element("input", { type: "text", "data-edit": `${what}-name` });
  const update = bound(box, former, async (text) => {
    const to = text.trim();
    if (to !== former()) await rename(what, former, to);
  });
  return { node: field(label, box), update };
}

function typeField(current) {
  const select = choice([]);
  select.dataset.edit = "type";
  const needed = neededField();
  const change = (kind) => edit("type", () => ({ joint: current().name, kind, needed: needed.value() }));
  let waiting = () => {};
  const keep = bound(select, () => current().kind, (kind) => {
    waiting();
    if (!needed.show(kind) || kind === current().kind) return change(kind);
    needed.box.value = "";
    needed.box.focus();
    return new Promise((resolve) => (waiting = resolve)); // for what it needs
  });
  needed.box.addEventListener("change", async () => {
    await change(select.value);
    waiting();
  });
  const update = () => {
    const kinds = [...new Set([current().kind, ...state.kinds(false)])];
    if (select.length !== kinds.length) options(select, kinds.map((kind) => [kind, kind]), select.value);
    keep();
    needed.show(select.value === current().kind ? "" : select.value);
  };
  return { node: element("div.form", {}, field("type", select), needed.node), update };
}

// The lines that could be its axis: choosing one writes the origin.
function lineField(current) {
  let lines = [];
  let asked = 0;
  const select = choice([["", "looking for axes"]], "", { "data-edit": "origin" });
  const words = element("p.quiet.hint");
  const node = element("div.form", { hidden: true }, field("axis", select), words); // shown if there is a choice
  const chosen = () => (lines.length ? String(lines.findIndex((line) => line.chosen)) : "");
  const keep = bound(select, chosen, (value) => {
    const { radius, near } = lines[Number(value)];
    return edit("origin", () => ({ joint: current().name, radius, near }));
  });
  let answer = null;
  const update = () => (answer = take());
  const take = async () => {
    const mine = (asked += 1);
    if (!current().axis) {
      node.hidden = true;
      return;
    }
    try {
      const found = (await ask("lines", { joint: current().name })).lines;
      if (mine !== asked) return; // a later answer comes
      const same = found.length === lines.length && found.every((line, i) => line.words === lines[i].words);
      lines = found;
      if (!same) options(select, lines.map((line, i) => [String(i), line.words]), chosen());
      keep();
      words.textContent = lines[Number(chosen())]?.words ?? "";
      node.hidden = lines.length < 2;
    } catch (error) {
      words.textContent = error.message; // here, and not as a message: the joint may have been removed meanwhile
    }
  };
  // Those of the line that it has.
  const selectors = async () => {
    await answer;
    const { radius, near } = lines[Number(chosen())] ?? {};
    return { radius, near };
  };
  return { node, update, selectors };
}
