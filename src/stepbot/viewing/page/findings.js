// Diagnostics: severity, message, place, remedies.

import { element } from "./dom.js";

const TONES = { error: "bad", warning: "warn", note: "quiet" };
const ORDER = ["error", "warning", "note"];

export function findingsPanel(state) {
  const section = element("section");
  state.listen((what) => {
    if (what !== "scene" && what !== "proof") return;
    const found = [...state.scene.diagnostics].sort((a, b) => ORDER.indexOf(a.severity) - ORDER.indexOf(b.severity));
    section.replaceChildren(...(found.length ? found.map((one) => finding(state, one)) : [element("p.quiet", {}, "No findings.")]));
  });
  return section;
}

function finding(state, one) {
  const about = state.mentioned(one.message);
  const place = one.line ? `${one.file}:${one.line}` : one.file;
  return element("div.finding", { "data-code": one.code },
    element("div", {}, element("b." + TONES[one.severity], {}, `${one.severity} ${one.code}`), " ", element("span.quiet", {}, place)),
    about ? element("button.about", { type: "button", onclick: () => state.select(about) }, one.message) : element("div", {}, one.message),
    one.source ? element("pre.yaml", {}, `${String(one.line).padStart(4)}  ${one.source}`) : null,
    one.help.map((text) => element("div.help", {}, text)));
}
