// One vehicle with hinges: made of a scene, stepped with an input held, read by its outputs.
import { askFinite, askKeys, askNumber, askNumbers, askSteps, askTable } from "./checks.js";
import { Handle } from "./handle.js";
import { Commands, SlippingCommands, isBetween, isStopped } from "./hinge_commands.js";
import { refusedForGround, slipsOn } from "./hinge_friction.js";
import { InputReader, axleOf } from "./hinge_inputs.js";
import { CARRIAGE, HINGE_KINDS, inTables, readHinges } from "./hinge_tables.js";
import { Refused } from "./refused.js";
import { SceneSetter, inRad } from "./scene.js";

/** @typedef {import("./hinge_tables.js").Hinge} Hinge */

const ALLOWED = 1e-9; // of the size of a start: what rounding may change of it
const HINGED_START = ["velocity_body_m_per_s", "yaw_rate_rad_per_s", "x_m", "y_m", "heading_rad"];
const WHEELS_STAND = "wheel_speed_rad_per_s"; // of a start with speeds of wheels
const WITHOUT_NUMBERS = ["name", "parent", "hinge"];
const PER_WHEEL = /^(?:wheel|along|lateral|brake|slip|contact|scrub)_/;
const FIRST_OF_SLIPPING = "slip_along_m_per_s";
const REACTIONS = ["wheel_torque_Nm", "along_N", "lateral_N", "brake_Nm", "hinge_torque_Nm", "hinge_force_N"];

/** Sets all numbers of a scene with hinges in a robot. */
class HingedSetter extends SceneSetter {
  /** @param {any} scene @param {import("./hinge_tables.js").Hung} found */
  setHinged(scene, found) {
    const slips = slipsOn(scene.ground);
    if (!slips) checkIdeal(scene);
    if (scene.initial !== undefined)
      askKeys("initial", inRad("initial", scene.initial), [...HINGED_START, ...(slips ? [WHEELS_STAND] : [])]);
    const { body, caster, trailer, ...vehicle } = scene.vehicle;
    this.set({ ...scene, vehicle: { ...vehicle, wheel: found.wheels.map(({ table }) => table) } });
    const numbers = new Map([[CARRIAGE, 0], ...found.bodies.map(({ name }, k) => /** @type {const} */ ([name, k + 1]))]);
    this.put("vehicle.body", 0, found.bodies.length);
    found.bodies.forEach((each, k) => {
      this.put("vehicle.body[#].parent", k + 1, numbers.get(each.parent) ?? 0);
      this.put("vehicle.body[#].hinge", k + 1, HINGE_KINDS.indexOf(each.hinge) + 1);
      for (const [key, value] of Object.entries(each))
        if (!WITHOUT_NUMBERS.includes(key)) this.put(`vehicle.body[#].${key}`, k + 1, value);
    });
    found.wheels.forEach(({ body, contact }, k) => {
      this.put("vehicle.wheel[#].body", k + 1, numbers.get(body) ?? 0);
      for (const [key, value] of Object.entries(contact)) this.put(`vehicle.wheel[#].${key}`, k + 1, value);
    });
  }

  put(/** @type {string} */ path, /** @type {number} */ item, /** @type {number} */ value) {
    this.module.c.laconic_web_set(this.robot, this.module.fields.get(path), item, value);
  }

  /** A velocity goes to the core when the vehicle is prepared. */
  velocity() {}
}

/** Refused for what acts on ground with friction alone. */
function checkIdeal(/** @type {any} */ { ground, vehicle }) {
  const paths = [
    ...Object.keys(ground ?? {})
      .filter((key) => !key.startsWith("slope_"))
      .map((key) => `ground.${key}`),
    ...(vehicle.drive === undefined ? [] : ["vehicle.drive"]),
    ...Array.from(vehicle.wheel ?? [], (/** @type {any} */ each, k) =>
      each.motor_circuit === undefined || each.motor_circuit === "driven" ? "" : `vehicle.wheel[${k + 1}].motor_circuit`,
    ).filter(Boolean),
  ];
  if (paths.length) throw refusedForGround(paths[0]);
}

/** A vehicle with hinges at its start. Call free() when it is no longer needed: its memory is used again. */
export class HingedRobot extends Handle {
  /** @type {any} what acts, as checked */
  #input = { plain: [], named: [], rates: {}, targets: {}, twist: undefined };
  hasFriction = false; // of the ground: wheels may slip

  /** @param {import("./module.js").Module} module @param {any} scene @param {string} method @param {number} step_s */
  constructor(module, scene, method, step_s) {
    super(module);
    askTable("vehicle", scene.vehicle, "give an object with mass_kg and the vehicle's other keys");
    this.hasFriction = slipsOn(scene.ground);
    const found = readHinges(scene.vehicle, this.hasFriction);
    this.hinges = found.hinges;
    this.bodies = found.hinges.map(({ name }) => name);
    this.parents = found.bodies.map(({ parent }) => this.bodies.indexOf(parent) + 1); // 0: the carriage
    this.wheelPlaces = found.wheels.map(({ place }) => place);
    this.wheelCount = found.wheels.length;
    this.bodyCount = found.hinges.length;
    this.step_s = step_s;
    const Kind = this.hasFriction ? SlippingCommands : Commands;
    this.pointCount = this.wheelCount + (scene.vehicle.support?.length ?? 0);
    this.wheelsStand = Boolean(scene.initial?.[WHEELS_STAND]?.length);
    this.ordered = new Kind(found.hinges, /** @type {any[]} */ (found.bodies), axleOf(found.wheels).x_m);
    this.reader = new InputReader(found.hinges, found.wheels, this.ordered);
    this.watched = found.hinges.flatMap((hinge) =>
      !this.hasFriction && ["free", "motor"].includes(hinge.kind) && isStopped(hinge) ? [hinge] : [],
    );
    this.acting = this.ordered.rest();
    this.take(() => this.begin(scene, found, method));
  }

  /** @param {any} scene @param {import("./hinge_tables.js").Hung} found @param {string} method */
  begin(scene, found, method) {
    new HingedSetter(this.module, this.pointer).setHinged(scene, found);
    askNumber("run.step_s", this.step_s);
    for (const [what, count, most] of /** @type {[string, number, number]} */ [
      ["vehicle.body", this.bodyCount, this.c.laconic_web_max_bodies()],
      ["vehicle.wheel", this.wheelCount, this.c.laconic_web_max_wheels()],
    ])
      if (count > most)
        throw new Refused(what, `${count} of them, but the core has room for ${most}; take some out`, "too many");
    const number = this.module.methods.find((each) => each.name === method)?.number ?? -1;
    if (this.hasFriction && method !== "auto")
      throw new Refused("run.method", `${method} does not step wheels that may slip; give auto`, "no such method");
    this.check(this.c.laconic_web_prepare(this.pointer, number, this.step_s, this.hasFriction ? 1 : 0));
    this.setStart(inRad("initial", scene.initial ?? {}));
    this.place();
  }

  /** Velocities of the start; hinges that follow their wheels begin as these roll. */
  setStart(/** @type {any} */ { velocity_body_m_per_s = [0, 0], yaw_rate_rad_per_s = 0 }) {
    const velocity = askNumbers("initial.velocity_body_m_per_s", velocity_body_m_per_s, 2, "ahead and to the left"),
      turn = askFinite("initial.yaw_rate_rad_per_s", yaw_rate_rad_per_s);
    this.put("initial.velocity_m_per_s[#]", velocity);
    this.put("initial.yaw_rate_rad_per_s[#]", [turn]);
    const rates = this.hasFriction ? this.hinges.map(({ rate }) => rate) : this.rollingRates(velocity, turn);
    this.putAngles(this.hinges.map(({ angle }) => angle));
    this.put("initial.hinge_rate_rad_per_s[#]", rates);
    this.startSize = Math.max(...[...velocity, turn, ...rates].map(Math.abs));
  }

  rollingRates(/** @type {number[]} */ velocity, /** @type {number} */ turn) {
    const twists = [{ x: velocity[0], y: velocity[1], turn }];
    return this.hinges.map(({ angle, rate }, k) => {
      const above = twists[this.parents[k]];
      const [x, y, axle_x, axle_y] = [0, 1, 2, 3].map((each) => this.c.laconic_web_link(this.pointer, k + 1, each));
      const ahead = above.x - above.turn * y,
        aside = above.y + above.turn * x,
        cosine = Math.cos(angle),
        sine = Math.sin(angle);
      const own = { x: ahead * cosine + aside * sine, y: aside * cosine - ahead * sine };
      const follows = this.c.laconic_web_follows(this.pointer, k + 1);
      const own_turn = follows ? -(axle_x * own.x + axle_y * own.y) : above.turn + rate;
      twists.push({ ...own, turn: own_turn });
      return own_turn - above.turn;
    });
  }

  put(/** @type {string} */ path, /** @type {number[]} */ values) {
    const field = this.module.fields.get(path);
    values.forEach((value, k) => this.c.laconic_web_set(this.pointer, field, k + 1, value));
  }

  putAngles(/** @type {number[]} */ angles) {
    this.put("initial.hinge_angle_rad[#]", angles);
  }

  /** Puts the vehicle at its start under the input. Rates of hinges begin with the first step, as after any jump. */
  place() {
    this.ordered.begin(this.hinges);
    this.act({ rates: this.ordered.prescribed.map(({ name }) => ({ name, rate: 0 })), twist: this.ordered.twist });
    if (this.hasFriction) this.putAngles(this.hinges.map(({ name }) => this.ordered.angles.get(name) ?? 0));
    this.check(this.c.laconic_web_place(this.pointer, this.wheelsStand ? 1 : 0));
    if (this.hasFriction || !(this.c.laconic_web_changed(this.pointer) > ALLOWED * Math.max(1, this.startSize ?? 0))) return;
    const { velocity_body_m_per_s: near, yaw_rate_rad_per_s: turn } = this.outputs();
    throw new Refused(
      "initial.velocity_body_m_per_s",
      `this start makes a fixed wheel slide; the nearest motion that all wheels allow is [${near.join(", ")}] m/s with ` +
        `a yaw rate of ${turn} rad/s`,
      "start against constraints",
    );
  }

  check(/** @type {number} */ status) {
    if (status !== 0) throw inTables(Refused.of(this.module, this.pointer), this.hinges, this.wheelPlaces);
  }

  /** Sets what acts from now on; every input that is not given becomes 0. A refused one changes nothing. Before the
   * first step it also sets where coordinated wheels point at the start. */
  setInput(/** @type {any} */ input) {
    const before = this.#input,
      pointer = this.pointer;
    this.use(this.reader.read(input));
    if (this.c.laconic_web_steps(pointer) > 0) return;
    try {
      this.place();
    } catch (refused) {
      this.use(before);
      this.place();
      throw refused;
    }
  }

  use(/** @type {any} */ input) {
    this.c.laconic_web_clear_input(this.pointer);
    this.#input = input;
    for (const { name, values, isOne } of input.plain)
      if (isOne) this.c.laconic_web_set(this.pointer, this.module.fields.get(name), 0, values[0]);
      else this.put(`${name}[#]`, values);
    for (const { name, numbers } of input.named)
      for (const [hinge, value] of Object.entries(numbers))
        this.c.laconic_web_set(this.pointer, this.fieldOf(name), this.bodies.indexOf(hinge) + 1, value);
    this.ordered.set(input.rates, input.targets, input.twist);
    this.act(this.acting);
  }

  fieldOf(/** @type {string} */ name) {
    return this.module.fields.get(`${name}[#]`);
  }

  /** @param {import("./hinge_commands.js").Acting} acting */
  act(acting) {
    for (const { name, rate, angle = 0 } of acting.rates) {
      const item = this.bodies.indexOf(name) + 1;
      this.c.laconic_web_set(this.pointer, this.fieldOf("hinge_rate_rad_per_s"), item, rate);
      if (this.hasFriction) this.c.laconic_web_set(this.pointer, this.fieldOf("hinge_angle_rad"), item, angle);
    }
    if (this.ordered.coordinated.length && !this.hasFriction) this.put("twist[#]", acting.twist);
    this.acting = acting;
  }

  /** Takes steps with the input held. */
  run(/** @type {number} */ steps) {
    const { pointer } = this;
    for (let left = askSteps(steps); left > 0; ) {
      const count = this.ordered.isSettled && !this.watched.length ? Math.min(left, 2 ** 30) : 1;
      if (count > 1) this.runSettled(pointer, count);
      else this.runOne(pointer);
      left -= count;
    }
  }

  runSettled(/** @type {number} */ pointer, /** @type {number} */ count) {
    this.act(this.ordered.rest());
    try {
      this.check(this.c.laconic_web_run(pointer, count));
    } finally {
      this.takeAngles(pointer);
    }
  }

  /** Prescribed hinges at a rate end where the core says. */
  takeAngles(/** @type {number} */ pointer) {
    const { prescribed, targets, angles } = this.ordered;
    if (!prescribed.length || this.hasFriction) return;
    const now = this.hingeAngles(pointer);
    for (const { name } of prescribed) if (!targets.has(name)) angles.set(name, now[name]);
  }

  /** @returns {Record<string, number>} */
  hingeAngles(/** @type {number} */ pointer) {
    return this.read(this.c.laconic_web_outputs(pointer), (name) => name === "hinge_angle_rad").hinge_angle_rad;
  }

  runOne(/** @type {number} */ pointer) {
    const acted = this.acting,
      next = this.ordered.step(this.time_s, this.step_s);
    try {
      this.act(next);
      this.check(this.c.laconic_web_run(pointer, 1));
      this.checkStops(pointer);
    } catch (refused) {
      next.undo();
      this.act(acted);
      throw refused;
    }
  }

  /** A free or motor hinge that comes to its stop ends the run before that step. */
  checkStops(/** @type {number} */ pointer) {
    if (!this.watched.length) return;
    const angles = this.hingeAngles(pointer);
    for (const hinge of this.watched) {
      const angle = angles[hinge.name];
      if (isBetween(hinge, angle)) continue;
      this.c.laconic_web_back(pointer);
      const limit = angle < hinge.low ? hinge.low : hinge.high;
      throw new Refused(
        `${hinge.place} (${hinge.name})`,
        `comes to its stop at ${limit} rad, and the model has no stops that push back; steer or start so that it stays ` +
          "between them, or take the stop out",
        "hinge at stop",
        angle,
        limit,
      );
    }
  }

  /** What acts: the twist along which coordinated wheels point, and the rates of prescribed hinges. */
  get commands() {
    const { rates, twist } = this.acting;
    const found = { steering_rate_rad_per_s: Object.fromEntries(rates.map(({ name, rate }) => [name, rate])) };
    return this.ordered.coordinated.length ? { ...found, steering_twist: [...twist] } : found;
  }

  /** Which limits held commands back, since when and for how many steps. */
  get limited() {
    return [...this.ordered.limited.values()].map((each) => ({ ...each }));
  }

  /** All outputs that follow from the motion at this moment: lists by wheel, objects by the names of hinges. */
  outputs() {
    const at = this.c.laconic_web_outputs(this.pointer);
    const { velocity_m_per_s, ...rest } = this.read(at, (name, slips) =>
      slips ? this.hasFriction : !REACTIONS.includes(name),
    );
    return /** @type {Record<string, any>} */ ({ velocity_body_m_per_s: velocity_m_per_s, ...rest });
  }

  /** Forces that ground and hinges must deliver at this moment. @throws Refused where wheels allow no motion */
  reactions() {
    if (this.hasFriction)
      throw new Refused("reactions", "are those of ideal ground; read the forces in outputs()", "no reactions");
    this.check(this.c.laconic_web_reactions(this.pointer));
    const at = this.c.laconic_web_outputs(this.pointer);
    const { hinge_force_N, hinge_torque_Nm, ...rest } = this.read(at, (name, slips) => !slips && REACTIONS.includes(name));
    const along = (/** @type {number} */ which) =>
      Object.fromEntries(this.bodies.map((name, k) => [name, hinge_force_N[2 * k + which]]));
    return {
      ...rest,
      hinge_reaction_Nm: hinge_torque_Nm,
      hinge_force_along_N: along(0),
      hinge_force_across_N: along(1),
    };
  }

  read(/** @type {number} */ at, /** @type {(name: string, ofSlipping: boolean) => boolean} */ isWanted) {
    /** @type {Record<string, any>} */
    const found = {};
    let ofSlipping = false;
    for (const { name, offset, count } of this.module.outputs) {
      ofSlipping ||= name === FIRST_OF_SLIPPING;
      if (isWanted(name, ofSlipping)) found[name] = this.shaped(name, this.module.reals(at + offset, count));
    }
    return found;
  }

  shaped(/** @type {string} */ name, /** @type {number[]} */ values) {
    if (values.length === 1) return values[0];
    if (name === "velocity_m_per_s" || name === "hinge_force_N") return values;
    if (name === "normal_N") return values.slice(0, this.pointCount);
    if (name === "motor_current_A" || name === "drive_limit") return values.slice(0, this.wheelCount + this.bodyCount);
    if (PER_WHEEL.test(name)) return values.slice(0, this.wheelCount);
    return Object.fromEntries(this.bodies.map((each, k) => [each, values[k]]));
  }
}
