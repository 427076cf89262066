// What is asked of everything that a caller gives: a refusal names it, says what it is, and what to give.
import { Refused } from "./refused.js";

const MOST_SHOWN = 60; // characters of what was given

/** What was given, for one line. */
export function toldOf(/** @type {unknown} */ given) {
  if (isList(given)) return "a list";
  if (typeof given === "function") return "a function";
  if (typeof given === "object" && given !== null) return "an object";
  const text = typeof given === "string" ? JSON.stringify(given) : String(given);
  return text.length > MOST_SHOWN ? `${text.slice(0, MOST_SHOWN)} …` : text;
}

export function isList(/** @type {unknown} */ given) {
  return Array.isArray(given) || (ArrayBuffer.isView(given) && !(given instanceof DataView));
}

/** A text, or nothing. */
export function askText(/** @type {string} */ path, /** @type {unknown} */ given) {
  if (given !== undefined && typeof given !== "string")
    throw new Refused(path, `${toldOf(given)} is no text; give one in quotes, or take it out`, "not a text");
}

/** An object with keys. @param {string} path @param {any} given @returns {Record<string, any>} */
export function askTable(path, given, remedy = "give an object with keys") {
  if (typeof given !== "object" || given === null || isList(given))
    throw new Refused(path, `${toldOf(given)} is no object; ${remedy}`, "not an object");
  return given;
}

/** No key beside these. @param {string} path @param {any} given @param {string[]} keys */
export function askKeys(path, given, keys) {
  for (const key of Object.keys(askTable(path, given)))
    if (!keys.includes(key)) throw unknownKey(path ? `${path}.${key}` : key, keys);
}

export function unknownKey(/** @type {string} */ path, /** @type {string[]} */ keys = []) {
  const known = keys.length ? `the keys are ${keys.join(", ")}` : "see docs/scenes.md";
  return new Refused(path, `unknown key; take it out, or correct it: ${known}`, "unknown key");
}

/** A list. */
export function askList(/** @type {string} */ path, /** @type {unknown} */ given) {
  if (!isList(given)) throw new Refused(path, `${toldOf(given)} is no list; give one of objects`, "not a list");
}

/** true or false. */
export function askFlag(/** @type {string} */ path, /** @type {unknown} */ given) {
  if (typeof given === "boolean") return given;
  throw new Refused(path, `${toldOf(given)} is neither true nor false; give one of them`, "not a boolean");
}

/** A number of steps. */
export function askSteps(/** @type {unknown} */ given) {
  if (Number.isSafeInteger(given) && Number(given) >= 0) return Number(given);
  throw new Refused("steps", `${toldOf(given)} is no whole number of steps; give 0 or more`, "not a whole number");
}

/** A number, of which the core judges what it refuses itself, NaN too. */
export function askNumber(/** @type {string} */ path, /** @type {unknown} */ given, remedy = "give one") {
  if (typeof given !== "number") throw new Refused(path, `${toldOf(given)} is no number; ${remedy}`, "not a number");
  return given;
}

/** A finite one. */
export function askFinite(/** @type {string} */ path, /** @type {unknown} */ given, remedy = "give one") {
  const value = askNumber(path, given, remedy);
  if (Number.isFinite(value)) return value;
  throw new Refused(path, `${value} is not a finite number; ${remedy}`, "not finite", value);
}

/**
 * So many finite numbers; `each` says what they are for.
 * @param {string} path @param {any} given @param {number} count @param {string} each
 */
export function askNumbers(path, given, count, each) {
  const wanted = `give ${count}, ${each}`;
  if (!isList(given)) throw new Refused(path, `${toldOf(given)} is no list of numbers; ${wanted}`, "not a list");
  if (given.length !== count)
    throw new Refused(path, `a list of ${given.length}; ${wanted}`, "wrong length", given.length, count);
  return Array.from(given, (value, index) => askFinite(`${path}[${index + 1}]`, value));
}

// ---- the inputs of wheels and carriage, which every robot has

/** How many numbers an input has: 0, one without a list; WHEELS, one for each wheel. */
const WHEELS = -1;
/** @type {Record<string, number>} */
export const PLAIN_INPUTS = {
  voltage_V: WHEELS,
  axle_torque_Nm: WHEELS,
  body_force_N: 2,
  body_moment_Nm: 0,
  world_force_N: 2,
  world_force_point_m: 2,
};

/** Checked numbers of one of them. @param {string} name @param {any} given @param {number} wheelCount */
export function plainValues(name, given, wheelCount) {
  const count = PLAIN_INPUTS[name];
  if (count === 0) return [askFinite(name, given)];
  return count === WHEELS
    ? askNumbers(name, given, wheelCount, "one for each wheel")
    : askNumbers(name, given, count, "along x and along y");
}
