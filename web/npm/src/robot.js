// One robot: made of a scene, stepped with an input held, read by its outputs.
import { PLAIN_INPUTS, askFinite, askKeys, askNumber, askSteps, askTable, plainValues, toldOf } from "./checks.js";
import { Handle } from "./handle.js";
import { Refused } from "./refused.js";
import { SceneSetter } from "./scene.js";

const PER_POINT = ["normal_N"];
const FIRST_OF_FRICTION = "slip_along_m_per_s";

/** Refused for a velocity or acceleration that is left out or is not finite. */
function checkFinite(/** @type {Record<string, unknown>} */ values) {
  for (const [name, value] of Object.entries(values)) askFinite(name, value, "give forward, left and turn");
}

/** Refused where a result leaves the range of numbers: the largest of what was given is named. */
function checkRange(/** @type {number[]} */ found, /** @type {Record<string, number>} */ given) {
  if (found.every(Number.isFinite)) return found;
  const [[name, value]] = Object.entries(given).sort(([, a], [, b]) => Math.abs(b) - Math.abs(a));
  const told = `${value} leads beyond the range of double precision; give less, or check the robot's units`;
  throw new Refused(name, told, "overflow", value);
}

/** A robot at its start. Call free() when it is no longer needed: its memory is used again. */
export class Robot extends Handle {
  /** @param {import("./module.js").Module} module @param {any} scene @param {string} method @param {number} step_s */
  constructor(module, scene, method, step_s) {
    super(module);
    this.take(() => this.begin(scene, method, step_s));
  }

  /** @param {any} scene @param {string} method @param {number} step_s */
  begin(scene, method, step_s) {
    new SceneSetter(this.module, this.pointer).set(scene);
    askNumber("run.step_s", step_s);
    const found = this.module.methods.find((each) => each.name === method);
    this.step_s = step_s;
    this.wheelCount = scene.vehicle.wheel?.length ?? 0;
    this.pointCount = this.wheelCount + (scene.vehicle.support?.length ?? 0);
    this.check(this.c.laconic_web_start(this.pointer, found ? found.number : -1, step_s));
    this.hasFriction = this.c.laconic_web_has_friction(this.pointer) !== 0;
  }

  check(/** @type {number} */ status) {
    if (status !== 0) throw Refused.of(this.module, this.pointer);
  }

  /** Sets what acts from now on; every input that is not given becomes 0. A refused one changes nothing. */
  setInput(/** @type {any} */ input) {
    const pointer = this.pointer,
      names = Object.keys(PLAIN_INPUTS);
    askKeys("", askTable("input", input, `give an object with any of ${names.join(", ")}`), names);
    const count = /** @type {number} */ (this.wheelCount);
    const found = Object.entries(input).map(([name, given]) => ({ name, values: plainValues(name, given, count) }));
    this.c.laconic_web_clear_input(pointer);
    for (const { name, values } of found) {
      const isOne = PLAIN_INPUTS[name] === 0;
      const field = this.module.fields.get(isOne ? name : `${name}[#]`);
      values.forEach((value, index) => this.c.laconic_web_set(pointer, field, isOne ? 0 : index + 1, value));
    }
  }

  /** Takes steps with the input held. */
  run(/** @type {number} */ steps) {
    const pointer = this.pointer;
    for (let left = askSteps(steps); left > 0; left -= Math.min(left, 2 ** 30))
      this.check(this.c.laconic_web_run(pointer, Math.min(left, 2 ** 30)));
  }

  /** All outputs at this moment, by the names that docs/scenes.md explains. */
  outputs() {
    const at = this.c.laconic_web_outputs(this.pointer);
    /** @type {Record<string, any>} */
    const found = {};
    for (const { name, offset, count } of this.module.outputs) {
      if (name === FIRST_OF_FRICTION && !this.hasFriction) break;
      const wanted = count <= 3 ? count : PER_POINT.includes(name) ? this.pointCount : this.wheelCount;
      const values = this.module.reals(at + offset, /** @type {number} */ (wanted));
      found[name] = count === 1 ? values[0] : values;
    }
    return found;
  }

  /** Least voltages that hold a velocity of the body's origin on ideal ground, one for each wheel. */
  voltagesFor(/** @type {number} */ forward, /** @type {number} */ left, /** @type {number} */ turn) {
    checkFinite({ forward, left, turn });
    return this.wanted(this.c.laconic_web_voltages_for(this.pointer, forward, left, turn), { forward, left, turn });
  }

  /** Least axle torques that give an acceleration of the body's origin from rest; 0 where the wheels cannot roll so. */
  torquesFor(/** @type {number} */ forward, /** @type {number} */ left, /** @type {number} */ turn) {
    checkFinite({ forward, left, turn });
    if (!this.c.laconic_web_rolls(this.pointer)) return new Array(this.wheelCount).fill(0);
    return this.wanted(this.c.laconic_web_torques_for(this.pointer, forward, left, turn), { forward, left, turn });
  }

  wanted(/** @type {number} */ at, /** @type {Record<string, number>} */ given) {
    return checkRange(at ? this.module.reals(at, /** @type {number} */ (this.wheelCount)) : [Number.NaN], given);
  }

  /** The velocity of the body's origin, nearest to this one, that the wheels allow: forward, left, turn. */
  allowed(/** @type {number} */ forward, /** @type {number} */ left, /** @type {number} */ turn) {
    checkFinite({ forward, left, turn });
    const found = [0, 1, 2].map((k) => this.c.laconic_web_allowed(this.pointer, forward, left, turn, k));
    return checkRange(found, { forward, left, turn });
  }

  /** Motor gain of a wheel, from 0 [N·m/V]; 0: it has no motor. */
  motorGain(/** @type {number} */ wheel) {
    const pointer = this.pointer,
      count = /** @type {number} */ (this.wheelCount);
    const remedy = count ? `give 0 to ${count - 1}` : "the robot has none";
    if (!Number.isInteger(wheel) || wheel < 0 || wheel >= count)
      throw new Refused("wheel", `${toldOf(wheel)} is no wheel of this robot; ${remedy}`, "no such wheel");
    return this.c.laconic_web_motor_gain(pointer, wheel);
  }
}
