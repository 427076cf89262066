// A scene as a robot's numbers: every key by its path in the core's own list of fields.
import {
  askFinite,
  askFlag,
  askKeys,
  askList,
  askNumber,
  askNumbers,
  askTable,
  askText,
  isList,
  toldOf,
  unknownKey,
} from "./checks.js";
import { Refused } from "./refused.js";
import { OF_TOOLS } from "./tool_tables.js";

const SCENE = ["name", "source", "vehicle", "ground", "initial", "input", "run", "outputs", "sensors"];
const TEXTS = ["name", "source"];
const UNREAD_TABLES = ["outputs", "sensors", ...OF_TOOLS]; // which other tools read
const INITIAL = ["nu_rad_per_s", "velocity_body_m_per_s", "yaw_rate_rad_per_s", "x_m", "y_m", "heading_rad"];
const OF_RUN = ["duration_s", "step_s", "method", "real"];
const KINDS = { omni: 1, mecanum: 1, roller: 1, fixed: 2 };
const CIRCUITS = ["driven", "open", "shorted"];
const TABLES = ["motor", "payload", "drive"];
const RAD_PER_DEG = Math.PI / 180;
const OMNI_ROLLER_RAD = Math.PI / 2;
const ABOVE_0 = { radius_m: "the vehicle's", friction_coefficient: "the ground's" }; // where 0 would mean that
const START = ["x_m", "y_m", "heading_rad"];
const KIND = { integer: 1, flag: 3, absence: 4 }; // laconic_field_kind
const NEED = { always: 1, payload: 4, wheel: 6, roller: 7, support: 8 }; // laconic_field_need

/** Method and step of a scene, which both may lack. @param {any} scene @returns {{method?: any, step_s?: any}} */
export function runOf(scene) {
  askTable("scene", scene, "give an object with the keys of a scene, vehicle among them");
  if (scene.run === undefined) return {};
  askKeys("run", scene.run, OF_RUN);
  return scene.run;
}

const FORMS_OF_HINGES = ["caster", "trailer", "body"];

/** The path of the first table of a vehicle that has a body on a hinge; "" where there is none. */
export function hingesIn(/** @type {any} */ vehicle) {
  if (typeof vehicle !== "object" || vehicle === null) return "";
  const wheels = Array.isArray(vehicle.wheel) ? vehicle.wheel : [];
  const at = wheels.findIndex(
    (/** @type {any} */ each) => typeof each === "object" && each !== null && ("steered" in each || "body" in each),
  );
  if (at >= 0) return `vehicle.wheel[${at + 1}].${"steered" in wheels[at] ? "steered" : "body"}`;
  const form = FORMS_OF_HINGES.find((each) => Array.isArray(vehicle[each]) && vehicle[each].length > 0);
  return form ? `vehicle.${form}` : "";
}

/** Sets all numbers of a scene in a robot. */
export class SceneSetter {
  /** @param {import("./module.js").Module} module @param {number} robot */
  constructor(module, robot) {
    this.module = module;
    this.robot = robot;
  }

  /** @param {any} scene */
  set(scene) {
    askKeys("", scene, [...SCENE, ...OF_TOOLS]);
    for (const key of TEXTS) askText(key, scene[key]);
    for (const key of UNREAD_TABLES) if (scene[key] !== undefined) askTable(key, scene[key]);
    if (scene.input !== undefined) askList("input", scene.input);
    const vehicle = askTable("vehicle", scene.vehicle, "give an object with mass_kg and the vehicle's other keys");
    const { wheel = [], support = [] } = vehicle;
    this.table("vehicle", vehicle, [...TABLES, "wheel", "support"]);
    this.need("vehicle.", vehicle, [NEED.always], ["wheel"]);
    for (const name of TABLES)
      if (vehicle[name] !== undefined) {
        this.table(`vehicle.${name}`, vehicle[name]);
        this.need(`vehicle.${name}.`, vehicle[name], [NEED.always, NEED.payload]);
      }
    if (Object.keys(vehicle.drive ?? {}).length && vehicle.motor === undefined)
      throw new Refused(
        "vehicle.drive",
        "limits the currents of motors, which need vehicle.motor; give it instead of motor_gain_Nm_per_V and " +
          "motor_damping_Nms, or take drive out",
        "missing",
      );
    this.module.c.laconic_web_set_motor(this.robot, vehicle.motor ? 1 : 0);
    if (scene.ground !== undefined) this.table("ground", scene.ground);
    this.list("wheel", wheel, (each, name) => this.wheel(each, name));
    this.list("support", support, (each, name) => this.support(each, name));
    if (scene.initial !== undefined) this.start(scene.initial, wheel.length);
  }

  /** @param {string} path @param {any} given @param {string[]} [others] */
  table(path, given, others = []) {
    for (const [key, value] of Object.entries(inRad(path, given)))
      if (!others.includes(key)) this.number(`${path}.${key}`, `${path}.${key}`, 0, value);
  }

  /** What must be given: else a number that was forgotten would be 0. */
  need(
    /** @type {string} */ path,
    /** @type {any} */ given,
    /** @type {number[]} */ needs,
    /** @type {string[]} */ others = [],
    shown = path,
  ) {
    for (const [each, number] of this.module.fields) {
      const key = each.slice(path.length);
      if (!each.startsWith(path) || /[.[]/.test(key) || others.includes(key) || key in given) continue;
      if (needs.includes(this.module.c.laconic_web_field_need(number)))
        throw new Refused(`${shown}${key}`, "is missing; give a number", "missing");
    }
  }

  /** One number; a key that the core's list lacks is refused by its name. */
  number(
    /** @type {string} */ path,
    /** @type {string} */ shown,
    /** @type {number} */ item,
    /** @type {any} */ value,
  ) {
    const number = this.module.fields.get(path);
    if (number === undefined) throw unknownKey(shown);
    const kind = this.module.c.laconic_web_field_kind(number);
    if (kind !== KIND.flag && kind !== KIND.absence) askNumber(shown, value);
    else askFlag(shown, value);
    if (kind === KIND.integer && !Number.isInteger(value))
      throw new Refused(shown, `${toldOf(value)} is no whole number; give one`, "not a whole number");
    if (!this.module.c.laconic_web_set(this.robot, number, item, Number(value)) && item === 0) throw unknownKey(shown);
  }

  /** Tables of which there are several. Those beyond the core's room are only counted: its check refuses them. */
  list(
    /** @type {string} */ name,
    /** @type {any} */ given,
    /** @type {(each: any, name: string) => any} */ numbers,
  ) {
    const path = `vehicle.${name}`;
    askList(path, given);
    this.module.c.laconic_web_set(this.robot, this.module.fields.get(path), 0, given.length);
    Array.from(given, (/** @type {any} */ each, /** @type {number} */ index) => {
      const shown = `${path}[${index + 1}]`;
      for (const [key, value] of Object.entries(numbers(each, shown)))
        this.number(`${path}[#].${key}`, `${shown}.${key}`, index + 1, value);
    });
  }

  support(/** @type {any} */ given, /** @type {string} */ name) {
    const table = askTable(name, given, "give an object with x_m and y_m");
    this.need("vehicle.support[#].", table, [NEED.support], [], `${name}.`);
    return table;
  }

  wheel(/** @type {any} */ given, /** @type {string} */ name) {
    askTable(name, given, "give an object with kind, x_m, y_m and axle_rad");
    const { kind, driven, motor_circuit, undriven, ...rest } = inPlace(name, inRad(name, given));
    if (undriven !== undefined) throw unknownKey(`${name}.undriven`, ["driven"]);
    if (typeof kind !== "string" || !Object.hasOwn(KINDS, kind))
      throw new Refused(
        `${name}.kind`,
        `there is no ${toldOf(kind)}; use omni, mecanum, roller or fixed`,
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
    const roller = Object.keys(given).find((key) => /^roller_(rad|deg)$/.test(key) && given[key] !== undefined);
    if (kind === "fixed" && roller)
      throw new Refused(
        `${name}.${roller}`,
        "a fixed wheel has no rollers; take it out, or give another kind",
        "unknown key",
      );
    if (kind === "omni") numbers.roller_rad ??= OMNI_ROLLER_RAD;
    this.need("vehicle.wheel[#].", numbers, [NEED.wheel, ...(kind === "fixed" ? [] : [NEED.roller])], [], `${name}.`);
    if (driven !== undefined) numbers.undriven = !askFlag(`${name}.driven`, driven);
    if (motor_circuit !== undefined) numbers.motor_circuit = circuitOf(`${name}.motor_circuit`, motor_circuit);
    return numbers;
  }

  /** ν, or the velocity of the centre of mass in body axes and the yaw rate. */
  start(/** @type {any} */ given, /** @type {number} */ wheels) {
    const start = inRad("initial", given);
    askKeys("initial", start, [...INITIAL, "wheel_speed_rad_per_s"]);
    for (const key of START)
      if (key in start) this.number(`initial.${key}`, `initial.${key}`, 0, start[key]);
    for (const [key, count, each] of /** @type {[string, number, string][]} */ ([
      ["nu_rad_per_s", 3, "ν1, ν2 and ν3"],
      ["wheel_speed_rad_per_s", wheels, "one for each wheel"],
    ]))
      if (key in start)
        askNumbers(`initial.${key}`, start[key], count, each).forEach((value, index) =>
          this.number(`initial.${key}[#]`, `initial.${key}[${index + 1}]`, index + 1, value),
        );
    this.velocity(start);
  }

  velocity(/** @type {any} */ { velocity_body_m_per_s = [0, 0], yaw_rate_rad_per_s = 0, ...others }) {
    const each = "ahead and to the left";
    const [forward, left] = askNumbers("initial.velocity_body_m_per_s", velocity_body_m_per_s, 2, each);
    const turn = askFinite("initial.yaw_rate_rad_per_s", yaw_rate_rad_per_s);
    if (forward === 0 && left === 0 && turn === 0) return;
    if (others.nu_rad_per_s !== undefined)
      throw new Refused("initial.nu_rad_per_s", "is given besides a velocity; keep one of them", "given twice");
    if (this.module.c.laconic_web_start_velocity(this.robot, forward, left, turn))
      throw Refused.of(this.module, this.robot);
  }
}

function circuitOf(/** @type {string} */ path, /** @type {any} */ given) {
  const number = CIRCUITS.indexOf(given);
  if (number < 0)
    throw new Refused(path, `there is no ${toldOf(given)}; use ${CIRCUITS.join(", ")}`, "motor circuit unknown");
  return number;
}

/** Angles in degrees, by the suffix _deg, become radians. @param {string} path @param {any} given */
export function inRad(path, given) {
  /** @type {Record<string, any>} */
  const found = {};
  for (const [key, value] of Object.entries(askTable(path, given))) {
    const inDegrees = key.endsWith("_deg"),
      name = inDegrees ? key.replace(/_deg$/, "_rad") : key;
    if (Object.hasOwn(found, name))
      throw new Refused(`${path}.${key}`, "is given in degrees and in radians; keep one", "given twice");
    found[name] = inDegrees ? askNumber(`${path}.${key}`, value) * RAD_PER_DEG : value;
  }
  return found;
}

/**
 * distance_m and bearing_rad become x_m and y_m.
 * @param {string} path @param {any} given @returns {Record<string, any>}
 */
export function inPlace(path, { distance_m, bearing_rad, ...rest }) {
  if (distance_m === undefined && bearing_rad === undefined) return rest;
  for (const key of ["x_m", "y_m"])
    if (key in rest)
      throw new Refused(`${path}.${key}`, "is given besides distance_m and bearing_rad; keep one place", "given twice");
  const far = askFinite(`${path}.distance_m`, distance_m),
    bearing = askFinite(`${path}.bearing_rad`, bearing_rad);
  return { ...rest, x_m: far * Math.cos(bearing), y_m: far * Math.sin(bearing) };
}
