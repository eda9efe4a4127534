// Runs: search, one of them in figures, its report.

import { ask } from "./api.js";
import { h, num, shown, table, time } from "./dom.js";
import { t } from "./texts.js";

const PAGE = 30;

function verdict(word) {
  const known = { good: "good", pass: "good", bad: "bad", fail: "bad", aborted: "bad", interrupted: "bad" }[word];
  return h("span", { class: known || "" }, known === "bad" ? "■ " : "", t(`result_${word || "open"}`));
}

function complaint(error) { return h("p", { class: "bad" }, t("not_read", error.message)); }

async function search(place, query, before = null) {
  const filter = new URLSearchParams({ ...query, limit: PAGE, ...(before ? { before } : {}) });
  try {
    const { runs } = await ask(`runs?${filter}`);
    const rows = runs.map((run) => [h("a", { href: `#history/${run.number}` }, `${run.number}`), run.serial, run.recipe_name, run.mode,
      time(run.started), verdict(run.result), run.operator || "—"]);
    const more = runs.length === PAGE ? h("button", { type: "button", onclick: () => search(place, query, runs[runs.length - 1].number) }, t("older")) : null;
    place.replaceChildren(runs.length ? table([t("run_head"), t("serial"), t("recipe"), t("mode"), t("started"), t("result"), t("operator")], rows) : h("p", {}, t("no_runs")), ...(more ? [more] : []));
  } catch (error) { place.replaceChildren(complaint(error)); }
}

function list(root) {
  const serial = h("input", { id: "find-serial", maxlength: 24 });
  const result = h("select", { id: "find-result" }, ["", "good", "bad", "stopped", "aborted", "interrupted", "open"].map((word) => h("option", { value: word }, t(word ? `result_${word}` : "any"))));
  const calibration = h("input", { id: "find-calibration", maxlength: 80 });
  const found = h("section", { id: "found" });
  const go = (event) => { event?.preventDefault(); search(found, { serial: serial.value, result: result.value, calibration: calibration.value }); };
  root.replaceChildren(h("section", {}, h("form", { onsubmit: go }, h("label", {}, t("serial_begins"), serial), h("label", {}, t("result"), result),
    h("label", {}, t("used_calibration"), calibration), h("button", {}, t("search")))), found);
  go();
}

function figures(run) {
  return table([t("figure"), num(t("value")), t("limits"), t("verdict")], run.figures.map((one) => [one.label, num(`${shown(one.value)} ${one.unit}`),
    `${one.lower ?? ""} … ${one.upper ?? ""}`, one.verdict ? verdict(one.verdict) : "—"]));
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
    place.replaceChildren(h("h2", {}, t("run", number), ` · ${run.head.serial} · `, verdict(run.part)),
      run.head.result === "interrupted" ? h("p", { class: "bad" }, t("interrupted_note")) : "",
      h("p", {}, `${time(run.head.started)} – ${time(run.head.ended)} · ${run.head.operator || "—"} · ${run.head.software}`, run.head.simulated ? ` · ${t("simulated")}` : ""),
      run.head.fault ? h("p", { class: "bad" }, run.head.fault) : "",
      h("p", {}, h("a", { href: `/api/v1/runs/${number}/report`, download: "" }, t("report"))),
      figures(run), ...passes(run), h("h2", {}, t("steps")), table([t("step"), t("label"), t("began"), t("ended")], run.phases.map((one) => [one.number, one.label, time(one.began), time(one.ended)])),
      run.gauges.length ? table([t("hole"), num("mm"), t("source"), t("started"), t("verdict"), ""], run.gauges.map((one) => [one.hole, num(shown(one.diameter_mm, 2)), one.source, time(one.time), verdict(one.verdict), one.counts ? "" : t("superseded")])) : "",
      h("div", { class: "pictures" }, images.map((file) => h("figure", {}, h("img", { loading: "lazy", src: `/api/v1/runs/${number}/artefacts/${file.name}`, alt: file.name }), h("figcaption", {}, file.name)))));
  } catch (error) { place.replaceChildren(complaint(error)); }
}

export function build(root, number) { if (number) detail(root, number); else list(root); }
export function update() {}
