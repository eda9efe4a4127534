// Calibrations with their validity, each with the procedures that renew it.

import { ask } from "./api.js";
import { h, num, shown, table, time } from "./dom.js";
import { cell } from "./live.js";
import { colon, spoken, t } from "./texts.js";

const DUE_DAYS = 14;

export function life(one) {
  if (one.problem) return h("span", { class: "bad" }, `■ ${spoken(one.problem)}`);
  if (!one.valid_until) return "—";
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

const NEWEST = 8;
const RELATION = { max: "≤", min: "≥", both: "±" };

// A line for each figure, a column for each time that it was calibrated: how it moves over the years.
async function trend(root, kind) {
  const place = h("section", { id: "trend" });
  root.replaceChildren(h("section", {}, h("p", {}, h("a", { href: "#calibration" }, t("all_calibrations")))), place);
  try {
    const { calibrations } = await ask(`calibrations?kind=${encodeURIComponent(kind)}&limit=${NEWEST}`);
    const made = calibrations.reverse();
    const newest = made.at(-1);
    const value = (one, name) => one.checks.find((check) => check.name === name);
    const cell = (check) => num(check ? h("span", { class: check.passed ? "" : "bad" }, check.passed ? "" : "■ ", shown(check.value)) : "—");
    const rows = (newest?.checks || []).map((check) => [check.name, ...made.map((one) => cell(value(one, check.name))), num(`${RELATION[check.side]} ${shown(check.limit)} ${check.unit}`)]);
    const void_ = made.filter((one) => one.invalidated).map((one) => h("p", { class: "bad" }, `■ ${time(one.made)}${colon()}${t("void_since", time(one.invalidated), one.invalidated_reason)}`));
    place.replaceChildren(h("h2", {}, t("trend_of", kind)), rows.length ? table([t("figure"), ...made.map((one) => num(one.made.slice(0, 10))), num(t("limit"))], rows) : h("p", {}, t("no_trend")), ...void_);
  } catch (error) { place.replaceChildren(h("p", { class: "bad" }, t("not_read", error.message))); }
}

let drawn = "";
export function build(root, kind) {
  drawn = "";
  if (kind) {
    trend(root, decodeURIComponent(kind));
    return;
  }
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
    place.replaceChildren(h("h2", {}, t("calibrations")), table([t("kind"), t("made"), t("valid_until"), t("state"), t("renewed_by"), ""], d.calibrations.map((one) => [h("a", { href: `#calibration/${encodeURIComponent(one.kind)}`, title: t("trend_of", one.kind) }, one.kind), time(one.made), within(one), life(one), renewing(one), parts(one)])));
  }
}
