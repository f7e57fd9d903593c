// Elements from code: texts are always text nodes, so that no name can become markup.

// element("button.chip", { onclick }, "text", child): attributes that start with "on" are listeners.
export function element(kind, attributes = {}, ...children) {
  const [tag, ...classes] = kind.split(".");
  const made = document.createElement(tag);
  if (classes.length) made.className = classes.join(" ");
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (name === "value") made.value = value;
    else made.setAttribute(name, value === true ? "" : value);
  }
  made.append(...children.flat(Infinity).filter((child) => child !== null && child !== undefined && child !== ""));
  return made;
}

// Nodes of items with a heading above those of each module, the innermost that has an item's link; without modules as they are.
export function byModule({ modules = [] }, items, linkOf, nodeOf) {
  const of = (item) => modules.findLast(({ links }) => links.includes(linkOf(item)));
  return [undefined, ...modules].flatMap((module) => {
    const nodes = items.filter((item) => of(item) === module).map(nodeOf);
    return module && nodes.length ? [element("h4.module", { title: module.file }, module.name), ...nodes] : nodes;
  });
}

export const byId = (id) => document.getElementById(id);

// Children of a node in place of the former ones; those that stay keep focus, selection and scroll position.
export function place(node, children) {
  const wanted = new Set(children);
  for (const old of [...node.childNodes]) if (!wanted.has(old)) old.remove();
  let at = node.firstChild;
  for (const child of children) {
    if (child === at) at = at.nextSibling;
    else node.insertBefore(child, at);
  }
}

// Text that a button copies.
export function copyable(text, { id } = {}) {
  const button = element("button.small", { type: "button", onclick: () => copy(text, button) }, "copy");
  return element("div.copy", {}, element("code", { id }, text), button);
}

async function copy(text, button) {
  try {
    await navigator.clipboard.writeText(text);
    button.textContent = "copied";
  } catch {
    const code = button.previousElementSibling;
    getSelection().selectAllChildren(code);
    button.textContent = "press Ctrl+C";
  }
  setTimeout(() => (button.textContent = "copy"), 1500);
}

export function pairs(entries) {
  const shown = entries.filter(([, value]) => value !== null && value !== undefined && value !== "");
  return element("dl", {}, shown.map(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]));
}
