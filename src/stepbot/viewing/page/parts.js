// The tree of links and their components.

import { byModule, element } from "./dom.js";
import { mass } from "./numbers.js";
import { css, linkColor } from "./state.js";

export function partsPanel(state) {
  const section = element("section");
  const body = element("div");
  // What the list shows open, and the text that it is searched for.
  const list = { opened: new Set(), sought: "" };
  const update = () => {
    const { selection } = state;
    if (selection?.component) list.opened.add(selection.link);
    body.replaceChildren(...everyFound(state, list.sought), element("h3", {}, "Links"), element("ul", {}, byModule(state.scene, state.scene.links, ({ name }) => name, (link) => linkEntry(state, link, list))), ...rest(state));
  };
  const search = element("input", { type: "search", id: "search", placeholder: "search parts", "aria-label": "search parts", oninput: () => {
    list.sought = search.value.trim().toLowerCase();
    update();
  } });
  section.append(search, body);
  state.listen((what) => {
    if (["scene", "selection", "show"].includes(what)) update();
  });
  return section;
}

// Selects all parts that the search finds, to move them to a link together.
function everyFound(state, sought) {
  const found = state.scene.links.flatMap(({ name, components }) => components.filter((path) => path.toLowerCase().includes(sought)).map((path) => ({ link: name, component: path })));
  if (!sought || found.length < 2 || !document.body.classList.contains("editing")) return [];
  const select = () => state.select({ ...found[0], picked: found.map(({ component }) => component) });
  return [element("button.small", { type: "button", id: "select-all", onclick: select }, `select all ${found.length}`)];
}

function linkEntry(state, link, list) {
  const { index } = state.link.get(link.name);
  const chosen = state.selection?.link === link.name && !state.selection.component;
  const hidden = state.hidden.has(link.name);
  const weight = link.mass.mass > 0 ? mass(link.mass.mass) : "";
  const color = state.show.byLink ? linkColor(index) : (link.visuals[0]?.color ?? linkColor(index));
  const dot = element("span.dot");
  dot.style.background = css(color);
  return element("li", {},
    element("div.line", {},
      element("button.row" + (chosen ? ".chosen" : ""), { type: "button", "data-link": link.name, onclick: () => state.select({ link: link.name }) },
        dot, element("span.label", {}, link.name), element("span.value.number", {}, weight)),
      element("button.eye", { type: "button", "aria-pressed": String(hidden), title: hidden ? "show" : "hide", onclick: () => state.toggle(link.name) }, hidden ? "○" : "●"),
    ),
    link.components.length ? componentList(state, link, list) : null,
  );
}

function componentList(state, link, { opened, sought }) {
  const paths = link.components.filter((path) => path.toLowerCase().includes(sought));
  const open = sought ? paths.length > 0 : opened.has(link.name);
  const rows = () => paths.map((path) => componentRow(state, link.name, path));
  const list = element("ul.branch", {}, open ? rows() : []);
  const all = link.components.length;
  const label = sought ? `${paths.length} of ${all} parts` : all === 1 ? "1 part" : `${all} parts`;
  const toggled = ({ target }) => {
    if (!sought) opened[target.open ? "add" : "delete"](link.name);
    if (target.open && !list.children.length) list.append(...rows());
  };
  return element("details.branch", { open, ontoggle: toggled }, element("summary", {}, label), list);
}

const TAIL = 18;

// A name that is cut in its middle where it does not fit, since names of parts differ at their ends.
function cut(name) {
  return element("span.label.cut", {}, element("span.start", {}, name.slice(0, -TAIL)), element("span.end", {}, name.slice(-TAIL)));
}

function componentRow(state, link, path) {
  const chosen = state.selection?.component === path || state.selection?.picked?.includes(path);
  return element("li", {}, element("button.row" + (chosen ? ".chosen" : ""), {
    type: "button", title: path, "data-component": path,
    onclick: (event) => state.select({ link, component: path, add: event.ctrlKey || event.metaKey }),
  }, cut(path)));
}

// Components that no link has, frames and sensors.
function rest(state) {
  const { components, frames, sensors, actuators } = state.scene;
  const left = components.filter((one) => one.has_body && !one.link);
  const list = (title, entries) => (entries.length ? [element("h3", {}, title), element("ul", {}, entries)] : []);
  const place = (one) => element("li", {}, element("button.row", { type: "button", onclick: () => state.select({ link: one.link }) },
    element("span.label", {}, one.name), element("span.value", {}, [one.kind?.replace("_", " ") ?? "", one.joint || one.link].filter(Boolean).join(" · "))));
  return [
    ...list("In no link", left.map((one) => element("li.row", { title: one.path }, element("span.label.quiet", {}, one.path)))),
    ...list("Frames", frames.map(place)),
    ...list("Sensors", sensors.map(place)),
    ...list("Actuators", actuators.map((one) => element("li", {}, element("button.row", { type: "button", onclick: () => state.select({ connection: one.joint }) },
      element("span.label", {}, one.name), element("span.value", {}, `${one.kind} · ${one.joint}`))))),
  ];
}
