// The commands of the cell. What is permitted, and why not, comes from the cell.

import { ask, command } from "./api.js";
import { clock, corrected, h, time, write } from "./dom.js";
import { cell, stale } from "./live.js";
import { given, t } from "./texts.js";

const HOLD_MS = 1000;
const NO_ANSWER_MS = 3000;
const ALWAYS = new Set(["stop", "abort"]);
const PRESSED_LONG = new Set(["reset", "unhold", "start", "procedure"]);
const ORDER = ["start", "reset", "hold", "unhold", "clear", "stop", "abort"];
const [SUPERSEDED, ROLE_MISSING, NOT_AT_A_PANEL] = [266, 268, 269];
const said = {};

// Nobody, to whom nothing is allowed.
export const nobody = () => ({ person: "", role: "view", panel: "", idle: false, commands: {} });
// Who looks at this page, and what the API says that their role and place allow.
export const visitor = nobody();
const refusals = new Set();
// Called when a command was refused for who or where its person is: the page may know it otherwise.
export function onLost(act) { refusals.add(act); }

// What is not theirs to ask for, and else what the cell says of it: both only spare a vain press.
export function whyNot(name) {
  const own = visitor.commands[name];
  if (!own) return t("sign_in_first");
  if (own.code === ROLE_MISSING) return visitor.idle ? t("idle_sign_in") : t("needs_sign_in", t(`role_${own.needs}`));
  if (own.code === NOT_AT_A_PANEL) return t("panel_only");
  if (ALWAYS.has(name)) return "";  // pressed on whatever is seen: the cell gives an honest answer
  if (stale()) return t("stale_button");
  if (name === "acknowledge") return "";
  const permission = cell.snapshot?.permitted?.[name];
  if (typeof permission?.code !== "number") return t("unknown");
  return permission.code ? given(`reject_${permission.code}`, permission.reason) : "";
}

export async function give(name, wanted, reason = "") {
  const decision = cell.snapshot?.decision ?? null;
  let waiting = true;
  said[name] = t("asked");
  setTimeout(() => { if (waiting) said[name] = t("no_answer"); }, NO_ANSWER_MS);
  try {
    await command(wanted, decision, reason);
    said[name] = t("taken");
    setTimeout(() => { if (said[name] === t("taken")) said[name] = ""; }, 4000);
  } catch (error) {
    const code = error.problem?.reject_code;
    const unknown = !error.status || error.status === 504;
    if (error.status === 401 || error.status === 403) refusals.forEach((act) => act());
    const why = given(`reject_${code}`, error.message);
    // Who was quicker stands in the next snapshot, a tenth of a second after the refusal.
    said[name] = unknown ? t("no_answer") : () => t("refused", code === SUPERSEDED ? `${why} (${latest()})` : why);
    setTimeout(() => { said[name] = ""; }, 8000);
  } finally {
    waiting = false;
  }
}

// Pressed for a second, by finger, mouse or key: a glove that brushes the panel moves nothing.
export function longPress(button, act) {
  let timer = 0;
  const end = () => { clearTimeout(timer); timer = 0; button.classList.remove("holding"); };
  const begin = () => {
    if (timer || button.disabled) return;
    button.classList.add("holding");
    timer = setTimeout(() => { end(); if (!button.disabled) act(); }, HOLD_MS);
  };
  button.addEventListener("pointerdown", begin);
  for (const name of ["pointerup", "pointerleave", "pointercancel", "blur"]) button.addEventListener(name, end);
  button.addEventListener("keydown", (event) => {
    if (event.key === "Enter" || event.key === " ") { event.preventDefault(); begin(); }
  });
  button.addEventListener("keyup", end);
  return button;
}

// A serial number that has a run already, and how that one ended: known before the robots move.
async function earlier(serial, said) {
  const asked = serial.value;
  let words = "";
  try {
    const { runs } = await ask(`runs?limit=20&serial=${encodeURIComponent(asked)}`);
    const before = runs.find((run) => run.serial === asked);
    if (before) words = `▲ ${t("used_before", before.number, t(`result_${before.ended_as || "open"}`), time(before.started))}`;
  } catch { /* whether it may start is the cell's word */ }
  if (serial.value === asked) write(said, words);
}

// Until when what production needs stays valid: the first that ends.
function validUntil() {
  const ends = (cell.description?.calibrations || []).map((one) => one.valid_until).filter((end) => end && !end.startsWith("9999")).sort();
  return ends.length ? t("calibrations_until", time(ends[0])) : "";
}

function startDialog() {
  const recipes = cell.description?.recipes || [];
  const entry = (id, pattern, more = {}) => corrected(h("input", { id, maxlength: 24, pattern, title: t("serial_form"), autocomplete: "off", ...more }), () => t("serial_form"));
  const serial = entry("serial", "[A-Z0-9._\\-]+", { required: true });
  const mate = entry("mate-serial", "[A-Z0-9._\\-]*");
  const before = h("p", { id: "used-before", class: "bad", role: "status" });
  serial.addEventListener("change", () => earlier(serial, before));
  const recipe = h("select", { id: "recipe" }, recipes.map((one) => h("option", { value: one.number }, `${one.number} ${one.name}`)));
  const told = h("p", { role: "status" }, t("does_start"));
  const dry = h("input", { type: "checkbox", id: "dry", onchange: () => write(told, t(dry.checked ? "does_dry_run" : "does_start")) });
  const dialog = h("dialog", { "aria-label": t("cmd_start") });
  const go = longPress(h("button", { type: "button" }, t("start_hold")), () => {
    if (!serial.reportValidity() || !mate.reportValidity()) return;
    dialog.close();
    give("start", { request: "start", serial: serial.value, mate_serial: mate.value, recipe: recipe.value, dry_run: dry.checked });
  });
  dialog.append(h("h2", {}, t("cmd_start")), h("form", { onsubmit: (event) => event.preventDefault() },
    h("label", {}, t("serial"), serial), h("label", {}, t("mate_serial"), mate), h("label", {}, t("recipe"), recipe), h("label", { class: "tick" }, dry, h("span", {}, t("dry_run")))),
  before, told, h("p", { class: "dim" }, validUntil()), h("div", { class: "row" }, go,
    h("button", { type: "button", onclick: () => dialog.close() }, t("cancel"))));
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
}

function made(name) {
  const button = h("button", { type: "button", id: `cmd-${name}`, "aria-describedby": `said-${name}` }, t(`cmd_${name}`));
  if (name === "start") button.addEventListener("click", startDialog);
  else if (PRESSED_LONG.has(name)) longPress(button, () => give(name, { request: name }));
  else button.addEventListener("click", () => give(name, { request: name }));
  return h("div", { "data-command": name }, button, h("small", { id: `said-${name}`, role: "status" }));
}

// What was asked of the cell last, by whom and when.
function latest() {
  const last = cell.snapshot?.last_command;
  return last ? t("last_command", given(`cmd_${last.command}`, last.command), last.who?.replace(/^page:/, ""), clock(last.time)) : "";
}

export const controls = (names) => h("div", { class: "buttons" }, names.map(made));

export function commands() {
  return h("section", { class: "commands" }, h("h2", {}, t("commands"), h("span", { class: "dim live", id: "last-command" })), controls(ORDER));
}

// What a press would do now: of a Hold, also whether it comes too late.
function does(name) {
  const late = name === "hold" && cell.snapshot?.state === "EXECUTE" && cell.snapshot.safe_point_ahead === false;
  return t(late ? "does_hold_late" : `does_${name}`);
}

// A button that is forbidden stays in its place, with the reason below it; `besides` has, by command,
// what a screen itself waits for.
export function refresh(root, besides = {}) {
  const last = root.querySelector("#last-command");
  if (last) last.textContent = latest() && ` · ${latest()}`;
  for (const place of root.querySelectorAll("[data-command]")) {
    const name = place.dataset.command;
    const reason = whyNot(name) || besides[name];
    place.querySelector("button").disabled = Boolean(reason);
    const answer = typeof said[name] === "function" ? said[name]() : said[name];
    write(place.querySelector("small"), answer || reason || does(name));
  }
}
