// Inputs over time: what a scene gives, and what was driven. A change holds from its instant until the next.

/** @typedef {{t_s: number, signals: Record<string, number>}} Change */

const USUAL_V = 12;
const HELD_S = 0.01; // tables and sines are held over this time

/** The inputs of a scene as changes. @param {any[]} inputs @param {number} duration_s @returns {Change[]} */
export function changesOf(inputs, duration_s) {
  const instants = new Set([0]);
  for (const each of inputs)
    if (each.kind === "steps") each.t_s.forEach((/** @type {number} */ t) => instants.add(t));
    else for (let k = 0; k * HELD_S < duration_s; k++) instants.add(k * HELD_S);
  return [...instants].sort((a, b) => a - b).map((t_s) => ({ t_s, signals: signalsAt(inputs, t_s) }));
}

function signalsAt(/** @type {any[]} */ inputs, /** @type {number} */ t_s) {
  /** @type {Record<string, number>} */
  const signals = {};
  for (const each of inputs) signals[each.signal] = (signals[each.signal] ?? 0) + valueAt(each, t_s);
  return signals;
}

function valueAt(/** @type {any} */ input, /** @type {number} */ t_s) {
  if (input.kind === "sine")
    return input.amplitude * Math.sin(2 * Math.PI * input.frequency_Hz * t_s + (input.phase_rad ?? 0));
  const next = input.t_s.findIndex((/** @type {number} */ t) => t > t_s);
  const last = (next < 0 ? input.t_s.length : next) - 1;
  if (input.kind === "steps") return last < 0 ? 0 : input.value[last];
  if (last < 0 || next < 0) return input.value[Math.max(last, 0)];
  const part = (t_s - input.t_s[last]) / (input.t_s[next] - input.t_s[last]);
  return input.value[last] + part * (input.value[next] - input.value[last]);
}

/** Lists of inputs that have no item for each wheel: how long they are. @type {Record<string, number>} */
const LENGTHS = { body_force_N: 2, world_force_N: 2, world_force_point_m: 2, steering_twist: 3 };

/** Signals as setInput() of a robot with so many wheels takes them; those of hinges are by their names. */
export function inputOf(/** @type {Record<string, number>} */ signals, /** @type {number} */ wheels) {
  /** @type {Record<string, any>} */
  const input = {};
  for (const [signal, value] of Object.entries(signals)) {
    const [name, item] = signal.split(/[[\]]/);
    if (item === undefined) input[name] = value;
    else if (Number.isNaN(Number(item))) (input[name] ??= {})[item] = value;
    else (input[name] ??= [])[Number(item) - 1] = value;
  }
  for (const [name, values] of Object.entries(input))
    if (Array.isArray(values))
      input[name] = Array.from({ length: LENGTHS[name] ?? wheels }, (_, i) => values[i] ?? 0);
  return input;
}

/** The largest voltage that the scene gives by such signals, its supply, or 12 V. */
export function mostVoltage(/** @type {any} */ scene, signals = "voltage_V") {
  const given = (scene.input ?? []).filter((/** @type {any} */ each) => each.signal.startsWith(signals));
  const values = given.flatMap((/** @type {any} */ each) => each.value ?? [each.amplitude]).map(Math.abs);
  return scene.vehicle.drive?.supply_V ?? (Math.max(0, ...values) || USUAL_V);
}

/** One signal of each wheel. */
export function perWheel(/** @type {string} */ name, /** @type {number[]} */ values) {
  return Object.fromEntries(values.map((value, index) => [`${name}[${index + 1}]`, value]));
}

export function sameSignals(/** @type {Record<string, number>} */ a, /** @type {Record<string, number>} */ b) {
  const names = new Set([...Object.keys(a), ...Object.keys(b)]);
  return [...names].every((name) => (a[name] ?? 0) === (b[name] ?? 0));
}

/** The changes as inputs of a scene, each signal with its own instants; signals that are always 0 are left out. */
export function inputsOf(/** @type {Change[]} */ changes) {
  const names = new Set(changes.flatMap(({ signals }) => Object.keys(signals)));
  return [...names]
    .sort()
    .map((signal) => stepsOf(signal, changes))
    .filter(({ t_s }) => t_s.length > 0);
}

function stepsOf(/** @type {string} */ signal, /** @type {Change[]} */ changes) {
  /** @type {{signal: string, kind: string, t_s: number[], value: number[]}} */
  const steps = { signal, kind: "steps", t_s: [], value: [] };
  let now = 0;
  for (const { t_s, signals } of changes) {
    const value = signals[signal] ?? 0;
    if (value === now) continue;
    steps.t_s.push(t_s);
    steps.value.push(value);
    now = value;
  }
  return steps;
}
