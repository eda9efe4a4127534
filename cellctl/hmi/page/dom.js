// Elements without templates: text is always text, never markup.

const SVG = "http://www.w3.org/2000/svg";

function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) element.setAttribute(name, value);
  }
  for (const child of children.flat(3)) {
    if (child !== null && child !== undefined && child !== false) element.append(child);
  }
  return element;
}

export function h(tag, attributes = {}, ...children) {
  return fill(document.createElement(tag), attributes, children);
}

export function svg(tag, attributes = {}, ...children) {
  return fill(document.createElementNS(SVG, tag), attributes, children);
}

// A value that is missing is a dash: never the last one, and never zero. What rounds to zero has no sign.
export function shown(value, digits = 3) {
  return typeof value === "number" && Number.isFinite(value) ? value.toFixed(digits).replace(/^-(0\.?0*)$/, "$1") : "—";
}

// Digits that tell a value from its limit: a limit that is rounded must not look wider than it is.
const DIGITS = { "°": 4, "µm": 1 };
export const digitsOf = (unit) => DIGITS[unit] ?? 3;

// Year, month, day and 24 hours, which nobody mistakes, in every language of the page.
const CLOCK = "sv-SE";
const TWO = "2-digit";
const MOMENT = { year: "numeric", month: TWO, day: TWO, hour: TWO, minute: TWO, second: TWO, timeZoneName: "short" };

export function time(text) {
  if (!text) return "—";
  const date = new Date(text);
  return Number.isNaN(date.getTime()) ? "—" : date.toLocaleString(CLOCK, MOMENT);
}

export function clock(text) {
  return text ? new Date(text).toLocaleTimeString(CLOCK) : "—";
}

// A browser complains of an entry in its own language: here it is the page's.
export function corrected(input, words) {
  const look = () => { if (!input.validity.valid && !input.validity.customError) input.setCustomValidity(words()); };
  input.addEventListener("input", () => { input.setCustomValidity(""); look(); });
  input.addEventListener("invalid", look);
  return input;
}

// How a magnitude stands against its limit; the mark is the limit.
export function bar(value, limit, wide = false) {
  const element = h("div", { class: wide ? "bar wide" : "bar", "aria-hidden": "true" });
  if (typeof value !== "number" || typeof limit !== "number" || limit <= 0) return element;
  const share = Math.abs(value) / limit;
  const inner = h("i", { class: share > 1 ? "over" : "" });
  inner.style.width = `${Math.min(100, share * 80)}%`;
  const mark = h("b");
  mark.style.left = "80%";
  element.append(inner, mark);
  return element;
}

// A column whose head is empty has a cell there: a head without words tells a screen reader nothing.
export function table(heads, rows) {
  const cell = (tag, entry) => h(tag, { class: entry && entry.num ? "num" : null }, entry && entry.of !== undefined ? entry.of : entry);
  return h("div", { class: "scroll" }, h("table", {},
    heads.length ? h("thead", {}, h("tr", {}, heads.map((head) => cell(head === "" ? "td" : "th", head)))) : null,
    h("tbody", {}, rows.map((row) => h("tr", {}, row.map((entry) => cell("td", entry)))))));
}

export const num = (of) => ({ num: true, of });

// Only what has changed: a screen reader speaks whatever is written.
export function write(place, words) {
  if (place.textContent !== words) place.textContent = words;
}
