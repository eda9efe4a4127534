// Calibrations with their validity, and the procedures that renew them.

import { give, longPress, whyNot } from "./buttons.js";
import { h, table, time } from "./dom.js";
import { cell } from "./live.js";
import { label, spoken, t } from "./texts.js";

const DUE_DAYS = 14;

function state(one) {
  if (one.problem) return h("span", { class: "bad" }, `■ ${spoken(one.problem)}`);
  const days = (new Date(one.valid_until) - Date.now()) / 86400000;
  if (days < DUE_DAYS) return h("span", { class: "p2" }, `▲ ${t("due_in", Math.max(0, Math.floor(days)))}`);
  return h("span", {}, t("valid"));
}

function until(one) { return one.valid_until?.startsWith("9999") ? t("no_end") : time(one.valid_until); }

function parts(one) { return one.identity ? h("a", { href: `#history/used=${one.identity}` }, t("parts_with_it")) : ""; }

function procedures(d) {
  return d.procedures.map((one) => h("div", { class: "row" },
    longPress(h("button", { type: "button", class: "procedure" }, `${one.number}`), () => give("procedure", { request: "procedure", number: one.number, serial: `PROCEDURE-${one.number}` })),
    h("span", {}, label(one.name))));
}

let drawn = "";
export function build(root) {
  drawn = "";
  root.replaceChildren(h("section", { id: "calibrations" }), h("section", { id: "procedures" }));
  update(root);
}

export function update(root) {
  const d = cell.description;
  const place = root.querySelector("#calibrations");
  if (!d || !place) return;
  const key = JSON.stringify([d, document.documentElement.lang]);
  if (key !== drawn) {
    drawn = key;
    place.replaceChildren(h("h2", {}, t("calibrations")), table([t("kind"), t("made"), t("valid_until"), t("state"), ""], d.calibrations.map((one) => [one.kind, time(one.made), until(one), state(one), parts(one)])));
    root.querySelector("#procedures").replaceChildren(h("h2", {}, t("procedures")), h("p", {}, t("does_procedure")), h("p", { id: "why-not", class: "dim" }), ...procedures(d));
  }
  const reason = whyNot("procedure");
  root.querySelector("#why-not").textContent = reason;
  for (const button of root.querySelectorAll("button.procedure")) button.disabled = Boolean(reason);
}
