// Runs: search, one of them in figures, its report.

import { ask } from "./api.js";
import { corrected, digitsOf, h, num, shown, table, time } from "./dom.js";
import { given, label, t } from "./texts.js";

const PAGE = 30;

function verdict(word) {
  const known = { good: "good", pass: "good", "done, no part": "good", bad: "bad", fail: "bad", "good, bad by gauge": "bad", aborted: "bad", interrupted: "bad" }[word];
  return h("span", { class: known || "" }, known === "bad" ? "■ " : "", t(`result_${word || "open"}`));
}

function complaint(error) { return h("p", { class: "bad" }, t("not_read", error.message)); }

async function search(place, query, before = null) {
  const filter = new URLSearchParams({ ...query, limit: PAGE, ...(before ? { before } : {}) });
  try {
    const { runs } = await ask(`runs?${filter}`);
    const rows = runs.map((run) => [h("a", { href: `#history/${run.number}` }, `${run.number}`), run.serial, run.mode === "maintenance" ? label(run.recipe_name) : run.recipe_name, given(`mode_${run.mode.toUpperCase()}`, run.mode),
      time(run.started), verdict(run.ended_as), run.operator || "—"]);
    const more = runs.length === PAGE ? h("button", { type: "button", onclick: () => search(place, query, runs[runs.length - 1].number) }, t("older")) : null;
    place.replaceChildren(runs.length ? table([t("run_head"), t("serial"), t("recipe"), t("mode"), t("started"), t("result"), t("operator")], rows) : h("p", {}, t("no_runs")), ...(more ? [more] : []));
  } catch (error) { place.replaceChildren(complaint(error)); }
}

const RESULTS = ["", "good", "bad", "stopped", "aborted", "interrupted", "open"];

// A day as all dates of the page are written: what the browser's own box shows is in its own order.
function dayField(name, wanted) {
  const box = corrected(h("input", { id: `find-${name}`, type: "date", min: "2000-01-01", max: "2999-12-31", value: wanted }), () => t("no_day"));
  const said = h("span", { class: "dim", id: `day-${name}` });
  const tell = () => { said.textContent = box.value && ` ${box.value}`; };
  box.addEventListener("input", tell);
  tell();
  return { box, said };
}

// Days are those of who asks: the last one counts to its end.
function day(text, after) {
  if (!text) return "";
  const [year, month, date] = text.split("-").map(Number);
  return new Date(year, month - 1, date + after).toISOString();
}

function list(root, wanted = {}) {
  const input = (name, more) => h("input", { id: `find-${name}`, maxlength: 80, value: wanted[name], ...more });
  const days = { since: dayField("since", wanted.since), until: dayField("until", wanted.until) };
  const field = {
    serial: input("serial", { maxlength: 24 }), recipe: input("recipe"), operator: input("operator"),
    result: h("select", { id: "find-result" }, RESULTS.map((word) => h("option", { value: word }, t(word ? `result_${word}` : "any")))),
    fault: corrected(input("fault", { type: "number", min: 1 }), () => t("no_number")), since: days.since.box, until: days.until.box, calibration: input("calibration"),
  };
  const heading = { serial: "serial_begins", fault: "fault_or_alarm", since: "from_day", until: "to_day", calibration: "used_calibration" };
  const found = h("section", { id: "found" });
  const { since, until } = field;
  since.addEventListener("input", () => until.setCustomValidity(""));
  const go = (event) => {
    event?.preventDefault();
    if (since.value && until.value && until.value < since.value) {
      until.setCustomValidity(t("days_reversed"));
      until.reportValidity();
      return;
    }
    const asked = Object.fromEntries(Object.entries(field).map(([name, one]) => [name, one.value]));
    const query = { ...asked, since: day(asked.since, 0), until: day(asked.until, 1) };
    search(found, Object.fromEntries(Object.entries(query).filter(([, value]) => value)));
  };
  root.replaceChildren(h("section", {}, h("form", { onsubmit: go }, Object.entries(field).map(([name, one]) => h("label", {}, h("span", {}, t(heading[name] || name), days[name]?.said), one)), h("button", {}, t("search")))), found);
  go();
}

// What the run used, and from there every other part that may suffer from the same error.
function used(head) {
  const rows = Object.entries(head.calibration_ids).map(([name, id]) => [name, h("code", {}, id.slice(0, 12)), h("a", { href: `#history/used=${id}` }, t("parts_with_it"))]);
  return rows.length ? [h("h2", {}, t("calibrations")), table([t("kind"), t("identity"), ""], rows)] : [];
}

// What stands behind a part: its runs and those of parts it was joined to, each with what it used.
async function behind(root, serial) {
  const place = h("section", { id: "behind" });
  root.replaceChildren(h("section", {}, h("p", {}, h("a", { href: "#history" }, t("back")))), place);
  try {
    const { runs } = await ask(`recall/serials/${encodeURIComponent(serial)}`);
    const rows = runs.flatMap((run) => run.calibrations.map((one, i) => [
      i ? "" : h("a", { href: `#history/${run.number}` }, `${run.number}`), i ? "" : run.serial, i ? "" : run.joined_to || "—", i ? "" : verdict(run.ended_as), i ? "" : seal(run.as_sealed),
      one.name, h("a", { href: `#history/used=${one.id}` }, h("code", {}, one.id.slice(0, 12))), today(one.kept)]));
    place.replaceChildren(h("h2", {}, t("behind", serial)), table([t("run_head"), t("serial"), t("joined_to"), t("result"), t("seal"), t("kind"), t("identity"), t("state_today")], rows));
  } catch (error) { place.replaceChildren(complaint(error)); }
}

function today(kept) {
  if (!kept) return t("not_kept");
  return kept.invalidated ? h("span", { class: "bad" }, `■ ${t("void_since", time(kept.invalidated), kept.invalidated_reason)}`) : t("made_at", time(kept.made));
}

function seal(as) {
  if (as === null) return t("still_open");
  return as ? t("as_sealed") : h("span", { class: "bad" }, `■ ${t("not_as_sealed")}`);
}

function within(lower, upper, unit) {
  const given = (value) => typeof value === "number";
  const said = (value) => shown(value, digitsOf(unit));
  if (given(lower) && given(upper)) return `${said(lower)} … ${said(upper)} ${unit}`;
  return given(upper) ? `≤ ${said(upper)} ${unit}` : given(lower) ? `≥ ${said(lower)} ${unit}` : "—";
}

function figures(run) {
  if (!run.figures.length) return "";
  return table([t("figure"), num(t("value")), t("limits"), t("verdict")], run.figures.map((one) => [one.label, num(`${shown(one.value, digitsOf(one.unit))} ${one.unit}`),
    within(one.lower, one.upper, one.unit), one.verdict ? verdict(one.verdict) : "—"]));
}

function passes(run) {
  return run.passes.map((pass) => h("div", {}, h("h2", {}, t("pass_head", pass.loop, pass.number)), table([t("axis"), num(t("error")), num("± 1σ"), num(t("limit"))],
    pass.components.map((one) => [one.name, num(`${shown(one.value, 4)} ${one.unit}`), num(shown(one.sigma, 4)), num(shown(one.limit, 4))]))));
}

async function detail(root, number) {
  const place = h("section", {});
  root.replaceChildren(h("section", {}, h("p", {}, h("a", { href: "#history" }, t("back")))), place);
  try {
    const run = await ask(`runs/${number}`);
    const images = run.files.filter((file) => file.media_type.startsWith("image/"));
    place.replaceChildren(h("h2", {}, t("run", number), ` · ${run.head.serial} · `, verdict(run.part_verdict)),
      run.head.result === "interrupted" ? h("p", { class: "bad" }, t("interrupted_note")) : "",
      h("p", {}, `${time(run.head.started)} – ${time(run.head.ended)} · ${run.head.operator || "—"} · ${run.head.software}`, run.head.simulated ? ` · ${t("simulated")}` : "", " · ", seal(run.as_sealed)),
      run.head.fault ? h("p", { class: "bad" }, run.head.fault) : "",
      h("p", {}, h("a", { href: `/api/v1/runs/${number}/report`, download: "" }, t("report")), " · ",
        h("a", { href: `/api/v1/runs/${number}/recording`, download: "" }, t("recording")), " · ",
        h("a", { href: `/api/v1/runs/${number}/record.zip`, download: "" }, t("record_zip")), " · ",
        h("a", { href: `#history/behind=${run.head.serial}` }, t("behind_link"))),
      figures(run), ...passes(run), h("h2", {}, t("steps")), table([t("step"), t("label"), t("began"), t("ended")], run.phases.map((one) => [one.number, label(one.label), time(one.began), time(one.ended)])),
      ...used(run.head),
      run.gauges.length ? table([t("hole"), num("mm"), t("source"), t("started"), t("verdict"), ""], run.gauges.map((one) => [one.hole, num(shown(one.diameter_mm, 2)), one.source, time(one.time), verdict(one.verdict), one.counts ? "" : t("superseded")])) : "",
      h("div", { class: "pictures" }, images.map((file) => h("figure", {}, h("img", { loading: "lazy", src: `/api/v1/runs/${number}/artefacts/${file.name}`, alt: file.name }), h("figcaption", {}, file.name)))));
  } catch (error) { place.replaceChildren(complaint(error)); }
}

export function build(root, asked) {
  const [name, id] = (asked || "").split("=");
  if (name === "behind" && id) behind(root, id);
  else if (id) list(root, { calibration: id });
  else if (name) detail(root, name);
  else list(root);
}
export function update() {}
