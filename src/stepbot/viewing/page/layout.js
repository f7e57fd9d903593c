// The dock beside the robot: its width, whether it is shown, its tabs; and the sheet of shortcuts.

import { byId, element } from "./dom.js";

const [NARROWEST, STEP] = [280, 32]; // [px]

// Dragging the edge, or arrow keys on it, change the width of the dock; the robot gets the rest.
export function dock() {
  const [grip, main] = [byId("grip"), document.querySelector("main")];
  const shown = element("button.chip", { type: "button", id: "dock", "aria-pressed": "true", title: "p", onclick: toggle }, "Panels");
  function toggle() {
    const isHidden = main.classList.toggle("undocked");
    shown.setAttribute("aria-pressed", String(!isHidden));
  }
  const width = () => byId("panels").clientWidth;
  const widest = () => Math.max(NARROWEST, 0.7 * main.clientWidth);
  function announce() {
    for (const [name, value] of [["valuenow", width()], ["valuemin", NARROWEST], ["valuemax", Math.round(widest())]]) grip.setAttribute(`aria-${name}`, value);
  }
  function widen(to) {
    main.style.setProperty("--dock", `${Math.round(Math.min(widest(), Math.max(NARROWEST, to)))}px`);
    announce();
  }
  grip.addEventListener("pointerdown", (event) => grip.setPointerCapture(event.pointerId));
  grip.addEventListener("pointermove", (event) => {
    if (grip.hasPointerCapture(event.pointerId)) widen(main.getBoundingClientRect().right - event.clientX);
  });
  grip.addEventListener("keydown", ({ key }) => {
    if (key === "ArrowLeft" || key === "ArrowRight") widen(width() + (key === "ArrowLeft" ? STEP : -STEP));
  });
  new ResizeObserver(announce).observe(byId("panels"));
  byId("toolbar").append(shown);
  return toggle;
}

// Tabs: one has the focus, arrow keys go to the others. `add` puts a panel last, or at a place.
export function tabs() {
  const buttons = [];
  const counts = new Map();
  function add(id, label, section, at = buttons.length) {
    for (const [name, value] of [["id", id], ["role", "tabpanel"], ["aria-labelledby", `tab-${id}`]]) section.setAttribute(name, value);
    const count = element("span.count");
    const button = element("button", { type: "button", role: "tab", id: `tab-${id}`, "aria-controls": id, onclick: () => open(id) }, label, count);
    byId("tabs").insertBefore(button, buttons[at]?.button ?? null);
    byId("sections").append(section);
    buttons.splice(at, 0, { id, button, section });
    counts.set(id, count);
    open(buttons[0].id);
  }
  function open(chosen) {
    for (const { id, button, section } of buttons) {
      button.setAttribute("aria-selected", String(id === chosen));
      button.tabIndex = id === chosen ? 0 : -1;
      section.hidden = id !== chosen;
    }
  }
  byId("tabs").addEventListener("keydown", ({ key }) => {
    const at = buttons.findIndex(({ button }) => button === document.activeElement);
    const to = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: buttons.length - 1 }[key];
    if (at < 0 || to === undefined) return;
    const { id, button } = buttons[(to + buttons.length) % buttons.length];
    open(id);
    button.focus();
  });
  return { add, open, counts };
}

export const isTyping = ({ target }) => target instanceof HTMLSelectElement || target instanceof HTMLTextAreaElement || (target instanceof HTMLInputElement && target.type !== "range");

// `keys`: rows of keys and what they do; each row with a function is called when its key is pressed outside of a field.
export function shortcuts(keys) {
  const list = element("dl");
  const sheet = element("dialog", { id: "help", "aria-label": "Keyboard" }, element("h2", {}, "Keyboard"), list,
    element("button.small", { type: "button", onclick: () => sheet.close() }, "close"));
  document.body.append(sheet);
  const help = () => {
    list.replaceChildren(...keys.flatMap(([key, words]) => [element("dt", {}, element("kbd", {}, key)), element("dd", {}, words)]));
    sheet.showModal();
  };
  byId("toolbar").append(element("button.chip", { type: "button", id: "keys", "aria-label": "keyboard shortcuts", title: "?", onclick: help }, "?"));
  keys.push(["?", "this sheet", help]);
  addEventListener("keydown", (event) => {
    if (isTyping(event) || event.ctrlKey || event.metaKey || event.altKey || sheet.open) return;
    keys.find(([key]) => key === event.key)?.[2]?.(event);
  });
}
