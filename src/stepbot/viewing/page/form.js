// Fields of a form in the card.

import { element } from "./dom.js";

export const button = (label, onclick, kind = "button.small") => element(kind, { type: "button", onclick }, label);
export const field = (label, input) => element("label.field", {}, element("span", {}, label), input);

// Enter in a field of a form presses its button.
export function submits(node, press) {
  node.addEventListener("keydown", ({ key, target }) => key === "Enter" && target.matches("input") && press.click());
  return node;
}

export function options(select, entries, chosen) {
  select.replaceChildren(...entries.map(([value, label]) => element("option", { value }, label)));
  if (chosen !== undefined) select.value = chosen;
}

export function choice(entries, chosen, attributes = {}) {
  const made = element("select", attributes);
  options(made, entries, chosen);
  return made;
}

export const mark = (input, isInvalid) => (isInvalid ? input.setAttribute("aria-invalid", "true") : input.removeAttribute("aria-invalid"));

// Keeps an input at a stored value, except while it holds another one that was not written yet: no new scene replaces
// that. write(text) resolves when the text was taken or refused; then the input shows what is stored. Returns a
// function to call when the stored value may have changed.
export function bound(input, read, write) {
  let [entered, taken, writing] = [0, 0, 0]; // numbers of changes
  const update = () => {
    const text = read();
    if (entered === taken && input.value !== text) input.value = text;
  };
  input.addEventListener("input", () => (entered += 1));
  input.addEventListener("change", async () => {
    const mine = (entered += 1);
    writing += 1;
    await write(input.value);
    writing -= 1;
    if (mine === entered) taken = mine;
    update();
  });
  input.addEventListener("blur", () => {
    // Without a change event the text is what it was at first.
    if (!writing) taken = entered;
    update();
  });
  return update;
}
