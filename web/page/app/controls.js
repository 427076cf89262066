// How the robot is driven: sliders, keys and gamepad set a wanted velocity, or each wheel has a slider of its own.
import { mostVoltage, perWheel } from "./drive.js";
import { hasHinges } from "./hinged.js";
import { HingedWay } from "./hinged_way.js";
import { byId, element, fixed, roundDown } from "./texts.js";

export const DIRECTIONS = ["forward", "left", "turn"];
const UNITS = { velocity: ["m/s", "m/s", "rad/s"], acceleration: ["m/s²", "m/s²", "rad/s²"] };
const PUSH = [1, 1, 3]; // m/s² and rad/s² at the end of a slider, for robots without motors
const OF_KEYS = 0.7; // of a slider's end that a key gives
const DEAD = 0.12; // of a gamepad's stick
/** @type {Record<string, [number, number]>} */
const KEYS = {
  w: [0, 1],
  s: [0, -1],
  a: [1, 1],
  d: [1, -1],
  q: [2, 1],
  e: [2, -1],
  arrowup: [0, 1],
  arrowdown: [0, -1],
  arrowleft: [2, 1],
  arrowright: [2, -1],
};

const FIELDS = "select, textarea, canvas:not(#stage), dialog[open] *, input:not([type=checkbox], [type=radio], [type=range])";
const WITHOUT_ARROWS = "body, #stage, button, summary, [type=checkbox]";

/** Whether an element uses a key itself: fields use all, what is no button or box the arrows. */
function uses(/** @type {Element} */ focused, /** @type {string} */ key) {
  return focused.matches(FIELDS) || (key.startsWith("arrow") && !focused.matches(WITHOUT_ARROWS));
}

/** How one robot without hinges is driven: three directions, what each wheel takes, and the signals that follow. */
class RigidWay {
  constructor(/** @type {any} */ scene, /** @type {any} */ robot) {
    const wheels = scene.vehicle.wheel;
    this.robot = robot;
    this.hasMotors = wheels.some((/** @type {any} */ _, /** @type {number} */ i) => robot.motorGain(i) !== 0);
    this.able = [0, 1, 2].map((k) => robot.allowed(...unit(k))[k] > 0.2 && wheels.length > 0);
    if (wheels.length && !this.hasMotors) this.most = PUSH;
    else this.most = [0, 1, 2].map((k) => this.fastest(k, mostVoltage(scene)));
    this.labels = ["Forward", "Left", "Turn"];
    this.units = UNITS[this.hasMotors ? "velocity" : "acceleration"];
    this.scales = [1, 1, 1];
    this.words = this.hasMotors ? "Velocity" : "Acceleration";
    this.knobs = this.knobsOf(scene);
  }

  fastest(/** @type {number} */ k, /** @type {number} */ voltage) {
    const needed = Math.max(0, ...this.robot.voltagesFor(...unit(k)).map(Math.abs));
    return needed > 1e-9 ? roundDown(voltage / needed) : 1;
  }

  knobsOf(/** @type {any} */ scene) {
    const most = this.hasMotors ? mostVoltage(scene) : roundDown(1.0001 * mostTorque(scene, this.robot)),
      name = this.hasMotors ? "voltage_V" : "axle_torque_Nm";
    return scene.vehicle.wheel.map((/** @type {any} */ wheel, /** @type {number} */ i) => ({
      id: `wheel-${i}`,
      label: `Wheel ${i + 1}`,
      unit: this.hasMotors ? "V" : "N·m",
      most,
      disabled: wheel.locked || (this.hasMotors && this.robot.motorGain(i) === 0),
      of: (/** @type {number} */ level) => ({ [`${name}[${i + 1}]`]: level }),
      from: (/** @type {Record<string, number>} */ signals) => signals[`${name}[${i + 1}]`] ?? 0,
    }));
  }

  /** @returns {Record<string, number>} */
  driven(/** @type {number[]} */ wanted) {
    const find = this.hasMotors ? "voltagesFor" : "torquesFor";
    if (wanted.every((value) => value === 0)) return {};
    return perWheel(this.hasMotors ? "voltage_V" : "axle_torque_Nm", this.robot[find](...wanted));
  }

  /** A curve at half the speed; nothing without motors. @returns {Record<string, number> | undefined} */
  usual() {
    if (!this.hasMotors) return undefined;
    return perWheel("voltage_V", this.robot.voltagesFor(...this.most.map((value) => value / 2)));
  }

  hint(/** @type {string} */ mode) {
    if (mode === "scene") return "What the scene gives each wheel over time. Touch a slider or a key to take over.";
    if (mode === "wheels") return this.hasMotors ? "The voltage of each motor." : "The torque on each axle.";
    return this.hasMotors
      ? "Velocity of the body’s origin. The core’s matrices give the least voltages that hold it without slip."
      : "No motors here: the core’s matrices give the least torques on the axles that accelerate the body so.";
  }
}

/** The drive panel for one robot. */
export class Controls {
  /** @param {{touched: (mode: string) => void}} owner */
  constructor(owner) {
    this.owner = owner;
    this.mode = "scene";
    this.wanted = [0, 0, 0];
    /** @type {any} */
    this.way = undefined;
    /** @type {number[]} */
    this.levels = [];
    this.held = new Set();
    this.stick = false;
    this.scope = /** @type {HTMLElement} */ (byId("stage"));
    this.listen();
  }

  listen() {
    for (const [k, name] of DIRECTIONS.entries()) {
      byId(name).addEventListener("input", (/** @type {any} */ event) => this.want(k, Number(event.target.value)));
    }
    for (const input of document.querySelectorAll("input[name=drive]"))
      input.addEventListener("change", () => this.choose(/** @type {HTMLInputElement} */ (input).value));
    byId("stop").addEventListener("click", () => this.stop());
    document.addEventListener("keydown", (event) => this.key(event, true));
    document.addEventListener("keyup", (event) => this.key(event, false));
    window.addEventListener("blur", () => this.releaseKeys());
  }

  /** Fits sliders to a robot: which directions its wheels allow, and how fast. */
  fit(/** @type {any} */ robot, /** @type {any} */ scene, /** @type {boolean} */ isSame) {
    this.way = hasHinges(scene) ? new HingedWay(scene, robot) : new RigidWay(scene, robot);
    if (!isSame) {
      this.wanted = [0, 0, 0];
      this.levels = this.way.knobs.map((/** @type {any} */ { usual = 0 }) => usual);
    }
    this.fitVelocities();
    this.fitKnobs();
    this.show();
  }

  get most() {
    return this.way.most;
  }

  get able() {
    return this.way?.able;
  }

  fitVelocities() {
    for (const [k, name] of DIRECTIONS.entries()) {
      const slider = byId(name);
      slider.disabled = !this.able[k];
      slider.min = String(-this.most[k]);
      slider.max = String(this.most[k]);
      slider.step = String(this.most[k] / 100);
      slider.parentElement.hidden = !this.way.labels[k];
      slider.previousElementSibling.textContent = this.way.labels[k];
    }
    byId("velocity-label").textContent = this.way.words;
  }

  fitKnobs() {
    this.levels.length = this.way.knobs.length;
    const rows = this.way.knobs.map((/** @type {any} */ { id, label, most, disabled }, /** @type {number} */ i) => {
      this.levels[i] = Math.max(-most, Math.min(most, this.levels[i] ?? 0));
      const slider = element("input", { type: "range", id, min: -most, max: most, step: most / 100 });
      slider.disabled = Boolean(disabled);
      slider.addEventListener("input", () => this.turnKnob(i, Number(slider.value)));
      const output = element("output", { htmlFor: id });
      return element("div", { className: "slider" }, element("label", { htmlFor: id }, label), slider, output);
    });
    byId("wheel-sliders").replaceChildren(...rows);
  }

  choose(/** @type {string} */ mode, tells = true) {
    this.mode = mode;
    /** @type {any} */ (document.querySelector(`input[name=drive][value=${mode}]`)).checked = true;
    this.show();
    if (tells) this.owner.touched(mode);
  }

  want(/** @type {number} */ k, /** @type {number} */ value) {
    if (!this.able?.[k] && value !== 0) return;
    this.wanted[k] = value;
    if (this.mode !== "velocity") this.choose("velocity");
    this.show();
    this.owner.touched("velocity");
  }

  turnKnob(/** @type {number} */ i, /** @type {number} */ value) {
    this.levels[i] = value;
    if (this.mode !== "wheels") this.choose("wheels");
    this.show();
    this.owner.touched("wheels");
  }

  stop() {
    this.wanted = [0, 0, 0];
    this.levels = this.way.knobs.map((/** @type {any} */ { usual = 0 }) => usual);
    if (this.mode === "scene") this.choose("velocity");
    this.show();
    this.owner.touched(this.mode);
  }

  /** What acts on the robot now. @returns {Record<string, number>} */
  signals() {
    if (this.mode !== "wheels") return this.way.driven(this.wanted);
    const levels = this.levels.map((level, i) => this.way.knobs[i].of(level));
    return Object.assign({}, ...levels);
  }

  /** Keys drive while nothing that uses them itself has the focus. */
  key(/** @type {KeyboardEvent} */ event, /** @type {boolean} */ isDown) {
    const key = event.key.toLowerCase(),
      found = KEYS[key];
    if (!found || event.ctrlKey || event.metaKey || event.altKey) return;
    if (isDown && uses(document.activeElement ?? document.body, key)) return;
    if (isDown) event.preventDefault();
    if (isDown === this.held.has(key)) return;
    isDown ? this.held.add(key) : this.held.delete(key);
    this.followKeys(isSideless(this.able) && (key === "a" || key === "d"));
  }

  followKeys(usesTurn = false) {
    const wanted = [0, 0, 0];
    for (const key of this.held) {
      const [k, sign] = KEYS[key];
      wanted[k === 1 && isSideless(this.able) ? 2 : k] += sign;
    }
    wanted.forEach(
      (sign, k) => (this.able?.[k] || usesTurn || this.wanted[k]) && this.want(k, sign * OF_KEYS * this.most[k]),
    );
  }

  releaseKeys() {
    if (this.held.size === 0) return;
    this.held.clear();
    this.followKeys();
  }

  /** The first gamepad's sticks; a stick that comes to rest stops what it drove. */
  pollGamepad() {
    const pad = navigator.getGamepads?.().find((each) => each);
    byId("gamepad").hidden = !pad;
    if (!pad) return;
    const axes = [-(pad.axes[1] ?? 0), -(pad.axes[0] ?? 0), -(pad.axes[2] ?? 0)];
    const values = axes.map((axis) => (Math.abs(axis) > DEAD ? axis : 0));
    const isUsed = values.some((value) => value !== 0);
    if (isUsed || this.stick)
      values.forEach((value, k) => value * this.most[k] !== this.wanted[k] && this.want(k, value * this.most[k]));
    this.stick = isUsed;
  }

  /** Shows what the scene does to each wheel and hinge. */
  follow(/** @type {Record<string, number>} */ signals) {
    this.levels = this.way.knobs.map((/** @type {any} */ knob) => knob.from(signals));
    this.show();
  }

  show() {
    byId("velocity-sliders").hidden = this.mode !== "velocity";
    byId("wheel-sliders").hidden = this.mode === "velocity";
    if (!this.way) return;
    const { units, scales, knobs } = this.way;
    byId("drive-hint").textContent = this.way.hint(this.mode);
    for (const [k, name] of DIRECTIONS.entries()) setSlider(byId(name), this.wanted[k], units[k], scales[k]);
    this.levels.forEach((level, i) => setSlider(byId(knobs[i].id), level, knobs[i].unit, knobs[i].scale));
  }
}

function isSideless(/** @type {boolean[] | undefined} */ able) {
  return !able?.[1];
}

function unit(/** @type {number} */ k) {
  return [0, 1, 2].map((each) => Number(each === k));
}

function setSlider(/** @type {any} */ slider, /** @type {number} */ value, /** @type {string} */ unitName, scale = 1) {
  if (!slider) return;
  slider.value = String(value);
  const text = slider.disabled ? "not with these wheels" : `${fixed(value * scale, scale === 1 ? 2 : 1)} ${unitName}`;
  slider.setAttribute("aria-valuetext", text);
  slider.nextElementSibling.textContent = slider.disabled ? "–" : text;
}

function mostTorque(/** @type {any} */ scene, /** @type {any} */ robot) {
  const pushes = [0, 1, 2].flatMap((k) => robot.torquesFor(...unit(k).map((u) => u * PUSH[k])));
  return Math.max(1e-3, ...pushes.map(Math.abs).filter(Number.isFinite));
}
