// Fields of a form in the card.

import { element } from "./dom.js";

export const button = (label, onclick, kind = "button.small") => element(kind, { type: "button", onclick }, label);
export const field = (label, input) => element("label.field", {}, element("span", {}, label), input);

export function options(select, entries, chosen) {
  select.replaceChildren(...entries.map(([value, label]) => element("option", { value }, label)));
  if (chosen !== undefined) select.value = chosen;
}

export function choice(entries, chosen, attributes = {}) {
  const made = element("select", attributes);
  options(made, entries, chosen);
  return made;
}
