// A message with every field that the page reads. What the cell has not said, because it is another
// version or has no value, is nothing: null, no words, an empty list. So no screen stops at it and goes
// on showing what was said before.

const LIMITED = { axis: "", unit: "", value: null, limit: null };
const FAULT = { number: null, text: "", cause: "", remedy: "", reaction: "" };

const FIELDS = {
  snapshot: {
    mono_s: null, decision: null, cell: "", simulated: null, state: "", state_requested: "", mode: "", control: "",
    line_alive: null, hold_requested: null, safe_point_ahead: null, stop_not_confirmed: null, pass: null,
    step: { number: null, label: "", text: "" },
    run: { number: null, serial: "", recipe: null, result: "", good_parts: null },
    errors: [LIMITED],
    forces: [{ sensor: "", age_s: null, stale: null, compensated: null, limit_n: null, presses_n: null, trip: "", touch: "", wrench: [LIMITED] }],
    faults: [FAULT], alarms: [{ ...FAULT, since: null, run: null, times: 1, newest: null }],
    last_command: null, permitted: {}, links: {},
  },
  description: {
    calibrations: [{ kind: "", made: null, valid_until: null, problem: "", identity: "" }],
    recipes: [{ number: "—", name: "" }],
    procedures: [{ number: "—", name: "", set_up: [], moves: [], then: [], renews: [] }],
    registers: [{ address: "—", name: "", text: "", unit: "", writer: "", value: null }],
  },
};

const isObject = (value) => typeof value === "object" && value !== null && !Array.isArray(value);

function filled(said, field) {
  if (Array.isArray(field)) {
    const entries = Array.isArray(said) ? said.filter((one) => one !== null && one !== undefined) : [];
    return field.length ? entries.map((one) => filled(one, field[0])) : entries;
  }
  if (!isObject(field)) return said ?? field;
  const given = isObject(said) ? said : {};
  return { ...given, ...Object.fromEntries(Object.entries(field).map(([name, one]) => [name, filled(given[name], one)])) };
}

export const whole = (kind, said) => filled(said, FIELDS[kind]);
