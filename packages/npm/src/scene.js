// A scene as a robot's numbers: every key by its path in the core's own list of fields.
import { Refused } from "./refused.js";

const KINDS = { omni: 1, mecanum: 1, roller: 1, fixed: 2 };
const CIRCUITS = ["driven", "open", "shorted"];
const TABLES = ["motor", "payload", "drive"];
const RAD_PER_DEG = Math.PI / 180;
const OMNI_ROLLER_RAD = Math.PI / 2;
const ABOVE_0 = { radius_m: "the vehicle's", friction_coefficient: "the ground's" }; // where 0 would mean that
const START = ["x_m", "y_m", "heading_rad"];

/** Sets all numbers of a scene in a robot. */
export class SceneSetter {
  /** @param {import("./module.js").Module} module @param {number} robot */
  constructor(module, robot) {
    this.module = module;
    this.robot = robot;
  }

  /** @param {any} scene */
  set(scene) {
    const vehicle = scene.vehicle ?? {};
    this.table("vehicle", vehicle, [...TABLES, "wheel", "support"]);
    for (const name of TABLES) if (vehicle[name]) this.table(`vehicle.${name}`, vehicle[name]);
    this.module.c.laconic_web_set_motor(this.robot, vehicle.motor ? 1 : 0);
    if (scene.ground) this.table("ground", scene.ground);
    this.list("wheel", vehicle.wheel ?? [], (wheel, name) => this.wheel(wheel, name));
    this.list("support", vehicle.support ?? [], (support) => support);
    this.start(scene.initial ?? {});
  }

  /** @param {string} path @param {any} given @param {string[]} [others] */
  table(path, given, others = []) {
    for (const [key, value] of Object.entries(inRad(given)))
      if (!others.includes(key)) this.number(`${path}.${key}`, `${path}.${key}`, 0, value);
  }

  /** One number; a key that the core's list lacks is refused by its name. */
  number(
    /** @type {string} */ path,
    /** @type {string} */ shown,
    /** @type {number} */ item,
    /** @type {any} */ value,
  ) {
    const number = this.module.fields.get(path);
    if (number === undefined) throw new Refused(shown, "unknown key; take it out or see docs/scenes.md", "unknown key");
    if (typeof value !== "number" && typeof value !== "boolean")
      throw new Refused(shown, `${JSON.stringify(value)} is no number; give one`, "not a number");
    this.module.c.laconic_web_set(this.robot, number, item, Number(value));
  }

  /** Tables of which there are several. Those beyond the core's room are only counted: its check refuses them. */
  list(
    /** @type {string} */ name,
    /** @type {any[]} */ given,
    /** @type {(each: any, name: string) => any} */ numbers,
  ) {
    this.module.c.laconic_web_set(this.robot, this.module.fields.get(`vehicle.${name}`), 0, given.length);
    given.forEach((each, index) => {
      const shown = `vehicle.${name}[${index + 1}]`;
      for (const [key, value] of Object.entries(numbers(each, shown)))
        this.number(`vehicle.${name}[#].${key}`, `${shown}.${key}`, index + 1, value);
    });
  }

  wheel(/** @type {any} */ given, /** @type {string} */ name) {
    const { kind, driven, motor_circuit, ...rest } = inPlace(inRad(given));
    if (!(kind in KINDS))
      throw new Refused(
        `${name}.kind`,
        `there is no ${JSON.stringify(kind)}; use omni, mecanum, roller or fixed`,
        "unknown kind",
      );
    for (const [key, whose] of Object.entries(ABOVE_0))
      if (rest[key] <= 0)
        throw new Refused(
          `${name}.${key}`,
          `${rest[key]} is not positive; give a value above 0, or take it out for ${whose}`,
          "not positive",
        );
    /** @type {Record<string, number | boolean>} */
    const numbers = { kind: KINDS[/** @type {keyof typeof KINDS} */ (kind)], ...rest };
    if (kind !== "fixed") numbers.roller_rad ??= kind === "omni" ? OMNI_ROLLER_RAD : Number.NaN;
    if (driven !== undefined) numbers.undriven = !driven;
    if (motor_circuit !== undefined)
      numbers.motor_circuit = typeof motor_circuit === "string" ? CIRCUITS.indexOf(motor_circuit) : motor_circuit;
    return numbers;
  }

  /** ν, or the velocity of the centre of mass in body axes and the yaw rate. */
  start(/** @type {any} */ given) {
    const start = inRad(given);
    for (const key of START)
      if (start[key] !== undefined) this.number(`initial.${key}`, `initial.${key}`, 0, start[key]);
    for (const key of ["nu_rad_per_s", "wheel_speed_rad_per_s"])
      (start[key] ?? []).forEach((/** @type {number} */ value, /** @type {number} */ index) =>
        this.number(`initial.${key}[#]`, `initial.${key}[${index + 1}]`, index + 1, value),
      );
    const [forward, left] = start.velocity_body_m_per_s ?? [0, 0];
    const turn = start.yaw_rate_rad_per_s ?? 0;
    if (forward !== 0 || left !== 0 || turn !== 0)
      if (this.module.c.laconic_web_start_velocity(this.robot, forward, left, turn))
        throw Refused.of(this.module, this.robot);
  }
}

/** Angles in degrees, by the suffix _deg, become radians. */
function inRad(/** @type {any} */ given) {
  return Object.fromEntries(
    Object.entries(given).map(([key, value]) =>
      key.endsWith("_deg") ? [key.replace(/_deg$/, "_rad"), Number(value) * RAD_PER_DEG] : [key, value],
    ),
  );
}

/** distance_m and bearing_rad become x_m and y_m. */
function inPlace(/** @type {any} */ { distance_m, bearing_rad, ...rest }) {
  if (distance_m === undefined) return rest;
  return { ...rest, x_m: distance_m * Math.cos(bearing_rad), y_m: distance_m * Math.sin(bearing_rad) };
}
