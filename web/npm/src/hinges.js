// Laconic for vehicles with hinges: steered wheels, casters, trailers, loaders. The C core's part for them as
// WebAssembly, apart from the other so that nobody loads what is not needed.
import { askKeys } from "./checks.js";
import { HingedRobot } from "./hinged_robot.js";
import { wasm as hingedWasm } from "./hinged_wasm.js";
import { Module } from "./module.js";
import { Refused } from "./refused.js";
import { hingesIn, runOf } from "./scene.js";

export { HingedRobot, Refused };

/** The loaded core. */
export class LaconicHinges {
  /** @param {Module} module */
  constructor(module) {
    if (!(module instanceof Module)) throw new Refused("", "the core is loaded by load()", "not loaded");
    this.module = module;
    this.version = module.text(module.c.laconic_web_version());
    this.maxWheels = module.c.laconic_web_max_wheels();
    this.maxBodies = module.c.laconic_web_max_bodies();
    this.methods = module.methods.map(({ name, order }) => ({ name, order }));
    this.arithmeticIsSound = module.c.laconic_web_self_test() === 0;
  }

  /** @param {any} scene @param {{method?: string, step_s?: number}} [run] */
  robot(scene, run = {}) {
    const ofScene = runOf(scene);
    askKeys("run", run, ["method", "step_s"]);
    if (!hingesIn(scene.vehicle))
      throw new Refused(
        "vehicle",
        'has no bodies on hinges; take robot() of what load() of "laconic-robots" gives',
        "no hinges",
      );
    const { method = ofScene.method ?? "auto", step_s = ofScene.step_s ?? 0.001 } = run;
    return new HingedRobot(this.module, scene, method, step_s);
  }
}

/** Loads the core; every call makes one of its own. */
export async function load() {
  return new LaconicHinges(await Module.load(hingedWasm));
}
