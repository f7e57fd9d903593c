// The verification table and links that overlap.

import { element } from "./dom.js";
import { millimetres, short } from "./numbers.js";

export function proofPanel(state) {
  const section = element("section");
  const update = () => {
    const { proof } = state.scene;
    const rows = proof?.rows.length ? table(proof.rows) : element("p.quiet", {}, !proof && state.proving ? "Engines are running." : "Not verified.");
    section.replaceChildren(rows, ...overlaps(state));
  };
  state.listen((what) => {
    if (["scene", "proof", "contacts"].includes(what)) update();
  });
  return section;
}

const WORDS = { passed: ["good", "✓"], failed: ["bad", "✗"], "not run": ["quiet", "–"] };

function table(rows) {
  return element("table", {}, element("tbody", {}, rows.map((row) => {
    const [tone, mark] = WORDS[row.status];
    const worst = row.worst && row.worst.deviation !== null
      ? `largest deviation ${short(row.worst.deviation, 2)} ${row.worst.unit} in ${row.worst.quantity}, tolerance ${short(row.worst.tolerance, 2)}` : "";
    return element("tr", { "data-status": row.status },
      element("td." + tone, { title: row.status }, mark),
      element("td", {},
        element("div", {}, row.file || "robot", " ", element("span.quiet", {}, [row.engine, row.version].filter(Boolean).join(" "))),
        row.compared.length ? element("div.quiet", {}, `${row.compared.length} quantities compared${worst ? `, ${worst}` : ""}`) : null,
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
