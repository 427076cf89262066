// A robot's place in the module's memory: taken for it, and given back by free().
import { Module } from "./module.js";
import { Refused } from "./refused.js";

/** What every robot is. Call free() when it is no longer needed: its memory is used again. */
export class Handle {
  #pointer = 0;
  step_s = 0;

  /** @param {import("./module.js").Module} module */
  constructor(module) {
    if (!(module instanceof Module))
      throw new Refused("", "a robot is made by robot() of what load() gives", "not loaded");
    this.module = module;
    this.c = module.c;
  }

  /** Takes memory that begin() fills, and gives it back where that is refused. @param {() => void} begin */
  take(begin) {
    this.#pointer = this.c.laconic_web_new();
    if (!this.#pointer) throw new RangeError("no memory for another robot; free some");
    try {
      begin();
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

  get steps() {
    return this.c.laconic_web_steps(this.pointer);
  }

  get time_s() {
    return this.steps * this.step_s;
  }

  /** Gives its memory back; a second time does nothing. */
  free() {
    if (this.#pointer) this.c.laconic_web_free(this.#pointer);
    this.#pointer = 0;
  }
}
