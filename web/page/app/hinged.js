// Robots with hinges beside all others: their core, where their bodies and wheels are, and the ways of trailers.
import { axleOf } from "laconic/hinge_inputs";
import { CARRIAGE, readHinges } from "laconic/hinge_tables";
import { hingesIn, inPlace } from "laconic/scene";
import { slips } from "./facts.js";

const FOLDED_RAD = Math.PI / 2;
const TRAIL_POINTS = 3000;
export const DRAWBAR = 0.4; // of a trailer's length, as it is drawn

/**
 * @typedef {{name: string, form: string, parent: number, hinge: any, at: number[], wheels: any[],
 *   corners: number[][]}} Part a body: its hinge in its parent's frame; in its own its wheels, and what its outline goes
 *   around (x, y, radius)
 * @typedef {{parts: Part[], vehicle: any, size: number, axle: {x_m: number, isAcross: boolean}}} Layout
 */

export function hasHinges(/** @type {any} */ scene) {
  return hingesIn(scene.vehicle) !== "";
}

/** Both cores as one: each scene goes to the one that knows it. */
export class Cores {
  constructor(/** @type {any} */ rigid, /** @type {any} */ hinged) {
    this.rigid = rigid;
    this.hinged = hinged;
    this.maxWheels = rigid.maxWheels;
  }

  robot(/** @type {any} */ scene, /** @type {any} */ run) {
    if (!hasHinges(scene)) return this.rigid.robot(scene, run);
    return new Hung(this.hinged.robot(scene, run), scene.vehicle);
  }

  methodsOf(/** @type {any} */ scene) {
    if (hasHinges(scene) && slips(scene)) return [{ name: "auto", order: 1 }];
    return (hasHinges(scene) ? this.hinged : this.rigid).methods;
  }
}

/** A robot with hinges whose outputs also have what the page reads of every robot. */
class Hung {
  constructor(/** @type {any} */ robot, /** @type {any} */ vehicle) {
    this.robot = robot;
    this.centre = centreOf(vehicle);
    this.wheelCount = robot.wheelCount;
    this.hasFriction = robot.hasFriction;
  }

  get commands() {
    return this.robot.commands;
  }

  get steps() {
    return this.robot.steps;
  }

  get limited() {
    return this.robot.limited;
  }

  setInput(/** @type {any} */ input) {
    this.robot.setInput(input);
  }

  run(/** @type {number} */ steps) {
    this.robot.run(steps);
  }

  outputs() {
    const out = this.robot.outputs(),
      [x, y] = this.centre,
      cosine = Math.cos(out.heading_rad),
      sine = Math.sin(out.heading_rad);
    return {
      ...out,
      origin_x_m: out.x_m - cosine * x + sine * y,
      origin_y_m: out.y_m - sine * x - cosine * y,
      heading_wrapped_rad: Math.atan2(sine, cosine),
    };
  }

  free() {
    this.robot.free();
  }
}

/** The carriage's centre of mass with its payload, in the body frame. */
function centreOf(/** @type {any} */ { mass_kg, com_x_m = 0, com_y_m = 0, payload = { mass_kg: 0, x_m: 0, y_m: 0 } }) {
  const all = mass_kg + payload.mass_kg;
  return [
    (mass_kg * com_x_m + payload.mass_kg * payload.x_m) / all,
    (mass_kg * com_y_m + payload.mass_kg * payload.y_m) / all,
  ];
}

/** Where everything is, the carriage first. @param {any} scene @returns {Layout} */
export function layoutOf(scene) {
  const { vehicle } = scene,
    { bodies, hinges, wheels } = readHinges(vehicle, slips(scene)),
    names = [CARRIAGE, ...hinges.map(({ name }) => name)];
  /** @type {Part[]} */
  const parts = [partOf(CARRIAGE, CARRIAGE, -1, undefined, [0, 0])];
  bodies.forEach(({ name, parent, hinge_x_m, hinge_y_m }, k) => {
    const form = hinges[k].place.replace(/^vehicle\.(\w+).*$/, "$1");
    parts.push(partOf(name, form, names.indexOf(parent), hinges[k], [hinge_x_m, hinge_y_m ?? 0]));
  });
  wheels.forEach(({ table, body, place }, number) => {
    const wheel = { ...inPlace(place, table), number, radius_m: table.radius_m ?? vehicle.wheel_radius_m };
    parts[names.indexOf(body)].wheels.push(wheel);
  });
  for (const part of parts) part.corners.push(...cornersOf(part, parts, vehicle));
  return { parts, vehicle, size: sizeOf(parts), axle: axleOf(wheels) };
}

/** @returns {Part} */
function partOf(
  /** @type {string} */ name,
  /** @type {string} */ form,
  /** @type {number} */ parent,
  /** @type {any} */ hinge,
  /** @type {number[]} */ at,
) {
  return { name, form, parent, hinge, at, wheels: [], corners: [] };
}

/** What a body's outline goes around: its wheels, and those that turn below it; hitches are small. */
function cornersOf(/** @type {Part} */ part, /** @type {Part[]} */ parts, /** @type {any} */ vehicle) {
  const below = parts.filter(({ parent }) => parts[parent] === part);
  const track = Math.max(0, ...part.wheels.map(({ y_m }) => Math.abs(y_m)));
  const supports = part.form === CARRIAGE ? (vehicle.support ?? []) : [];
  return [
    ...part.wheels.map(({ x_m, y_m, radius_m }) => [x_m, y_m, 0.9 * radius_m]),
    ...supports.map((/** @type {any} */ { x_m, y_m }) => [x_m, y_m, 0.9 * vehicle.wheel_radius_m]),
    ...below.map(({ at, form, wheels }) => {
      const turns = form === "wheel" || form === "caster" || wheels.length === 1;
      return [at[0], at[1], turns ? 0.9 * (wheels[0]?.radius_m ?? vehicle.wheel_radius_m) : 0.15 * track];
    }),
    ...(part.form === "trailer"
      ? [1, -1].map((side) => [DRAWBAR * middle(part.wheels)[0], side * track, 0.1 * track])
      : part.parent >= 0
        ? [[0, 0, 0.15 * track]]
        : []),
  ];
}

/** How far the carriage reaches; of a long train a third of all. */
function sizeOf(/** @type {Part[]} */ parts) {
  /** @type {number[][]} */
  const places = [];
  const far = parts.map(({ at, parent, corners }, k) => {
    const [x, y] = parent < 0 ? [0, 0] : places[parent];
    places[k] = [x + at[0], y + at[1]];
    return Math.max(0.05, ...corners.map(([cx, cy, r]) => Math.hypot(places[k][0] + cx, places[k][1] + cy) + r));
  });
  return Math.max(far[0], Math.max(...far) / 3);
}

/** Bodies with wheels away from their hinge: where their axles went, and when one folded. */
export class Trails {
  constructor(/** @type {Layout} */ { parts }) {
    this.all = parts
      .filter(({ form, wheels }) => (form === "trailer" || form === "body") && wheels.length > 0)
      .map(({ name, form, hinge, wheels }) => ({ name, folds: hinge.kind === "free", axle: middle(wheels), form }))
      .filter(({ axle, form }) => form === "trailer" || Math.hypot(...axle) > 0.05)
      .map((each) => ({ ...each, path: /** @type {number[]} */ ([]) }));
    /** @type {Map<string, number>} */
    this.folded = new Map();
  }

  /** Notes the places of this moment. */
  take(/** @type {any} */ out, /** @type {number} */ time_s) {
    for (const { name, folds, axle, path } of this.all) {
      const heading = out.body_heading_rad[name],
        angle = out.hinge_angle_rad[name];
      const [cosine, sine] = [Math.cos(heading), Math.sin(heading)];
      path.push(out.body_x_m[name] + cosine * axle[0] - sine * axle[1]);
      path.push(out.body_y_m[name] + sine * axle[0] + cosine * axle[1]);
      if (path.length > 2 * TRAIL_POINTS) path.splice(0, TRAIL_POINTS / 2);
      const wrappedAngle = Math.atan2(Math.sin(angle), Math.cos(angle));
      if (folds && Math.abs(wrappedAngle) > FOLDED_RAD && !this.folded.has(name)) this.folded.set(name, time_s);
    }
  }
}

export function middle(/** @type {any[]} */ wheels) {
  const mean = (/** @type {string} */ key) => wheels.reduce((sum, wheel) => sum + wheel[key], 0) / wheels.length;
  return [mean("x_m"), mean("y_m")];
}

export function isCoordinated(/** @type {Part} */ { hinge }) {
  return hinge?.kind === "coordinated";
}

/** How far the middle of the hinges that steer together lies ahead of the fixed axle. */
export function steeringBase(/** @type {Layout} */ { parts, axle }, steered = parts.filter(isCoordinated)) {
  return steered.reduce((sum, { at }) => sum + at[0], 0) / steered.length - axle.x_m;
}

/** Changes in which the one angle of coordinated wheels is the curvature that it means, as sliders give it: a scene
 * steers by one of them alone. */
export function byCurvature(/** @type {any} */ scene, /** @type {import("./drive.js").Change[]} */ changes) {
  if (!hasHinges(scene) || !changes.some(({ signals }) => "steering_angle_rad" in signals)) return changes;
  const base = steeringBase(layoutOf(scene));
  return changes.map(({ t_s, signals: { steering_angle_rad: angle = 0, ...signals } }) => ({
    t_s,
    signals: { ...signals, steering_curvature_per_m: Math.tan(angle) / base },
  }));
}
