// The frame of the page: navigation, band, sign-in; one screen at a time.

import * as alarms from "./alarms.js";
import { ask, send } from "./api.js";
import { nobody, onLost, visitor } from "./buttons.js";
import * as calibration from "./calibration.js";
import { h, shown } from "./dom.js";
import * as health from "./health.js";
import * as history from "./history.js";
import * as line from "./line.js";
import { ageS, cell, open, stale, start, watch } from "./live.js";
import * as maintenance from "./maintenance.js";
import * as run from "./run.js";
import { change, load, other, spoken, t } from "./texts.js";

const SCREENS = { run, alarms, history, calibration, maintenance, line, health };
const $ = (id) => document.getElementById(id);
let since = performance.now();
let built = "";
let shownHead = "";

function place() {
  const [name, detail] = location.hash.slice(1).split("/");
  return [name in SCREENS ? name : "run", detail];
}

function head() {
  const [name] = place();
  // Only when something has changed: whoever goes by key would lose their place.
  const key = JSON.stringify([name, visitor, document.documentElement.lang]);
  if (key === shownHead) return;
  shownHead = key;
  $("nav").replaceChildren(...Object.keys(SCREENS).map((one) => h("a", { href: `#${one}`, "aria-current": one === name ? "page" : null }, t(`nav_${one}`))));
  $("language").textContent = other();
  $("simulated").textContent = t("simulated");
  const where = visitor.panel || t("elsewhere");
  $("who").replaceChildren(...(visitor.person ? [visitor.person, h("small", {}, `${t(visitor.idle ? "idle" : `role_${visitor.role}`)} · ${where}`)] : [t("sign_in")]));
}

function title(text) { return spoken(text).split(/: |：/)[0]; }

function band() {
  const place = $("band");
  const s = cell.snapshot;
  let [kind, text, others] = ["", "", ""];
  if (stale()) {
    kind = "p1";
    text = cell.refused ? t(cell.refused) : t("stale", Math.round(Number.isFinite(ageS()) ? ageS() : (performance.now() - since) / 1000));
  } else if (s.alarms.length) {
    const [gravest, ...less] = alarms.byGravity(s.alarms, s.faults[0]?.number);
    kind = `p${alarms.priority(gravest)}`;
    // Each by its title: one of them may be what somebody has to know before the first one is cleared.
    text = `${alarms.mark(gravest)} ${spoken(gravest.text)}`;
    others = less.map((one) => ` · ${alarms.mark(one)} ${title(one.text)}`).join("");
  } else if (s.stop_not_confirmed) [kind, text] = ["p1", t("stop_not_confirmed")];
  if (place.dataset.text === text + others && place.className === kind) return;
  place.className = kind;
  place.dataset.text = text + others;
  // The others have a line of their own: however long the gravest is, it hides none of them, and they hide nothing of it.
  place.replaceChildren(text ? h("a", { href: "#alarms" }, h("span", {}, text), others ? h("span", {}, others) : null) : "");
}

function refresh() {
  const s = cell.snapshot;
  document.body.classList.toggle("stale", stale());
  if (s) {
    $("cell").textContent = s.cell;
    $("simulated").hidden = !s.simulated;
  }
  $("age").textContent = stale() ? `○ ${t("old")}` : `● ${t("live")} ${shown(ageS(), 1)} s`;
  band();
  // Not the one of the address: that changes a moment before its screen is built.
  if (built) SCREENS[built].update($("main"));
}

function show() {
  const [name, detail] = place();
  built = name;
  head();
  SCREENS[name].build($("main"), detail);
  refresh();
}

async function who() {
  // Whoever has no answer is who they were: their Stop has to stay where it is.
  try { Object.assign(visitor, await ask("session")); } catch (error) { if (error.status) Object.assign(visitor, nobody()); }
  head();
}

async function sign() {
  // Whoever has only been idle wants to go on, and not to sign out.
  if (visitor.person && !visitor.idle) {
    await send("DELETE", "session", {});
    await who();
    open();
    return;
  }
  const name = h("input", { id: "name", autocomplete: "username", maxlength: 32 });
  const pin = h("input", { id: "pin", type: "password", inputmode: "numeric", autocomplete: "current-password", maxlength: 128 });
  const said = h("p", { role: "alert" });
  const dialog = h("dialog", { "aria-label": t("sign_in") });
  const go = async (event) => {
    event.preventDefault();
    try {
      Object.assign(visitor, await send("POST", "session", { name: name.value, pin: pin.value }));
      dialog.close();
      head();
      open();
    } catch (error) { said.textContent = error.status === 429 ? t("too_many_tries") : t("wrong_pin"); }
  };
  dialog.append(h("h2", {}, t("sign_in")), h("form", { onsubmit: go }, h("label", {}, t("name"), name), h("label", {}, t("pin"), pin),
    h("button", {}, t("sign_in")), h("button", { type: "button", onclick: () => dialog.close() }, t("cancel"))), said);
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
}

await load();
$("who").addEventListener("click", sign);
$("language").addEventListener("click", async () => { await change(); show(); });
addEventListener("hashchange", show);
watch((what) => {
  if (what === "open") who();  // the page's process may be another one, which knows nobody
  if (what === "snapshot") { since = performance.now(); run.note(cell.snapshot); }
  refresh();
});
await who();
setInterval(who, 30000);
onLost(who);
show();
start();
run.recall();
