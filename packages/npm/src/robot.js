// One robot: made of a scene, stepped with an input held, read by its outputs.
import { Refused } from "./refused.js";
import { SceneSetter } from "./scene.js";

const INPUTS = [
  "voltage_V",
  "axle_torque_Nm",
  "body_force_N",
  "body_moment_Nm",
  "world_force_N",
  "world_force_point_m",
];
const PER_POINT = ["normal_N"];
const FIRST_OF_FRICTION = "slip_along_m_per_s";

/** Refused for a velocity or acceleration that is left out or is not finite. */
function checkFinite(/** @type {Record<string, number>} */ values) {
  for (const [name, value] of Object.entries(values))
    if (!Number.isFinite(value))
      throw new Refused(name, `${value} is not a finite number; give forward, left and turn`, "not finite");
}

/** A robot at its start. Call free() when it is no longer needed: its memory is used again. */
export class Robot {
  #pointer = 0;

  /** @param {import("./module.js").Module} module @param {any} scene @param {string} method @param {number} step_s */
  constructor(module, scene, method, step_s) {
    this.module = module;
    this.c = module.c;
    this.#pointer = this.c.laconic_web_new();
    if (!this.#pointer) throw new RangeError("no memory for another robot; free some");
    try {
      this.begin(scene, method, step_s);
    } catch (refused) {
      this.free();
      throw refused;
    }
  }

  /** Its place in the module's memory; Refused after free(), since another robot may be there. */
  get pointer() {
    if (!this.#pointer) throw new Refused("robot", "was freed; make another by robot()", "freed");
    return this.#pointer;
  }

  /** @param {any} scene @param {string} method @param {number} step_s */
  begin(scene, method, step_s) {
    new SceneSetter(this.module, this.pointer).set(scene);
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

  /** Sets what acts from now on; every input that is not given becomes 0. */
  setInput(/** @type {Record<string, number | ArrayLike<number>>} */ input) {
    this.c.laconic_web_clear_input(this.pointer);
    for (const [name, given] of Object.entries(input)) {
      if (!INPUTS.includes(name))
        throw new Refused(name, `there is no such input; use ${INPUTS.join(", ")}`, "unknown key");
      if (typeof given === "number") this.setOne(name, 0, given);
      else for (let i = 0; i < given.length; i++) this.setOne(`${name}[#]`, i + 1, given[i]);
    }
  }

  setOne(/** @type {string} */ path, /** @type {number} */ item, /** @type {number} */ value) {
    const number = this.module.fields.get(path);
    if (number === undefined || !this.c.laconic_web_set(this.pointer, number, item, value))
      throw new Refused(path.replace("#", String(item)), "the robot has no such input", "unknown key");
  }

  /** Takes steps with the input held. */
  run(/** @type {number} */ steps) {
    if (!Number.isSafeInteger(steps) || steps < 0)
      throw new RangeError(`steps: ${steps} is no whole number of steps; give 0 or more`);
    for (let left = steps; left > 0; left -= Math.min(left, 2 ** 30))
      this.check(this.c.laconic_web_run(this.pointer, Math.min(left, 2 ** 30)));
  }

  get steps() {
    return this.c.laconic_web_steps(this.pointer);
  }

  get time_s() {
    return this.steps * /** @type {number} */ (this.step_s);
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
    return this.wanted(this.c.laconic_web_voltages_for(this.pointer, forward, left, turn));
  }

  /** Least axle torques that give an acceleration of the body's origin from rest. */
  torquesFor(/** @type {number} */ forward, /** @type {number} */ left, /** @type {number} */ turn) {
    checkFinite({ forward, left, turn });
    return this.wanted(this.c.laconic_web_torques_for(this.pointer, forward, left, turn));
  }

  wanted(/** @type {number} */ pointer) {
    return pointer
      ? this.module.reals(pointer, /** @type {number} */ (this.wheelCount))
      : new Array(this.wheelCount).fill(0);
  }

  /** The velocity of the body's origin, nearest to this one, that the wheels allow: forward, left, turn. */
  allowed(/** @type {number} */ forward, /** @type {number} */ left, /** @type {number} */ turn) {
    return [0, 1, 2].map((k) => this.c.laconic_web_allowed(this.pointer, forward, left, turn, k));
  }

  /** Motor gain of a wheel, from 0 [N·m/V]; 0: it has no motor. */
  motorGain(/** @type {number} */ wheel) {
    return this.c.laconic_web_motor_gain(this.pointer, wheel);
  }

  /** Gives its memory back; a second time does nothing. */
  free() {
    if (this.#pointer) this.c.laconic_web_free(this.#pointer);
    this.#pointer = 0;
  }
}
