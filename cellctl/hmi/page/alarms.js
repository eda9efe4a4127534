// Alarms: the first one on top, each with its cause and what to do.

import { give, whyNot } from "./buttons.js";
import { h, time } from "./dom.js";
import { cell } from "./live.js";
import { given, spoken, t } from "./texts.js";

export const PRIORITY = { abort: 1, stop: 2, hold: 2, warn: 3 };
export const MARKS = { 1: "■1", 2: "▲2", 3: "▼3" };

export function priority(alarm) { return PRIORITY[alarm.reaction] || 1; }
export function mark(alarm) { return MARKS[priority(alarm)]; }

// The gravest on top, of equal ones that which came first.
export function byGravity(alarms, first) {
  return [...alarms].sort((a, b) => priority(a) - priority(b) || (b.number === first) - (a.number === first));
}

function remedy(number, english) { return given(`remedy_${number}`, english); }

function one(alarm, first, firstSince) {
  const level = priority(alarm);
  const after = firstSince && alarm.since ? (new Date(alarm.since) - new Date(firstSince)) / 1000 : 0;
  const latched = (cell.snapshot.faults || []).some((fault) => fault.number === alarm.number);
  const when = after < 0 ? t("before_first", (-after).toFixed(1)) : t("after_first", after.toFixed(1));
  const held = t(cell.snapshot.state === "STOPPED" ? "latched_stopped" : "latched");
  const reason = whyNot("acknowledge");
  return h("div", { class: `alarm fresh${first ? " first" : ""}`, "data-number": alarm.number },
    h("h2", {}, h("span", { class: `mark p${level}` }, MARKS[level]), ` ${spoken(alarm.text)}`),
    h("p", { class: "dim" }, first ? t("first_out") : when, ` · ${time(alarm.since)}`,
      alarm.run ? ` · ${t("run", alarm.run)}` : "", latched ? ` · ${held}` : ""),
    h("p", {}, `${t("cause")}: ${given(`cause_${alarm.number}`, alarm.cause)}`), h("p", {}, `${t("what_to_do")}: ${remedy(alarm.number, alarm.remedy)}`),
    h("div", { class: "row" }, h("button", { type: "button", disabled: Boolean(reason), onclick: () => give("acknowledge", { request: "acknowledge", number: alarm.number }) }, t("acknowledge")),
      h("span", { class: "dim" }, reason || t("acknowledge_does"))));
}

let drawn = "";
export function build(root) {
  drawn = "";
  root.replaceChildren(h("section", { id: "alarms" }));
  update(root);
}

export function update(root) {
  const s = cell.snapshot;
  const place = root.querySelector("#alarms");
  if (!s || !place) return;
  const first = s.faults[0]?.number;
  const alarms = [...s.alarms].sort((a, b) => (b.number === first) - (a.number === first));
  const key = JSON.stringify([alarms, s.state, s.faults.map((fault) => fault.number), document.documentElement.lang, whyNot("acknowledge")]);
  if (key === drawn) return;
  drawn = key;
  place.replaceChildren(h("h2", {}, t("alarms_active", alarms.length)),
    ...(alarms.length ? alarms.map((alarm, i) => one(alarm, i === 0, alarms[0].since)) : [h("p", {}, t("no_alarms"))]));
}
