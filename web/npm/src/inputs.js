// The inputs of wheels and carriage, which every robot has.
import { askFinite, askNumbers } from "./checks.js";

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
