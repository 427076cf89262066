// Laconic, the dynamics of wheeled robots, in browsers and Node: the C core as WebAssembly.
import { askKeys } from "./checks.js";
import { Module } from "./module.js";
import { Refused } from "./refused.js";
import { Robot } from "./robot.js";
import { hingesIn, runOf } from "./scene.js";
import { wasm } from "./wasm.js";

export { Refused, Robot };

/** The loaded core. */
export class Laconic {
  /** @param {Module} module */
  constructor(module) {
    if (!(module instanceof Module)) throw new Refused("", "the core is loaded by load()", "not loaded");
    this.module = module;
    this.version = module.text(module.c.laconic_web_version());
    this.maxWheels = module.c.laconic_web_max_wheels();
    this.methods = module.methods.map(({ name, order }) => ({ name, order }));
    /** @type {string | undefined} */
    this.hashed = undefined;
    this.arithmeticIsSound = module.c.laconic_web_self_test() === 0;
  }

  /** @param {any} scene @param {{method?: string, step_s?: number}} [run] */
  robot(scene, run = {}) {
    const ofScene = runOf(scene),
      hinged = hingesIn(scene.vehicle);
    if (hinged)
      throw new Refused(
        hinged,
        'bodies on hinges are for robot() of what load() of "laconic-robots/hinges" gives; take that one',
        "unknown key",
      );
    askKeys("run", run, ["method", "step_s"]);
    const { method = ofScene.method ?? "auto", step_s = ofScene.step_s ?? 0.001 } = run;
    return new Robot(this.module, scene, method, step_s);
  }

  /**
   * Numbers that depend on every bit of many trajectories, each as 16 hexadecimal digits: of six methods together,
   * then of each later one.
   */
  hash() {
    const lines = [];
    for (let line = 0, bits; (bits = this.module.c.laconic_web_hash(line)); line++)
      lines.push(BigInt.asUintN(64, bits).toString(16).padStart(16, "0"));
    this.hashed ??= lines.join(" ");
    return this.hashed;
  }
}

/** Loads the core; every call makes one of its own. */
export async function load() {
  return new Laconic(await Module.load(wasm));
}
