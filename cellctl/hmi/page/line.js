// The registers of the line, as the daemon holds them. Nothing here can be written.

import { h, num, table } from "./dom.js";
import { cell } from "./live.js";
import { colon, t } from "./texts.js";

function block(writer) {
  const items = (cell.description?.registers || []).filter((one) => one.writer === writer);
  const rows = items.map((one) => [num(`${one.address}`), one.name, num(one.value === null ? "—" : `${one.value} ${one.unit}`), one.text]);
  return [h("h2", {}, t(`registers_${writer}`)), table([num(t("address")), t("label"), num(t("value")), t("meaning")], rows)];
}

export const alive = (s) => (s.line_alive === null ? "—" : t(s.line_alive ? "alive" : "not_there"));

let drawn = null;
export function build(root) {
  drawn = null;
  root.replaceChildren(h("section", {}, h("p", { class: "live", id: "line-alive" })), h("section", { class: "live", id: "from-cell" }), h("section", { class: "live", id: "from-line" }));
  update(root);
}

export function update(root) {
  const place = root.querySelector("#line-alive");
  if (!place || !cell.snapshot) return;
  place.textContent = `${t("line_plc")}${colon()}${alive(cell.snapshot)} · ${t(`control_${cell.snapshot.control}`)}`;
  if (drawn === cell.description) return;
  drawn = cell.description;
  root.querySelector("#from-cell").replaceChildren(...block("cell"));
  root.querySelector("#from-line").replaceChildren(...block("line"));
}
