// Procedures, each guided: what to set up, what will move, start, progress, result, what follows.
//
// A procedure lives in the daemon. What is shown of it comes from the cell, so that leaving this
// screen ends nothing, and every page shows the same. Only the ticks of the set-up belong to a tab.

import { controls, give, longPress, refresh } from "./buttons.js";
import { life, within } from "./calibration.js";
import { h, table, time, write } from "./dom.js";
import { cell } from "./live.js";
import { colon, given, label, spoken, t } from "./texts.js";

const AT_REST = new Set(["IDLE", "STOPPED", "ABORTED", "COMPLETED"]);
const ticked = new Map();
let shown = null;

const ofKind = (kind) => cell.description.calibrations.find((one) => one.kind === kind);
const found = (number) => cell.description?.procedures.find((one) => one.number === number);
const mine = (s, number) => s.mode === "MAINTENANCE" && s.run.recipe === number;

// Where a procedure stands, by the state of the cell alone.
function stage(s, number) {
  if (s.state === "IDLE" || !mine(s, number)) return "before";
  return AT_REST.has(s.state) ? "after" : "under_way";
}

function renewed(one) {
  const rows = (one.renews || []).map((kind) => [kind, ofKind(kind)]);
  return rows.length ? table([t("kind"), t("made"), t("valid_until"), t("state")],
    rows.map(([kind, of]) => [kind, time(of?.made), of ? within(of) : "—", of ? life(of) : t("never_made")])) : h("p", {}, t("renews_nothing"));
}

function list(root) {
  const rows = cell.description.procedures.map((one) => [
    h("a", { href: `#maintenance/${one.number}` }, `${one.number} ${label(one.name)}`),
    (one.renews || []).join(", ") || "—",
    (one.renews || []).map((kind) => h("div", {}, ofKind(kind) ? life(ofKind(kind)) : t("never_made"))),
    (one.renews || []).map((kind) => h("div", {}, ofKind(kind) ? within(ofKind(kind)) : "—")),
  ]);
  root.replaceChildren(h("section", {}, h("h2", {}, t("procedures")),
    rows.length ? table([t("procedure"), t("renews"), t("state"), t("next_due")], rows) : h("p", {}, t("no_procedures"))));
}

function step(name, ...inside) {
  return h("li", { "data-step": name }, h("h2", {}, t(`guide_${name}`)), ...inside);
}

const lines = (sentences) => h("ul", {}, sentences.map((one) => h("li", {}, label(one))));

function setUp(one) {
  const ticks = ticked.get(one.number) || new Set();
  ticked.set(one.number, ticks);
  const tick = (sentence, i) => h("label", { class: "tick" }, h("input", { type: "checkbox", id: `tick-${i}`, checked: ticks.has(i),
    onchange: (event) => { if (event.target.checked) ticks.add(i); else ticks.delete(i); } }), h("span", {}, label(sentence)));
  return one.set_up?.length ? one.set_up.map(tick) : [h("p", {}, t("guide_unknown"))];
}

function start(one) {
  const confirmed = () => t("confirmed", one.set_up?.length || 0);
  const button = h("button", { type: "button", id: "cmd-procedure", "aria-describedby": "said-procedure" }, t("start_hold"));
  longPress(button, () => give("procedure", { request: "procedure", number: one.number, serial: `PROCEDURE-${one.number}` }, confirmed()));
  return h("div", { class: "row", "data-command": "procedure" }, button, h("small", { id: "said-procedure", role: "status" }));
}

function modes() {
  const mode = h("button", { type: "button", id: "cmd-mode", "aria-describedby": "said-mode", onclick: () => give("mode", { request: "mode", mode: "maintenance" }) }, t("to_maintenance"));
  return h("div", { class: "row", "data-command": "mode" }, mode, h("small", { id: "said-mode", role: "status" }));
}

function guide(root, one) {
  root.replaceChildren(h("section", {}, h("div", { class: "row" }, h("p", {}, h("a", { href: "#maintenance" }, t("all_procedures"))), h("h2", {}, `${one.number} ${label(one.name)}`)),
    h("p", { class: "dim live", id: "who-runs" })),
  h("section", { class: "half" }, h("ol", { class: "guide" },
    step("set_up", ...setUp(one)),
    step("moves", one.moves?.length ? lines(one.moves) : h("p", {}, t("guide_unknown"))),
    step("ready", h("p", { class: "live", id: "mode-now" }), modes(), controls(["clear", "reset"])),
    step("start", h("p", {}, t("leaving_ends_nothing")), start(one)))),
  h("section", { class: "half" }, h("ol", { class: "guide", start: 5 },
    step("under_way", h("div", { class: "bar wide", role: "progressbar", "aria-label": t("guide_under_way"), "aria-valuemin": 0, "aria-valuemax": 100 }, h("i")),
      h("p", { class: "live", id: "progress" }), controls(["hold", "unhold", "stop", "abort"]), h("p", { class: "dim" }, t("quit"))),
    step("result", h("p", { class: "live", id: "outcome", role: "status" }), h("div", { id: "renewed" })),
    step("then", one.then?.length ? lines(one.then) : h("p", {}, t("then_reset"))))));
}

// "head 1: view 3 of 20": the count tells how far it is.
function share(text) {
  const [, done, total] = /(\d+) of (\d+)$/.exec(text || "") || [];
  return total ? Math.round(100 * done / total) : null;
}

function progress(root, s, at) {
  const bar = root.querySelector("[role=progressbar]");
  const part = at === "under_way" ? share(s.step.text) : null;
  bar.firstChild.style.width = `${part ?? 0}%`;
  if (part === null) bar.removeAttribute("aria-valuenow");
  else bar.setAttribute("aria-valuenow", part);
  root.querySelector("#progress").textContent = at === "under_way" ? `${given(`state_${s.state}`, s.state)}${colon()}${label(s.step.text) || "…"}` : "—";
}

function outcome(s, at) {
  if (at !== "after") return "—";
  const fault = s.faults[0];
  const good = s.run.result === "good" || s.state === "COMPLETED";
  const words = fault ? `■ ${spoken(fault.text)} ${t("what_to_do")}${colon()}${given(`remedy_${fault.number}`, fault.remedy)}` : t(`result_${good ? "done" : s.run.result}`);
  return s.run.number ? `${words} · ${t("run", s.run.number)}` : words;
}

function draw(root, s, one) {
  const at = stage(s, one.number);
  const ready = s.mode === "MAINTENANCE" && s.state === "IDLE";
  const ticks = ticked.get(one.number);
  const complete = ticks.size === (one.set_up?.length || 0);
  const current = { under_way: "under_way", after: "result" }[at] || (!complete ? "set_up" : ready ? "start" : "ready");
  for (const place of root.querySelectorAll("[data-step]")) {
    if (place.dataset.step === current) place.setAttribute("aria-current", "step");
    else place.removeAttribute("aria-current");
  }
  refresh(root, { procedure: complete ? "" : t("tick_first"), mode: s.mode === "MAINTENANCE" ? t("is_maintenance") : "" });
  root.querySelector("#mode-now").textContent = `${t("mode")}${colon()}${t(`mode_${s.mode}`)} · ${given(`state_${s.state}`, s.state)}`;
  progress(root, s, at);
  write(root.querySelector("#outcome"), outcome(s, at));
  // Under way an empty box would look like something that is still to be done; the next start wants every tick anew.
  if (at === "under_way") ticks.clear();
  for (const box of root.querySelectorAll("[id^=tick-]")) { box.hidden = at === "under_way"; box.checked = ticks.has(Number(box.id.slice(5))); }
  const last = s.last_command;
  root.querySelector("#who-runs").textContent = at === "under_way" && last ? t("last_command", t("asked_last"), last.who?.replace(/^page:/, ""), `${given(`cmd_${last.command}`, last.command)} ${time(last.time)}`) : "";
}

export function build(root, number) {
  shown = null;
  root.replaceChildren(h("section", {}, h("p", {}, t("unknown"))));
  root.dataset.procedure = number || "";
  update(root);
}

export function update(root) {
  const s = cell.snapshot;
  if (!s || !cell.description) return;
  const one = found(Number(root.dataset.procedure));
  const key = JSON.stringify([one || null, cell.description.procedures.length, document.documentElement.lang, one ? null : cell.description.calibrations]);
  if (key !== shown) {
    shown = key;
    if (one) guide(root, one);
    else list(root);
  }
  if (!one) return;
  draw(root, s, one);
  const place = root.querySelector("#renewed");
  const renew = JSON.stringify(cell.description.calibrations);
  if (place.dataset.of !== renew) { place.dataset.of = renew; place.replaceChildren(renewed(one)); }
}
