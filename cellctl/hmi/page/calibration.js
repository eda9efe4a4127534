// Calibrations with their validity, each with the procedures that renew it.

import { h, table, time } from "./dom.js";
import { cell } from "./live.js";
import { spoken, t } from "./texts.js";

const DUE_DAYS = 14;

export function life(one) {
  if (one.problem) return h("span", { class: "bad" }, `■ ${spoken(one.problem)}`);
  const days = (new Date(one.valid_until) - Date.now()) / 86400000;
  if (days < DUE_DAYS) return h("span", { class: "p2" }, `▲ ${t("due_in", Math.max(0, Math.floor(days)))}`);
  return h("span", {}, t("valid"));
}

export function within(one) { return one.valid_until?.startsWith("9999") ? t("no_end") : time(one.valid_until); }

function parts(one) { return one.identity ? h("a", { href: `#history/used=${one.identity}` }, t("parts_with_it")) : ""; }

function renewing(one) {
  const makers = cell.description.procedures.filter((procedure) => procedure.renews?.includes(one.kind));
  return h("div", { class: "row" }, makers.map((procedure) => h("a", { href: `#maintenance/${procedure.number}` }, `${procedure.number}`)));
}

let drawn = "";
export function build(root) {
  drawn = "";
  root.replaceChildren(h("section", { id: "calibrations" }));
  update(root);
}

export function update(root) {
  const d = cell.description;
  const place = root.querySelector("#calibrations");
  if (!d || !place) return;
  const key = JSON.stringify([d, document.documentElement.lang]);
  if (key !== drawn) {
    drawn = key;
    place.replaceChildren(h("h2", {}, t("calibrations")), table([t("kind"), t("made"), t("valid_until"), t("state"), t("renewed_by"), ""], d.calibrations.map((one) => [one.kind, time(one.made), within(one), life(one), renewing(one), parts(one)])));
  }
}
