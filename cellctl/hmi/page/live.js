// The stream of the cell, and how old its content is.
//
// Age is judged by the content: on a slow line events come steadily and are seconds old. No clocks of
// two PCs need to agree: the page asks for the cell's clock at its own time t0 and is answered m, so at
// its time p the cell's clock is at most m + (p - t0).

import { whole } from "./whole.js";

const STALE_S = 1.5;
const CLOCK_EVERY_MS = 2000;
const CLOCKS_KEPT = 30;
const SILENT_S = 3;

export const cell = { snapshot: null, description: null, refused: "" };
const offsets = [];
const watchers = new Set();
let stream = null;
let hidden = 0;
let heardS = 0;

const page = () => performance.now() / 1000;

export function watch(watcher) { watchers.add(watcher); }
const tell = (what) => watchers.forEach((watcher) => watcher(what));

export function ageS() {
  if (!cell.snapshot || !offsets.length) return Infinity;
  return Math.max(0, Math.min(...offsets) + page() - cell.snapshot.mono_s);
}

export const stale = () => ageS() > STALE_S;

async function askClock() {
  const t0 = page();
  try {
    const answer = await fetch("/api/v1/clock", { signal: AbortSignal.timeout(4000), cache: "no-store" });
    if (!answer.ok) return;
    offsets.push((await answer.json()).mono_s - t0);
    if (offsets.length > CLOCKS_KEPT) offsets.shift();
    // Whoever answers sends a beat each second. A stream without one died while the cable was out, and
    // nobody has told the browser, which would listen to it for ever.
    if (stream && page() - heardS > SILENT_S) open();
  } catch { /* no answer: the age goes on growing, which is what the page shows */ }
}

function take(kind, event) {
  heardS = page();
  cell[kind] = whole(kind, JSON.parse(event.data));
  cell.refused = "";
  tell(kind);
}

async function whyNot() {
  // An EventSource does not say why it was refused.
  try {
    const answer = await fetch("/api/v1/session", { cache: "no-store" });
    cell.refused = answer.status === 401 ? "sign_in_first" : "too_many_pages";
  } catch { cell.refused = ""; }
  tell("link");
}

export function open() {
  close();
  heardS = page();
  stream = new EventSource("/api/v1/events");
  stream.addEventListener("beat", () => { heardS = page(); });
  stream.addEventListener("snapshot", (event) => take("snapshot", event));
  stream.addEventListener("description", (event) => take("description", event));
  stream.addEventListener("open", () => tell("open"));
  stream.addEventListener("error", () => {
    if (stream && stream.readyState === EventSource.CLOSED) {
      whyNot();
      setTimeout(open, 3000);
    }
  });
}

function close() {
  if (stream) stream.close();
  stream = null;
}

export function start() {
  open();
  askClock();
  setInterval(askClock, CLOCK_EVERY_MS);
  setInterval(() => tell("tick"), 250);
  document.addEventListener("visibilitychange", () => {
    clearTimeout(hidden);
    if (document.hidden) hidden = setTimeout(close, 10000);
    else if (!stream) open();
    tell("tick");
  });
}
