// What a hinge and its wheels have on ground with friction alone: servos, loops, stops, dry friction, scrub, creep.
import { isStopped } from "./hinge_commands.js";
import { Refused } from "./refused.js";

const OF_HINGES = ["com_z_m", "dry_friction_Nm"];
const GAIN = "servo_gain_Nm_per_rad";
const OF_SERVOS = [GAIN, "servo_damping_Nms", "servo_limit_Nm"];
const OF_LOOPS = ["loop_V_per_rad", "loop_Vs_per_rad"];
const PERIOD = "control_period_s";
export const OF_WHEELS = ["load_N", "scrub_radius_m", "scrub_fade_m", "creep"];
const OF_TURNED = [...OF_HINGES, ...OF_SERVOS, ...OF_LOOPS, PERIOD];
/** All keys of a wheel or body that act on ground with friction alone. */
export const ON_FRICTION = [...OF_TURNED, ...OF_WHEELS, "hitch"];
const NO_STOP_RAD = 1e6; // on one side of a hinge that has a stop on the other

/** Whether the ground of a scene lets wheels slip. */
export function slipsOn(/** @type {any} */ ground) {
  return ground?.friction_coefficient !== undefined;
}

export function noEffect(/** @type {string} */ path, /** @type {string} */ explanation) {
  return new Refused(path, explanation, "no effect");
}

export function parentKey(/** @type {import("./hinge_tables.js").Hinge} */ hinge) {
  return hinge.place.startsWith("vehicle.wheel") ? "body" : "parent";
}

export function refusedForGround(/** @type {string} */ path) {
  const told = "acts on ground with friction alone; give ground.friction_coefficient, or take it out";
  return noEffect(path, told);
}

/** The keys of a table that are given, with their values. @returns {Record<string, any>} */
function givenOf(
  /** @type {string} */ place,
  /** @type {any} */ given,
  /** @type {any} */ own,
  /** @type {string[]} */ keys,
  /** @type {boolean} */ slips,
) {
  const known = keys.filter((key) => given[key] !== undefined);
  if (known.length && !slips) throw refusedForGround(`${place}.${known[0]}`);
  return Object.fromEntries(known.map((key) => [key, own[key]]));
}

/** Load, scrub and creep of a wheel. @returns {Record<string, number>} */
export function contactOf(
  /** @type {string} */ place,
  /** @type {any} */ given,
  /** @type {any} */ own,
  /** @type {boolean} */ slips,
) {
  const found = givenOf(place, given, own, OF_WHEELS, slips);
  if (found.scrub_fade_m && !found.scrub_radius_m) throw needing(`${place}.scrub_fade_m`, "scrub_radius_m");
  return found;
}

function needing(/** @type {string} */ path, /** @type {string} */ other) {
  return noEffect(path, `has no effect without ${other}; give it, too`);
}

/**
 * A part with what acts on its hinge where wheels slip: there a servo, a rate or a motor turns each hinge.
 * @param {import("./hinge_tables.js").Part} part @param {any} given @param {any} own @param {boolean} slips
 * @returns {import("./hinge_tables.js").Part}
 */
export function turnedBy(part, given, own, slips) {
  const { hinge, wheels } = part,
    { kind, place } = hinge;
  const more = givenOf(place, given, own, OF_TURNED, slips);
  if (!slips) return part;
  checkControl(place, kind, more);
  const body = { ...part.body, ...more };
  if (kind === "coordinated" && body.parent !== "carriage")
    throw new Refused(
      `${place}.${parentKey(hinge)}`,
      "a coordinated hinge is on the carriage; take it out, or give the hinge a servo of its own",
      "coordinated on body",
    );
  if (kind === "coordinated" || kind === "servo") body.hinge = body[GAIN] ? "free" : "prescribed";
  if (body.hinge !== "prescribed" && isStopped(hinge)) {
    body.stop_low_rad = Math.max(hinge.low, -NO_STOP_RAD);
    body.stop_high_rad = Math.min(hinge.high, NO_STOP_RAD);
  }
  const follows = body[GAIN] || body[OF_LOOPS[0]] ? "angle" : body[OF_LOOPS[1]] ? "rate" : "";
  return { body, hinge: { ...hinge, follows }, wheels };
}

function checkControl(/** @type {string} */ place, /** @type {string} */ kind, /** @type {Record<string, any>} */ more) {
  const hasServo = Boolean(more[GAIN]);
  for (const key of OF_SERVOS) {
    if (key in more && (kind === "motor" || kind === "prescribed"))
      throw noEffect(
        `${place}.${key}`,
        `is of a servo, and this hinge is "${kind}"; take it out, or give the hinge a servo`,
      );
    if (key in more && !hasServo) throw needing(`${place}.${key}`, GAIN);
  }
  for (const key of OF_LOOPS)
    if (key in more && kind !== "motor")
      throw noEffect(
        `${place}.${key}`,
        `is of a loop of a motor, and this hinge is "${kind}"; take it out, or make it "motor"`,
      );
  if (PERIOD in more && !(hasServo || OF_LOOPS.some((key) => more[key])))
    throw noEffect(
      `${place}.${PERIOD}`,
      `is of a servo or loop, and there is none; give ${GAIN} or ${OF_LOOPS[0]}, too`,
    );
  if (kind === "servo" && !hasServo)
    throw new Refused(
      `${place}.${GAIN}`,
      "is missing; give the torque of the servo per radian that it is off",
      "missing",
    );
}
