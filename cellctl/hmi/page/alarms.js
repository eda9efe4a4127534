// Alarms: the first one on top, each with its cause and what to do.

import { ask } from "./api.js";
import { give, whyNot } from "./buttons.js";
import { clock, h, num, table, time, write } from "./dom.js";
import { cell } from "./live.js";
import { colon, given, spoken, t } from "./texts.js";

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
  // Those that stand here when it is pressed: one that has come since stays.
  const seen = (event) => Number(event.target.closest(".alarm").querySelector(".times").dataset.times);
  return h("div", { class: `alarm fresh${first ? " first" : ""}`, "data-number": alarm.number, "data-priority": level },
    h("h2", {}, h("span", { class: `mark p${level}` }, MARKS[level]), ` ${spoken(alarm.text)}`),
    h("p", { class: "dim" }, first ? t("first_out") : when, ` · ${time(alarm.since)}`,
      alarm.run ? ` · ${t("run", alarm.run)}` : "", latched ? ` · ${held}` : "", h("span", { class: "times" })),
    h("p", {}, `${t("cause")}${colon()}${given(`cause_${alarm.number}`, alarm.cause)}`), h("p", {}, `${t("what_to_do")}${colon()}${remedy(alarm.number, alarm.remedy)}`),
    h("div", { class: "row" }, h("button", { type: "button", disabled: Boolean(reason), onclick: (event) => give("acknowledge", { request: "acknowledge", number: alarm.number, seen: seen(event) }) }, t("acknowledge")),
      h("span", { class: "dim" }, reason || t("acknowledge_does"))));
}

// In its place: a chattering alarm takes no button from under the finger.
function count(place, alarms) {
  for (const { number, times = 1, newest } of alarms) {
    const told = place.querySelector(`[data-number="${number}"] .times`);
    if (!told) continue;
    told.dataset.times = times;
    write(told, times > 1 ? ` · ${t("came_times", times, clock(newest))}` : "");
  }
}

// More in an hour than a person can treat.
const MANY = 10;
const PAGE = 20;

function row(one) {
  const run = one.run ? h("a", { href: `#history/${one.run}` }, `${one.run}`) : "—";
  return [h("span", { class: `mark p${priority(one)}` }, mark(one)), one.text, time(one.time), num(run), one.acknowledged_by?.replace(/^page:/, "") || t("nobody_yet"), time(one.acknowledged)];
}

// Each time that an alarm came, whoever has acknowledged it meanwhile.
async function past(place, before = null) {
  try {
    const { alarms, last_hour: count } = await ask(`alarms?limit=${PAGE}${before ? `&before=${before}` : ""}`);
    const more = alarms.length === PAGE ? h("button", { type: "button", onclick: () => past(place, alarms[alarms.length - 1].id) }, t("older")) : "";
    const hour = h("p", { class: count >= MANY ? "bad" : "dim" }, count >= MANY ? "▲ " : "", t("last_hour", count));
    const heads = ["", t("alarm"), t("came"), num(t("run_head")), t("acknowledged_by"), t("acknowledged")];
    place.replaceChildren(h("h2", {}, t("alarm_history")), hour, alarms.length ? table(heads, alarms.map(row)) : h("p", {}, t("none_yet")), more);
  } catch (error) { place.replaceChildren(h("h2", {}, t("alarm_history")), h("p", { class: "bad" }, t("not_read", error.message))); }
}

let drawn = "";
let known = "";
export function build(root) {
  drawn = known = "";
  root.replaceChildren(h("section", { id: "alarms" }), h("section", { id: "past" }));
  update(root);
  if (!known) past(root.querySelector("#past"));
}

export function update(root) {
  const s = cell.snapshot;
  const place = root.querySelector("#alarms");
  if (!s || !place) return;
  const first = s.faults[0]?.number;
  const alarms = [...s.alarms].sort((a, b) => (b.number === first) - (a.number === first));
  const came = JSON.stringify([alarms.map((alarm) => alarm.since), document.documentElement.lang]);
  if (came !== known) {
    known = came;
    past(root.querySelector("#past"));
  }
  const lasting = alarms.map(({ times, newest, ...alarm }) => alarm);
  const key = JSON.stringify([lasting, s.state, s.faults.map((fault) => fault.number), document.documentElement.lang, whyNot("acknowledge")]);
  if (key !== drawn) {
    drawn = key;
    place.replaceChildren(h("h2", {}, t("alarms_active", alarms.length)),
      ...(alarms.length ? alarms.map((alarm, i) => one(alarm, i === 0, alarms[0].since)) : [h("p", {}, t("no_alarms"))]));
  }
  count(place, alarms);
}
