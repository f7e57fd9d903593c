// The verification table and links that overlap.

import { element, place } from "./dom.js";
import { millimetres, short } from "./numbers.js";

// Functions whose nodes stand above the table.
export const extras = [];

export function proofPanel(state) {
  const section = element("section");
  const update = () => {
    const { proof } = state.scene;
    const rows = proof?.rows.length ? table(state, proof.rows) : element("p.quiet", {}, !proof && state.proving ? "Engines are running." : "Not verified.");
    place(section, [...extras.flatMap((extra) => extra()), rows, ...overlaps(state)]);
  };
  state.listen((what) => {
    if (["scene", "proof", "contacts"].includes(what)) update();
  });
  return section;
}

const WORDS = { passed: ["good", "✓"], failed: ["bad", "✗"], "not run": ["quiet", "–"] };

// What failed is first, what did not run is last.
const ORDER = ["failed", "passed", "not run"];

function table(state, rows) {
  const sorted = [...rows].sort((a, b) => ORDER.indexOf(a.status) - ORDER.indexOf(b.status));
  return element("table", {}, element("tbody", {}, sorted.map((row) => {
    const about = row.status === "failed" ? state.mentioned(row.worst?.where ?? "") ?? state.mentioned(row.why) : null;
    const [tone, mark] = WORDS[row.status];
    const worst = row.worst && row.worst.deviation !== null
      ? `largest deviation ${short(row.worst.deviation, 2)} ${row.worst.unit} in ${row.worst.quantity}, tolerance ${short(row.worst.tolerance, 2)}` : "";
    return element("tr", { "data-status": row.status },
      element("td." + tone, { title: row.status }, mark),
      element("td", {},
        element("div", {}, row.file || "robot", " ", element("span.quiet", {}, [row.engine, row.version].filter(Boolean).join(" "))),
        row.compared.length ? element("div.quiet", {}, `${row.compared.length} quantities compared${worst ? `, ${worst}` : ""}`) : null,
        about ? element("button.place", { type: "button", onclick: () => state.select(about) }, `show ${about.connection ?? about.link}`) : null,
        row.why ? element("details", { open: row.status === "failed" }, element("summary", {}, row.status === "failed" ? "what failed" : "not covered"), element("p", {}, row.why)) : null));
  })));
}

// Both links, and their collision shapes, which are red where links overlap.
function show(state, [overlapped, link]) {
  state.set("collisions", true);
  state.select({ link, overlapped });
}

function overlaps(state) {
  const pairs = state.overlapping();
  if (!pairs.length) return [];
  return [element("h3", {}, state.contacts ? "Links that overlap in this pose" : "Links that overlap as drawn"), element("ul", {}, pairs.map(({ links, depth }) => element("li", {}, element("button.row", { type: "button", onclick: () => show(state, links) },
    element("span.label", {}, links.join(" and ")), element("span.value", {}, depth === null ? "" : `${millimetres(depth)} deep`)))))];
}
