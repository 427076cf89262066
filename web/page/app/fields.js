// The vehicle's numbers as a form. A refusal of the core stands under the field that it names.
import { hasHinges } from "./hinged.js";
import { byId, element, entry, inDegrees, inRadians, say } from "./texts.js";
import { numberTyped } from "./typed.js";

/** Path in a scene, label, unit. */
const VEHICLE = /** @type {[string, string, string][]} */ ([
  ["vehicle.mass_kg", "Mass", "kg"],
  ["vehicle.yaw_inertia_kgm2", "Yaw inertia", "kg m²"],
  ["vehicle.wheel_radius_m", "Wheel radius", "m"],
  ["vehicle.wheel_inertia_kgm2", "Wheel inertia", "kg m²"],
  ["vehicle.com_x_m", "Centre ahead", "m"],
  ["vehicle.com_y_m", "Centre to left", "m"],
  ["vehicle.com_z_m", "Centre height", "m"],
]);
const GAINS = /** @type {[string, string, string][]} */ ([
  ["vehicle.motor_gain_Nm_per_V", "Motor gain", "N m/V"],
  ["vehicle.motor_damping_Nms", "Motor damping", "N m s"],
]);
const MOTOR = /** @type {[string, string, string][]} */ ([
  ["vehicle.motor.resistance_ohm", "Resistance", "Ω"],
  ["vehicle.motor.torque_constant_Nm_per_A", "Torque constant", "N m/A"],
  ["vehicle.motor.back_emf_Vs_per_rad", "Back-EMF", "V s/rad"],
  ["vehicle.motor.gear_ratio", "Gear ratio", ""],
  ["vehicle.motor.viscous_friction_Nms", "Viscous friction", "N m s"],
  ["vehicle.motor.rotor_inertia_kgm2", "Rotor inertia", "kg m²"],
]);
const LIMITS = /** @type {[string, string, string][]} */ ([
  ["vehicle.drive.supply_V", "Supply", "V"],
  ["vehicle.drive.current_limit_A", "Current limit", "A"],
]);
const PAYLOAD = /** @type {[string, string, string][]} */ ([
  ["vehicle.payload.mass_kg", "Mass", "kg"],
  ["vehicle.payload.x_m", "Ahead", "m"],
  ["vehicle.payload.y_m", "To the left", "m"],
]);
const SLOPE = /** @type {[string, string, string][]} */ ([
  ["ground.slope_rad", "Slope", "°"],
  ["ground.slope_heading_rad", "Uphill towards", "°"],
]);
const FRICTION = /** @type {[string, string, string][]} */ ([
  ["ground.friction_coefficient", "Friction", ""],
  ["ground.roller_drag", "Roller drag", "0 … 1"],
  ["ground.axle_friction_Nm", "Axle friction", "N m"],
]);
const MARGIN = /** @type {[string, string, string][]} */ ([["vehicle.friction_coefficient", "Friction", ""]]);
const EMPTY_MEANS_ABSENT = ["vehicle.drive.supply_V", "vehicle.drive.current_limit_A"];

/** A number of a scene by its path, without items. */
export function numberAt(/** @type {any} */ scene, /** @type {string} */ path) {
  return path.split(".").reduce((table, key) => table?.[key], scene);
}

/** Sets it; tables that it lies in are made, and one that becomes meaningless is taken out. */
export function setNumber(
  /** @type {any} */ scene,
  /** @type {string} */ path,
  /** @type {number | undefined} */ value,
) {
  const keys = path.split("."),
    last = /** @type {string} */ (keys.pop());
  const table = keys.reduce((inner, key) => (inner[key] ??= {}), scene);
  if (value === undefined) delete table[last];
  else table[last] = value;
  tidy(scene);
}

function tidy(/** @type {any} */ scene) {
  const { vehicle, ground } = scene;
  if (vehicle.payload) vehicle.payload = { mass_kg: 0, x_m: 0, y_m: 0, yaw_inertia_kgm2: 0, ...vehicle.payload };
  if (vehicle.payload && Object.values(vehicle.payload).every((value) => value === 0)) delete vehicle.payload;
  if (vehicle.drive && Object.keys(vehicle.drive).length === 0) delete vehicle.drive;
  if (ground?.slope_rad === 0 && !ground.slope_heading_rad) delete ground.slope_rad;
  if (ground && !ground.slope_rad && !ground.slope_heading_rad) delete ground.slope_heading_rad;
  if (ground && Object.keys(ground).length === 0) delete scene.ground;
}

/** Gives the ground its friction, or takes it away; the coefficient stays the one that the margin is judged by. */
export function setFriction(/** @type {any} */ scene, /** @type {boolean} */ slips) {
  if (slips) {
    const coefficient = scene.vehicle.friction_coefficient || 0.6;
    delete scene.vehicle.friction_coefficient;
    scene.ground = { ...scene.ground, friction_coefficient: coefficient };
  } else if (scene.ground) {
    const { friction_coefficient, roller_drag, axle_friction_Nm, ...slope } = scene.ground;
    scene.ground = slope;
    if (friction_coefficient !== undefined) scene.vehicle.friction_coefficient = friction_coefficient;
    for (const wheel of scene.vehicle.wheel)
      for (const key of ["friction_coefficient", "roller_drag", "axle_friction_Nm"]) delete wheel[key];
    tidy(scene);
  }
}

/** The form; `changed` is called after every change. */
export class Fields {
  constructor(/** @type {() => void} */ changed) {
    this.changed = changed;
    /** @type {Map<string, any>} */
    this.inputs = new Map();
    /** @type {string | undefined} */
    this.changedPath = undefined;
  }

  /** Makes the form anew for a scene. */
  fit(/** @type {any} */ scene) {
    const focused = document.activeElement?.id;
    this.scene = scene;
    this.inputs.clear();
    this.fill("fields-body", VEHICLE);
    this.fill("fields-motor", scene.vehicle.motor ? [...MOTOR, ...LIMITS] : GAINS);
    this.fill("fields-payload", PAYLOAD);
    const hasRollers = scene.vehicle.wheel.some((/** @type {any} */ wheel) => wheel.kind !== "fixed");
    const ofFriction = FRICTION.filter(([path]) => hasRollers || path !== "ground.roller_drag");
    const isSlippery = scene.ground?.friction_coefficient !== undefined;
    const ofGround = isSlippery ? ofFriction : hasHinges(scene) ? [] : MARGIN; // no margin is computed with hinges
    this.fill("fields-ground", [...ofGround, ...SLOPE]);
    byId("friction").checked = isSlippery;
    if (focused) byId(focused)?.focus();
  }

  fill(/** @type {string} */ id, /** @type {[string, string, string][]} */ rows) {
    byId(id).replaceChildren(...rows.map(([path, label, unit]) => this.row(path, label, unit)));
  }

  row(/** @type {string} */ path, /** @type {string} */ label, /** @type {string} */ unit) {
    const id = `field-${path}`,
      given = numberAt(this.scene, path);
    const value =
      given === undefined ? (EMPTY_MEANS_ABSENT.includes(path) ? "" : 0) : unit === "°" ? inDegrees(given) : given;
    const input = element("input", {
      id,
      type: "text",
      inputMode: "decimal",
      autocomplete: "off",
      value: entry(value),
    });
    if (EMPTY_MEANS_ABSENT.includes(path)) input.placeholder = "none";
    input.setAttribute("aria-describedby", `${id}-error`);
    input.addEventListener("change", () => this.take(path, unit, input.value));
    this.inputs.set(path, input);
    const unitText = element("span", { className: "unit" }, unit);
    return element(
      "div",
      { className: "field" },
      element("label", { htmlFor: id }, label),
      input,
      unitText,
      element("p", { className: "error", id: `${id}-error` }),
    );
  }

  take(/** @type {string} */ path, /** @type {string} */ unit, /** @type {string} */ text) {
    const value = numberTyped(path, text);
    this.changedPath = path;
    const isAbsent = text.trim() === "" && EMPTY_MEANS_ABSENT.includes(path);
    setNumber(this.scene, path, isAbsent ? undefined : unit === "°" ? inRadians(value) : value);
    this.changed();
  }

  /**
   * Shows a refusal under its field, and one that names none under the field that was changed before it; returns
   * whether the form has the field that it names.
   */
  refuse(/** @type {any} */ refused) {
    for (const [path, input] of this.inputs) {
      const isIt = refused && (refused.path ? refused.path === path : path === this.changedPath);
      input.setAttribute("aria-invalid", String(Boolean(isIt)));
      byId(`${input.id}-error`).textContent = isIt ? refused.explanation : "";
    }
    if (refused) say(refused.message);
    return this.inputs.has(refused?.path);
  }
}
