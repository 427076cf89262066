// What the build put into the page: the scenes, and the hash of the native core.
import { ON_FRICTION, slipsOn } from "laconic/hinge_friction";
import { bytesOf, unpacked } from "laconic/module";

const given = await unpacked(bytesOf(document.getElementById("facts")?.textContent ?? ""));
const facts = JSON.parse(new TextDecoder().decode(given));

/** @type {string} */
export const nativeHash = facts.nativeHash;

/** @type {any[]} */
export const scenes = facts.scenes;

/** A scene of one's own to begin with: four wheels of round numbers. */
export function ownScene() {
  const motor = { motor_gain_Nm_per_V: 0.2, motor_damping_Nms: 0.1 };
  const wheels = [
    [0.2, 0.15, 1],
    [0.2, -0.15, -1],
    [-0.2, 0.15, -1],
    [-0.2, -0.15, 1],
  ];
  return {
    id: "own",
    name: "Robot of my own",
    source: "drawn on the page",
    vehicle: {
      mass_kg: 12,
      yaw_inertia_kgm2: 0.6,
      com_z_m: 0.1,
      wheel_radius_m: 0.05,
      wheel_inertia_kgm2: 0.002,
      ...motor,
      friction_coefficient: 0.6,
      wheel: wheels.map(([x_m, y_m, side]) => ({
        kind: "mecanum",
        x_m,
        y_m,
        axle_rad: -Math.PI / 2,
        roller_rad: (side * Math.PI) / 4,
      })),
    },
    input: [],
    run: { duration_s: 10, step_s: 0.001, method: "auto" },
  };
}

/** A scene by the keys that the core knows: the page's own name of it is none. */
export function plain(/** @type {any} */ { id: _, ...scene }) {
  return scene;
}

/** Whether wheels slip. */
export function slips(/** @type {any} */ scene) {
  return slipsOn(scene.ground);
}

const OF_FRICTION = ["friction_coefficient", "roller_drag", "axle_friction_Nm", "motor_circuit"];

/** The same robot on ideal ground, with motors without limits; a slope stays. */
export function onIdealGround(/** @type {any} */ scene) {
  const ideal = structuredClone(scene);
  const { friction_coefficient, roller_drag, axle_friction_Nm, ...slope } = ideal.ground ?? {};
  ideal.ground = slope;
  delete ideal.vehicle.drive;
  if (friction_coefficient !== undefined) ideal.vehicle.friction_coefficient = friction_coefficient;
  for (const wheel of ideal.vehicle.wheel) for (const key of OF_FRICTION) delete wheel[key];
  for (const form of ["wheel", "body", "caster", "trailer"])
    for (const each of ideal.vehicle[form] ?? []) for (const key of ON_FRICTION) delete each[key];
  if (ideal.initial) delete ideal.initial.wheel_speed_rad_per_s;
  return ideal;
}

/** The same robot with other masses, by a factor. */
export function ofOtherMass(/** @type {any} */ scene, /** @type {number} */ factor) {
  const other = structuredClone(scene);
  other.vehicle.mass_kg *= factor;
  other.vehicle.yaw_inertia_kgm2 *= factor;
  return other;
}
