// A slider and a box for each limit of a joint; the change is written when one is released and both are set.

import { edit, say } from "./changes.js";
import { element, place } from "./dom.js";
import { bound, button, mark } from "./form.js";
import { app } from "./main.js";
import { fine, internal, mistyped, parsed, shown, unitOf } from "./numbers.js";

const { state } = app;
const ENDS = ["lower", "upper"];
const stepOf = (joint) => (joint.turn ? 1 : 0.5); // [°] or [mm]

// `current` returns the joint of the scene. Until a limit is written it is in `draft`, and drawn; no new scene replaces it.
export function limitTools(kind, current) {
  const draft = {};
  let joint = null;
  let far = 0; // the ends of the sliders
  const value = (end) => draft[end] ?? joint[end];
  const hint = element("p.quiet.hint", { hidden: true }, "Set the other limit, too.");

  // The closest stops below and above the drawn pose that `init` found.
  const stops = () => {
    const found = current().stops.map(({ position }) => position);
    const [below, above] = [found.filter((q) => q < 0), found.filter((q) => q > 0)];
    return below.length && above.length ? { lower: joint.drawn + Math.max(...below), upper: joint.drawn + Math.min(...above) } : null;
  };
  const adopt = button("use stops as limits", () => {
    Object.assign(draft, stops());
    show();
    write("upper");
  });
  adopt.dataset.edit = "stops";
  const adopting = element("div.acts");

  function show() {
    const driven = state.scene.motion.driven.find((one) => one.name === joint.name);
    const travel = driven ? driven.range.map(Math.abs) : [0.2];
    const widest = joint.turn ? Math.PI : Math.max(...travel, 2 * Math.abs(joint.lower ?? 0), 2 * Math.abs(joint.upper ?? 0));
    far = Math.max(far, widest, Math.abs(value("lower") ?? 0), Math.abs(value("upper") ?? 0));
    state.preview = { [joint.name]: { ...draft } };
    for (const row of rows) row.update(far, { lower: -widest, upper: widest }[row.end]);
    hint.hidden = ENDS.every((end) => value(end) === null) || ENDS.every((end) => value(end) !== null);
    place(adopting, stops() ? [...here, adopt] : here);
    app.view.request();
  }

  function take(end, q) {
    draft[end] = q;
    show();
  }

  async function write(end) {
    if (ENDS.some((one) => value(one) === null)) return;
    let sent = {};
    const done = await edit("limits", () => {
      sent = { ...draft };
      return { joint: current().name, lower: value("lower"), upper: value("upper") };
    });
    // What was changed meanwhile stays, and so does a refused limit of a joint that has none yet, marked as invalid.
    for (const one of ENDS) {
      const isRefused = !done && one === end && joint[one] === null && draft[one] === sent[one];
      if ((done || (one === end && !isRefused)) && draft[one] === sent[one]) delete draft[one];
      row(one).mark(isRefused);
    }
    show();
  }

  // To the steps of the sliders, as a person would write it.
  const rounded = (q) => internal(joint, Math.round(shown(joint, q) / stepOf(joint)) * stepOf(joint));

  // The limits as handles on the robot; one that is not set is drawn off the joint's position.
  const handle = (end) => {
    const aside = (joint.turn ? Math.PI / 2 : far / 2) * (end === "lower" ? -1 : 1);
    return {
      label: value(end) === null ? `${end}?` : end, joint, range: [-far, far],
      value: () => value(end) ?? joint.drawn + aside, take: (q) => take(end, rounded(q)), done: () => draft[end] !== undefined && write(end),
    };
  };
  const here = ENDS.map((end) => {
    const made = button(`${end} here`, () => {
      take(end, rounded(state.q()[joint.name]));
      write(end);
    });
    made.dataset.edit = `${end}-here`;
    return made;
  });

  const row = (end) => rows.find((one) => one.end === end);
  const rows = ENDS.map((end) => limitRow(end, {
    joint: () => joint,
    value: () => value(end),
    take: (q) => take(end, q),
    write: () => write(end),
  }));
  return {
    kind,
    nodes: [...rows.map(({ node }) => node), hint, adopting],
    grips: () => (joint ? ENDS.map(handle) : []),
    update(now) {
      joint = now;
      show();
    },
  };
}

function limitRow(end, limit) {
  const bar = element("input", { type: "range", "aria-label": `${end} limit`, "data-limit": end,
    oninput: () => limit.take(internal(limit.joint(), Number(bar.value))), onchange: limit.write });
  const box = element("input.number", { type: "text", "data-end": end });
  const text = () => {
    const joint = limit.joint();
    if (!joint) return "";
    return limit.value() === null ? "not set" : `${fine(shown(joint, limit.value()))} ${unitOf(joint)}`;
  };
  const keep = bound(box, text, (typed) => {
    const q = parsed(limit.joint(), typed);
    if (q === null) {
      say(mistyped(limit.joint(), typed));
      return null;
    }
    limit.take(q);
    return limit.write();
  });
  return {
    end,
    node: element("div.limit", {}, element("span.quiet", {}, end), bar, box),
    mark: (isInvalid) => mark(box, isInvalid),
    // `otherwise`: where the slider is without a limit.
    update(far, otherwise) {
      const joint = limit.joint();
      Object.assign(bar, { min: shown(joint, -far), max: shown(joint, far), step: stepOf(joint) });
      const at = String(shown(joint, limit.value() ?? otherwise));
      if (bar.value !== at) bar.value = at;
      box.setAttribute("aria-label", `${end} limit [${unitOf(joint)}]`);
      keep();
    },
  };
}
