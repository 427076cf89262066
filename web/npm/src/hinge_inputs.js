// What acts on a vehicle with hinges, by names: checked, so that a refused input changes nothing.
import { PLAIN_INPUTS, askFinite, askKeys, askNumbers, askTable, plainValues } from "./checks.js";
import { CARRIAGE } from "./hinge_tables.js";
import { Refused } from "./refused.js";
import { inPlace } from "./scene.js";

/** @typedef {import("./hinge_tables.js").Hinge} Hinge */

/** Inputs by the names of hinges: which kinds have them. @type {Record<string, string[]>} */
const HINGE_INPUTS = {
  hinge_voltage_V: ["motor"],
  hinge_torque_Nm: ["free", "motor"],
  steering_rate_rad_per_s: ["prescribed"],
  steering_angle_rad: ["prescribed"],
};
const STEERING = ["steering_twist", "steering_curvature_per_m", "steering_angle_rad"]; // of coordinated hinges
const HINGED_INPUTS = [...new Set([...Object.keys(PLAIN_INPUTS), ...Object.keys(HINGE_INPUTS), ...STEERING])];
const ACROSS = 1e-9; // of an axle's direction: rounding

export class InputReader {
  /**
   * @param {Hinge[]} hinges @param {import("./hinge_tables.js").Wheel[]} wheels
   * @param {import("./hinge_commands.js").Commands} commands
   */
  constructor(hinges, wheels, commands) {
    this.hinges = hinges;
    this.wheelCount = wheels.length;
    this.axle = axleOf(wheels);
    this.commands = commands;
  }

  /** An input by its parts. */
  read(/** @type {any} */ input) {
    askKeys("", askTable("input", input, `give an object with any of ${HINGED_INPUTS.join(", ")}`), HINGED_INPUTS);
    const { steering_angle_rad: angle } = input,
      isOfAll = typeof angle === "number";
    const plain = Object.keys(PLAIN_INPUTS)
      .filter((name) => name in input)
      .map((name) => ({ name, values: plainValues(name, input[name], this.wheelCount), isOne: PLAIN_INPUTS[name] === 0 }));
    const byName = (/** @type {string} */ name) =>
      name in input && !(name === "steering_angle_rad" && isOfAll) ? this.byName(name, input[name]) : {};
    const rates = byName("steering_rate_rad_per_s"),
      targets = byName("steering_angle_rad");
    for (const name of Object.keys(targets)) {
      if (Object.hasOwn(rates, name))
        throw new Refused(
          `steering_angle_rad.${name}`,
          `is given besides steering_rate_rad_per_s.${name}; keep one of them`,
          "given twice",
        );
      this.askRateLimit(this.hinges.find((each) => each.name === name));
    }
    const named = ["hinge_voltage_V", "hinge_torque_Nm"].map((name) => ({ name, numbers: byName(name) }));
    return { plain, named, rates, targets, twist: this.twistOf(input, isOfAll) };
  }

  /** Numbers by the names of hinges that have such an input. @returns {Record<string, number>} */
  byName(/** @type {string} */ name, /** @type {any} */ given) {
    const kinds = HINGE_INPUTS[name],
      known = this.hinges.filter((each) => kinds.includes(each.kind) || takes(each, name)).map((each) => each.name);
    const remedy = known.length ? `give numbers for ${known.join(", ")}` : "this vehicle has no such hinge; take it out";
    askTable(name, given, remedy);
    for (const [hinge, value] of Object.entries(given)) {
      if (!known.includes(hinge))
        throw new Refused(`${name}.${hinge}`, `needs a hinge that is ${kinds.join(" or ")}; ${remedy}`, "no such hinge");
      askFinite(`${name}.${hinge}`, value);
    }
    return { ...given };
  }

  /** The twist that is commanded; undefined without a command. */
  twistOf(/** @type {any} */ input, /** @type {boolean} */ isOfAll) {
    const given = STEERING.filter((name) => name in input && (name !== "steering_angle_rad" || isOfAll));
    if (!given.length) return undefined;
    const [name, second] = given,
      value = input[name];
    if (!this.commands.coordinated.length)
      throw new Refused(name, "needs hinges that are coordinated; this vehicle has none; take it out", "no such hinge");
    if (second) throw new Refused(name, `is given besides ${second}; steer by one of them`, "given twice");
    if (name === "steering_twist") return askNumbers(name, value, 3, "ahead, to the left and yaw rate");
    if (!this.axle.isAcross)
      throw new Refused(
        name,
        "needs fixed wheels that roll along the first axis (axle_deg = 90 or -90); give steering_twist",
        "no such axle",
      );
    const number = askFinite(name, value);
    if (name === "steering_curvature_per_m") return this.commands.ofCurvature(number);
    if (!this.commands.coordinated.some(({ rateLimit, follows }) => follows || Number.isFinite(rateLimit)))
      this.askRateLimit(this.commands.coordinated[0]);
    return this.commands.ofAngle(number);
  }

  askRateLimit(/** @type {Hinge | undefined} */ hinge) {
    if (hinge && !hinge.follows && !Number.isFinite(hinge.rateLimit))
      throw new Refused(
        `${hinge.place}.rate_limit_rad_per_s`,
        "is missing; steering_angle_rad is followed within a largest rate, which it must give",
        "missing",
      );
  }
}

/** Whether the servo or loop of a hinge takes such a command, or a servo's hinge a torque. */
function takes(/** @type {Hinge} */ { kind, follows }, /** @type {string} */ name) {
  if (name === "hinge_torque_Nm") return kind === "servo";
  return Boolean(follows) && kind !== "coordinated" && name === `steering_${follows}_rad${follows === "rate" ? "_per_s" : ""}`;
}

/** ξ of the line on which the carriage's own fixed wheels stand; 0 where it has none. */
export function axleOf(/** @type {import("./hinge_tables.js").Wheel[]} */ wheels) {
  const fixed = wheels
    .filter(({ table, body }) => body === CARRIAGE && table.kind === "fixed")
    .map(({ table, place }) => inPlace(place, table));
  return {
    x_m: fixed.length ? Number(fixed[0].x_m) : 0,
    isAcross: fixed.every(({ axle_rad }) => Math.abs(Math.cos(axle_rad)) <= ACROSS),
  };
}
