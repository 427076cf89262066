// A drive: the robot, beside it the ideal one, a reference in fine steps and a fleet, all with the same inputs.
import { changesOf, inputOf, sameSignals } from "./drive.js";
import { ofOtherMass, onIdealGround, plain, slips } from "./facts.js";
import { Trails, byCurvature, hasHinges, layoutOf } from "./hinged.js";

export const FLEET = 20;
const LIGHTEST = 0.7;
const HEAVIEST = 1.3; // of the masses of the fleet
const SAMPLE_S = 0.02; // between points of a path
const MOST_POINTS = 6000; // of a path
const FLEET_POINTS = 400;
const REFERENCE_STEP_S = 1e-4;
const HISTORY_S = 10;
const REPLAY_STEPS = 2e6; // more are not computed anew when a number changes
const HINGED_REPLAY_STEPS = 1e5; // the same with hinges, whose steps take longer

/** @typedef {{robot: any, path: number[], scene: any}} Actor */

/** The core's methods from the highest order to the lowest; auto, which takes every robot, is the last. */
function mostAccurateFirst(/** @type {any} */ laconic, /** @type {any} */ scene) {
  const names = [...laconic.methodsOf(scene)].sort((a, b) => b.order - a.order).map(({ name }) => name);
  return [...names.filter((name) => name !== "auto"), "auto"];
}

/** The core's most accurate method that takes this robot, in fine steps. */
export function referenceOf(/** @type {any} */ laconic, /** @type {any} */ scene, /** @type {number} */ step_s) {
  for (const method of mostAccurateFirst(laconic, scene))
    try {
      return { robot: laconic.robot(plain(scene), { method, step_s }), method };
    } catch {
      continue;
    }
  return undefined;
}

/** One drive from its start. */
export class Run {
  /**
   * @param {any} laconic @param {any} scene
   * @param {{method: string, step_s: number, ideal: boolean, fleet: boolean}} how
   */
  constructor(laconic, scene, how) {
    this.laconic = laconic;
    this.scene = scene;
    this.how = how;
    this.step_s = how.step_s;
    /** @type {Actor} */
    this.main = this.actor(scene, how.method);
    this.ideal = how.ideal && slips(scene) ? this.idealActor() : undefined;
    /** @type {Actor[]} */
    this.fleet = [];
    if (how.fleet) this.addFleet();
    this.parts = Math.max(1, Math.ceil(how.step_s / REFERENCE_STEP_S - 1e-9));
    this.layout = hasHinges(scene) ? layoutOf(scene) : undefined;
    this.trails = this.layout && new Trails(this.layout);
    // Commands of hinges end with a step, so finer steps would have others.
    this.reference = this.layout ? undefined : referenceOf(laconic, scene, how.step_s / this.parts);
    this.steps = 0;
    /** @type {import("./drive.js").Change[]} */
    this.changes = [];
    /** @type {Record<string, number>} */
    this.signals = {};
    /** @type {any[]} */
    this.history = [];
    this.note();
  }

  /** @returns {Actor} */
  actor(/** @type {any} */ scene, method = this.how.method) {
    return { robot: this.laconic.robot(plain(scene), { method, step_s: this.step_s }), path: [], scene };
  }

  idealActor() {
    try {
      return this.actor(onIdealGround(this.scene), "auto");
    } catch (refused) {
      this.idealRefused = /** @type {Error} */ (refused).message;
      return undefined;
    }
  }

  addFleet() {
    try {
      for (let i = 0; i < FLEET; i++)
        this.fleet.push(this.actor(ofOtherMass(this.scene, LIGHTEST + ((HEAVIEST - LIGHTEST) * i) / (FLEET - 1))));
    } catch (refused) {
      this.free();
      throw refused;
    }
  }

  get actors() {
    return [this.main, ...(this.ideal ? [this.ideal] : []), ...this.fleet];
  }

  get time_s() {
    return this.steps * this.step_s;
  }

  /** What acts from now on, recorded unless it is refused. */
  set(/** @type {Record<string, number>} */ signals) {
    if (sameSignals(signals, this.signals)) return;
    const input = inputOf(signals, this.main.robot.wheelCount);
    for (const actor of this.actors) this.beside(actor, (robot) => robot.setInput(input));
    this.reference?.robot.setInput(input);
    this.signals = { ...signals };
    const last = this.changes.at(-1);
    if (last && last.t_s === this.time_s) last.signals = this.signals;
    else this.changes.push({ t_s: this.time_s, signals: this.signals });
  }

  /** Takes steps and notes path and velocities; throws what the core refuses. */
  advance(/** @type {number} */ steps) {
    const sample = Math.max(1, Math.round(SAMPLE_S / this.step_s));
    while (steps > 0) {
      const now = Math.min(steps, sample - (this.steps % sample));
      this.take(now);
      steps -= now;
      if (this.steps % sample === 0) this.note();
    }
  }

  /** All take as many steps as the robot does: a refusal may end them early. */
  take(/** @type {number} */ steps) {
    const [{ robot }, ...others] = this.actors,
      begin = robot.steps;
    try {
      robot.run(steps);
    } finally {
      const taken = robot.steps - begin;
      this.steps += taken;
      for (const other of others) this.beside(other, (robot) => robot.run(taken));
      this.reference?.robot.run(taken * this.parts);
    }
  }

  /** The robot without slip may refuse a start or a stop that the other takes: it ends there alone.
   * @param {Actor} actor @param {(robot: any) => void} act */
  beside(actor, act) {
    try {
      act(actor.robot);
    } catch (refused) {
      if (actor !== this.ideal) throw refused;
      this.idealRefused = /** @type {Error} */ (refused).message;
      this.ideal.robot.free();
      this.ideal = undefined;
    }
  }

  note() {
    for (const actor of this.actors) {
      const out = actor.robot.outputs();
      actor.path.push(out.origin_x_m, out.origin_y_m);
      const most = 2 * (this.fleet.includes(actor) ? FLEET_POINTS : MOST_POINTS);
      if (actor.path.length > most) actor.path.splice(0, most / 4);
      if (actor === this.main) this.history.push({ t_s: this.time_s, out });
      if (actor === this.main) this.trails?.take(out, this.time_s);
    }
    while (this.history.length > 1 && this.history[0].t_s < this.time_s - HISTORY_S) this.history.shift();
  }

  /** Follows changes until an instant. */
  follow(/** @type {import("./drive.js").Change[]} */ changes, /** @type {number} */ until_s) {
    const end = Math.round(until_s / this.step_s);
    const ticks = changes.map(({ t_s, signals }) => ({ tick: Math.round(t_s / this.step_s), signals }));
    for (const [index, { tick, signals }] of ticks.entries()) {
      if (tick < this.steps || tick > end) continue;
      this.advance(tick - this.steps);
      const next = ticks[index + 1];
      if (!next || next.tick > tick) this.set(signals);
    }
    this.advance(Math.max(0, end - this.steps));
  }

  /** The same drive with another robot, method or step, until the same instant; from the start where that is far. */
  static again(
    /** @type {any} */ laconic,
    /** @type {any} */ scene,
    /** @type {any} */ how,
    /** @type {Run} */ before,
  ) {
    const run = new Run(laconic, scene, how);
    const sameWheels = scene.vehicle.wheel.length === before.scene.vehicle.wheel.length;
    try {
      const most = run.layout ? HINGED_REPLAY_STEPS : REPLAY_STEPS;
      if (sameWheels && before.time_s / how.step_s < most) run.follow(before.changes, before.time_s);
      return run;
    } catch (refused) {
      run.free();
      throw refused;
    }
  }

  /** How far the robot is from the reference. */
  error_m() {
    if (!this.reference) return Number.NaN;
    const [a, b] = [this.main.robot.outputs(), this.reference.robot.outputs()];
    return Math.hypot(a.x_m - b.x_m, a.y_m - b.y_m);
  }

  free() {
    for (const { robot } of this.actors) robot.free();
    this.reference?.robot.free();
  }
}

/** The inputs that come with a scene, at an instant. */
export class SceneDrive {
  constructor(/** @type {any} */ scene) {
    this.changes = byCurvature(scene, changesOf(scene.input ?? [], scene.run.duration_s));
    this.duration_s = scene.run.duration_s;
    this.isEmpty = !this.changes.some(({ signals }) => Object.values(signals).some((value) => value !== 0));
  }

  /** Takes a run through so many steps of the scene's inputs. */
  lead(/** @type {Run} */ run, /** @type {number} */ steps) {
    const until_s = Math.min(run.time_s + steps * run.step_s, this.duration_s);
    run.follow(this.changes, until_s);
    return until_s >= this.duration_s;
  }
}
