// A joint that follows another one: the other is clicked, the ratio typed.

import { edit, nextClick, say } from "./changes.js";
import { element } from "./dom.js";
import { button, field, submits } from "./form.js";
import { app } from "./main.js";
import { unitOf } from "./numbers.js";

const { state } = app;

// The joint that is meant by a click: itself, or the one that moves a link.
const jointOf = ({ connection, link }) => connection ?? state.scene.connections.find(({ closes, child }) => !closes && child === link)?.name;
const moving = (name) => state.tree.joints[state.tree.column.get(name)];

// `20/60` as a number; other texts as they are.
function ratio(text) {
  const [, above, below] = text.match(/^([-+]?[\d.]+)\s*[/:]\s*([-+]?[\d.]+)$/) ?? [];
  return below && Number(below) ? String(Number((Number(above) / Number(below)).toPrecision(9))) : text;
}

export function followTools(current) {
  const node = element("div.form", { hidden: true });
  let set = null;
  submits(node, { click: () => set?.click() });
  const pick = button("follow another joint", () => nextClick("Click the joint to follow, in the list, or its link on the robot. Esc ends it.", (clicked) => {
    const leader = jointOf(clicked);
    if (!leader || leader === current().name || state.find({ connection: leader }).coordinates.length !== 1) say("That is no other joint with one degree of freedom.");
    else ask(leader);
    return state.selection;
  }));
  pick.dataset.edit = "follow";
  const free = button("do not follow", () => edit("set", () => ({ keys: ["joints", current().name, "mimic"], text: "" })));
  free.dataset.edit = "unfollow";

  function ask(leader) {
    const [mine, other] = [moving(current().name), moving(leader)];
    const [alike, example] = [mine.turn === other.turn, mine.turn ? "0.5 rad/mm" : "2 mm/rad"];
    const times = element("input", { type: "text", "data-edit": "ratio", value: alike ? "1" : "", placeholder: alike ? "1, -1, 20/60" : example });
    set = button("follow", async () => {
      const multiplier = ratio(times.value.trim());
      const keys = ["joints", current().name, "mimic"];
      if (await edit("all", { edits: [{ action: "set", keys, text: "" }, { action: "set", keys: [...keys, "joint"], value: leader }, { action: "set", keys: [...keys, "multiplier"], text: multiplier }] })) node.hidden = true;
    }, "button.small.primary");
    set.dataset.edit = "follow-set";
    node.replaceChildren(element("p.quiet", {}, `For each ${unitOf(other)} of ${leader}, ${current().name} moves this many ${unitOf(mine)}:`), field("ratio", times), set);
    node.hidden = false;
    times.select();
  }

  return {
    node,
    acts: [pick, free],
    update() {
      const one = current();
      const isFree = one.coordinates.length === 1 && !one.closes && !state.written?.described;
      pick.hidden = !isFree;
      free.hidden = !isFree || !one.mimic;
    },
  };
}
