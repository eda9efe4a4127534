// The run now.

import { ask } from "./api.js";
import { commands, refresh } from "./buttons.js";
import { bar, digitsOf, h, num, shown, svg, table } from "./dom.js";
import { cell } from "./live.js";
import { colon, given, label, t } from "./texts.js";

const CURVE_S = 30;
const curve = [];
const STORED_MS = 1000;
let pictures = { run: 0, files: [] };
let left = { number: null };
let step = null;

export async function recall() {
  try {
    const found = (await ask("curve")).points;
    curve.unshift(...found.filter(([s]) => !curve.length || s < curve[0][0]));
  } catch { /* the curve begins anew */ }
}

export function note(snapshot) {
  curve.push([snapshot.mono_s, snapshot.forces.map((force) => force.wrench.find((one) => one.axis === "Fz")?.value ?? null)]);
  while (curve.length && curve[0][0] < snapshot.mono_s - CURVE_S) curve.shift();
  if (snapshot.step.number === step) return;
  step = snapshot.step.number;
  setTimeout(lookForLeft, STORED_MS);  // by then the record knows of the step
}

// How long the run will still take, by the last good ones; of a step that is over, nothing.
async function lookForLeft() {
  const run = cell.snapshot?.run.number;
  if (!run || !onScreen()) return;
  try { left = await ask(`runs/${run}/time-left`); } catch { left = { number: null }; }
}

function minutes(seconds) {
  const whole = Math.round(seconds);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

function far(s) {
  if (s.state !== "EXECUTE" || !left.step || left.number !== s.step.number) return [];
  const inner = h("i");
  inner.style.width = `${100 * left.step / left.of}%`;
  const words = left.longer ? t("left_longer", left.step, left.of) : t("left", left.step, left.of, minutes(left.left_s));
  return [h("div", { class: "bar", "aria-hidden": "true" }, inner), h("p", { class: "live", id: "left" }, words)];
}

async function lookForPictures() {
  const run = cell.snapshot?.run.number;
  if (!run) return;
  try {
    const files = (await ask(`runs/${run}`)).files.filter((file) => file.media_type.startsWith("image/"));
    pictures = { run, files: files.slice(-4).reverse() };
  } catch { /* they come with the next look */ }
}
const onScreen = () => !document.hidden && (location.hash.length < 2 || location.hash === "#run");
setInterval(() => { if (onScreen()) { lookForPictures(); lookForLeft(); } }, 4000);

function plot(index, limit) {
  const points = curve.map(([s, values]) => [s, values[index]]);
  const values = points.map((point) => point[1]).filter((value) => value !== null && value !== undefined);
  const low = Math.min(0, ...values) * 1.1;
  const high = Math.max(1, limit || 0, ...values) * 1.1;
  const end = curve.length ? curve[curve.length - 1][0] : 0;
  const x = (s) => (300 * (1 - (end - s) / CURVE_S)).toFixed(1);
  const y = (value) => (100 - 100 * (value - low) / (high - low)).toFixed(1);
  let path = "";
  let pen = "M";
  for (const [s, value] of points) {
    if (value === null || value === undefined) { pen = "M"; continue; }
    path += `${pen}${x(s)} ${y(value)}`;
    pen = "L";
  }
  return svg("svg", { class: "curve", viewBox: "0 0 300 100", preserveAspectRatio: "none", role: "img", "aria-label": t("force_curve", CURVE_S) },
    (limit ? [limit, -limit] : []).filter((one) => one >= low).map((one) => svg("line", { x1: 0, x2: 300, y1: y(one), y2: y(one) })), svg("path", { d: path || "M0 0" }));
}

function state(s) {
  const waiting = ["HELD", "SUSPENDED"].includes(s.state);
  const word = given(`state_${s.state}`, s.state);
  const to = s.state === s.state_requested ? "" : ` → ${given(`state_${s.state_requested}`, s.state_requested)}`;
  const colour = s.state.startsWith("ABORT") ? " p1" : waiting ? " turn" : "";
  const mark = s.state.startsWith("ABORT") ? "■ " : waiting ? "● " : "";
  const run = s.run.number ? t("run_line", s.run.number, s.run.serial || "—", t(`result_${s.run.result}`)) : t("no_run");
  return [h("div", { class: `state live${colour}`, id: "state", "data-state": s.state }, mark + word + to),
    h("p", { class: "live", id: "step" }, s.step.label ? [t("step_line", s.step.number, label(s.step.label)), s.pass && t("pass", s.pass)].filter(Boolean).join(" · ") : t("no_step")),
    h("p", { class: "live" }, run), s.step.text ? h("p", { class: "live" }, label(s.step.text)) : null,
    h("p", { class: "dim" }, `${t(`mode_${s.mode}`)} · ${t(`control_${s.control}`)} · ${t("good_parts", s.run.good_parts)}`),
    ...s.forces.filter((one) => one.presses_n).map((one) => h("p", { class: "bad pressing" }, `■ ${t("presses", shown(one.presses_n, 1), one.sensor)}`)),
    // What is left stands last: on a low panel the commands cover it sooner than what is to be done.
    h("p", { class: "live", id: "next" }, next(s)), ...far(s)];
}

// What is to be done, in the words of state and mode; in Idle, why nothing can be started.
function next(s) {
  if (s.hold_requested && s.state === "EXECUTE") return t(s.safe_point_ahead === false ? "hold_late" : "hold_waits");
  const begun = { PRODUCTION: "start", MAINTENANCE: "procedure" }[s.mode];
  const refusal = s.state === "IDLE" ? s.permitted?.[begun] : null;
  if (refusal?.code) return t("next_refused", given(`reject_${refusal.code}`, refusal.reason));
  // After a dry run, or a run that Complete has ended, the part hangs free over its place.
  if (s.state === "COMPLETED" && s.mode !== "MAINTENANCE" && s.run.result !== "good") return t("next_without_part");
  return given(`next_${s.state}_${s.mode}`, t(`next_${s.state}`));
}

function force(force, index) {
  const why = force.stale ? t("force_stale", shown(force.age_s, 0)) : force.compensated ? null : t("not_compensated");
  const fz = force.wrench.find((one) => one.axis === "Fz")?.value;
  return [h("h2", {}, t("force", force.sensor)),
    force.trip ? h("p", { class: "bad" }, `■ ${t("tripped")}${colon()}${force.trip}`) : null,
    force.touch ? h("p", { class: "dim" }, `${t("touched")}${colon()}${force.touch}`) : null,
    h("div", { class: "value live" }, `${shown(fz, 1)} N`, h("span", { class: "dim" }, ` / ${shown(force.limit_n, 0)} N`)),
    bar(fz, force.limit_n, true), plot(index, force.limit_n),
    h("p", { class: `${force.stale ? "bad" : "dim"} live force-axes` }, why ?? force.wrench.map((one) => h("span", {}, `${one.axis} ${shown(one.value, one.unit === "N" ? 1 : 2)} ${one.unit}`)))];
}

function errors(s) {
  const said = (value, unit) => shown(value, digitsOf(unit));
  const rows = s.errors.map((one) => [one.axis, num(`${said(one.value, one.unit)} ${one.unit}`), num(said(one.limit, one.unit)), bar(one.value, one.limit)]);
  // After its loop a run shows the errors with which the loop has ended.
  const known = s.errors.some((one) => typeof one.value === "number");
  const of = s.pass ? t("pass", s.pass) : known ? t("last_pass") : "";
  return [h("h2", {}, [t("errors"), of].filter(Boolean).join(" · ")), h("div", { class: "live", id: "errors" }, table([t("axis"), num(t("error")), num(t("limit")), t("bar")], rows))];
}

function shots() {
  return [h("h2", {}, t("pictures", pictures.run || "—")), pictures.files.length ? h("div", { class: "pictures" }, pictures.files.map((file) =>
    h("figure", {}, h("img", { src: `/api/v1/runs/${pictures.run}/artefacts/${file.name}`, alt: file.name }), h("figcaption", {}, file.name))))
    : h("p", { class: "dim" }, t("no_pictures"))];
}

export function build(root) {
  root.replaceChildren(h("section", { class: "third", id: "now" }), h("section", { class: "third", id: "forces" }),
    h("section", { class: "third", id: "deviation" }), commands(), h("section", { id: "shots" }));
  lookForPictures();
  update(root);
}

let drawn = "";
export function update(root) {
  refresh(root);
  const s = cell.snapshot;
  if (!s || !root.querySelector("#now")) return;
  root.querySelector("#now").replaceChildren(...state(s).filter(Boolean));
  root.querySelector("#forces").replaceChildren(...(s.forces.length ? s.forces.flatMap(force) : [h("p", {}, t("no_sensor"))]).filter(Boolean));
  root.querySelector("#deviation").replaceChildren(...errors(s));
  const key = JSON.stringify([pictures, document.documentElement.lang]);
  const place = root.querySelector("#shots");
  if (key !== drawn || !place.childElementCount) { drawn = key; place.replaceChildren(...shots()); }
}
