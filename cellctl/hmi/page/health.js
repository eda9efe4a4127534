// Links of the devices, of the line and of this page; the mode; the audit log.

import { ask } from "./api.js";
import { give, visitor, whyNot } from "./buttons.js";
import { h, num, shown, table, time, write } from "./dom.js";
import { ageS, cell } from "./live.js";
import { alive } from "./line.js";
import { colon, given, label, spoken, t } from "./texts.js";

// A command has the word of its button; what it was about stands behind it.
function done({ action, detail }) {
  if (action === "set") {
    return detail.acknowledged ? `${t("cmd_acknowledge")} F${detail.acknowledged}` : `${t("cmd_mode")} ${given(`mode_${(detail.mode || "").toUpperCase()}`, detail.mode || "—")}`;
  }
  const command = given(`cmd_${action}`, given(`audit_${action}`, action));
  const of = action === "start" ? [detail.mode === "maintenance" ? t("procedure") : t("recipe"), detail.recipe, detail.serial] : [detail.procedure && label(detail.procedure)];
  return [command, ...of].filter(Boolean).join(" ");
}

// Why it was asked for, in the person's words; and why it was refused, in those of the cell.
function why({ detail }) {
  const refused = detail.refused ? `■ ${t("refused", given(`reject_${detail.reject_code}`, detail.refused))}` : "";
  return [detail.reason, refused].filter(Boolean).join(" · ");
}

// Nothing is wrong with a device that says so: one of which nothing was said is no such device.
function link(problem) {
  if (problem === null) return "—";
  return problem ? h("span", { class: "bad" }, `■ ${spoken(problem)}`) : t("answers");
}

async function more(root) {
  try {
    const health = await ask("health");
    const place = root.querySelector("#process");
    if (place) place.replaceChildren(h("h2", {}, t("page_process")), table([], [[t("software"), health.software], [t("pages_open"), `${health.pages_open}`], [t("daemon_linked"), t(health.daemon_linked ? "yes" : "no")]]));
  } catch { /* the band says that nothing answers */ }
  if (visitor.role !== "maintain") return;
  try {
    const { entries } = await ask("audit?limit=50");
    root.querySelector("#audit")?.replaceChildren(h("h2", {}, t("audit")), table([t("started"), t("who"), t("action"), t("reason")], entries.map((one) => [time(one.time), one.actor, done(one), why(one)])));
  } catch { /* shown at the next visit */ }
}

export function build(root) {
  const modes = ["production", "maintenance", "manual"].map((mode) => h("button", { type: "button", class: "mode", "data-mode": mode.toUpperCase(), onclick: () => give("mode", { request: "mode", mode }) }, t(`mode_${mode.toUpperCase()}`)));
  root.replaceChildren(h("section", { class: "half", id: "links" }), h("section", { class: "half", id: "process" }),
    h("section", {}, h("h2", {}, t("mode"), h("span", { class: "live", id: "mode-now" })), h("div", { class: "row" }, modes), h("p", { class: "dim", id: "mode-why" })), h("section", { id: "audit" }, h("p", { class: "dim" }, t("audit_needs"))));
  more(root);
  update(root);
}

export function update(root) {
  const s = cell.snapshot;
  const place = root.querySelector("#links");
  if (!s || !place) return;
  const rows = Object.entries(s.links).map(([name, problem]) => [name, link(problem), ""]);
  for (const force of s.forces) rows.push([force.sensor, t("sample_age"), num(`${shown(force.age_s === null ? null : force.age_s * 1000, 0)} ms`)]);
  rows.push([t("line_plc"), alive(s), ""]);
  rows.push([t("this_page"), t("sample_age"), num(`${shown(ageS() * 1000, 0)} ms`)]);
  place.replaceChildren(h("h2", {}, t("links")), h("div", { class: "live" }, table([t("device"), t("state"), num(t("age"))], rows)));
  const reason = whyNot("mode");
  root.querySelector("#mode-why").textContent = reason;
  write(root.querySelector("#mode-now"), `${colon()}${s.mode ? given(`mode_${s.mode}`, s.mode) : "—"}`);
  for (const button of root.querySelectorAll("button.mode")) {
    button.disabled = Boolean(reason);
    button.setAttribute("aria-pressed", button.dataset.mode === s.mode);
  }
}
