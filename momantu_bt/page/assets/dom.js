// Elements made of data. Texts only ever become text nodes, so no name can become markup.

const SVG = "http://www.w3.org/2000/svg";

/** Set attributes; a function is a listener, null and false leave the attribute out. */
function adorn(element, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    // The page's policy forbids style attributes; what scripts set is allowed.
    if (name === "style") element.style.cssText = value;
    else if (typeof value === "function") element.addEventListener(name, value);
    else if (value !== null && value !== false) element.setAttribute(name, value);
  }
  return element;
}

/** A new HTML element with its attributes, listeners and children. */
function make(tag, attributes = {}, ...children) {
  const element = adorn(document.createElement(tag), attributes);
  element.append(...children);
  return element;
}

/** A new SVG element. */
function draw(tag, attributes = {}, ...children) {
  const element = adorn(document.createElementNS(SVG, tag), attributes);
  element.append(...children);
  return element;
}

/** A panel's heading, tools beside it, and its scrolling body, which is returned. */
function panel(id, title, ...tools) {
  const body = make("div", { class: "body" });
  const heading = make("div", { class: "heading" }, make("h2", {}, title), ...tools);
  document.getElementById(id).append(heading, body);
  return body;
}

/** Leave out a panel that has nothing to show, and its column when nothing else is in it. */
function leaveOut(id) {
  const section = document.getElementById(id);
  const column = section.parentElement;
  section.remove();
  if (!column.children.length) column.remove();
}

/** Write a text only where it differs, so that nothing is laid out anew. */
function write(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** Scroll a panel so that the element is in sight; the page itself stays where it is. */
function reveal(body, element) {
  const [outer, inner] = [body.getBoundingClientRect(), element.getBoundingClientRect()];
  if (inner.top < outer.top || inner.bottom > outer.bottom) {
    body.scrollTop += inner.top - outer.top - Math.max(0, outer.height - inner.height) / 2;
  }
}
