// Commands of hinges, step by step: rates, angles and twists within the limits of the scene.
import { Refused } from "./refused.js";

/** @typedef {import("./hinge_tables.js").Hinge} Hinge */
/** @typedef {{rates: {name: string, rate: number, angle?: number}[], twist: number[]}} Acting
 *   where wheels may slip, the angle is the target of a servo or loop */

const AHEAD = [1, 0, 0];
const ROUNDING = 1e-9; // of a limit of rate
const OF_ANGLE = 1e-12; // rad
const HALVINGS = 50; // of the way to a twist beyond a limit
const STUCK = 1e-10; // of that way: the hinge is at its stop
const LEAST_SIZE_M = 1e-3;
const ON_THE_AXLE = 1e-6; // of the vehicle's size

function within(/** @type {number} */ value, /** @type {number} */ low, /** @type {number} */ high) {
  return Math.min(Math.max(value, low), high);
}

/**
 * Direction of a vector, by operations that every machine rounds alike, as the command does. The tangent of the half
 * angle is y/(r + x) in the right half plane; three more halves leave a short series.
 * @param {number} x @param {number} y
 */
export function angleOf(x, y) {
  const whole = Math.sqrt(x * x + y * y) + Math.abs(x);
  let t = whole > 0 ? y / whole : 0;
  for (let k = 0; k < 3; k++) t = t / (1 + Math.sqrt(1 + t * t));
  const square = t * t;
  let sum = 0;
  for (let k = 15; k > 0; k -= 2) sum = 1 / k - square * sum;
  const angle = 16 * (t * sum);
  return x < 0 ? (y < 0 ? -Math.PI : Math.PI) - angle : angle;
}

/**
 * The tangent of an angle below a right angle, in the same way: sine over cosine of an eighth by their series, doubled
 * three times.
 * @param {number} angle
 */
export function tangentOf(angle) {
  const eighth = angle / 8;
  let t = (eighth * series(eighth, 13)) / series(eighth, 12);
  for (let k = 0; k < 3; k++) t = (2 * t) / (1 - t * t);
  return t;
}

/** Of sin(x)/x by odd powers up to a last one, of cos(x) by even ones. @param {number} x @param {number} last */
function series(x, last) {
  let found = 1;
  for (let k = last; k > 1; k -= 2) found = 1 - (x * x * found) / (k * (k - 1));
  return found;
}

function isZero(/** @type {number[]} */ twist) {
  return twist.every((each) => each === 0);
}

/** What is commanded, and what of it acts. Angles of prescribed and coordinated hinges follow commands alone. */
export class Commands {
  /**
   * @param {Hinge[]} hinges @param {{name: string, hinge_x_m: number, hinge_y_m: number}[]} bodies
   * @param {number} axle_x_m ξ of the carriage's own axle
   */
  constructor(hinges, bodies, axle_x_m) {
    this.prescribed = hinges.filter(({ kind }) => kind === "prescribed");
    this.coordinated = hinges.filter(({ kind }) => kind === "coordinated");
    this.places = this.coordinated.map(({ name }) => {
      const body = bodies.find((each) => each.name === name);
      return body ? [body.hinge_x_m, body.hinge_y_m] : [0, 0];
    });
    this.axle = axle_x_m;
    this.size = Math.max(LEAST_SIZE_M, ...this.places.flat().map(Math.abs));
    this.isLimited = this.coordinated.some(
      ({ low, high, rateLimit }) => Number.isFinite(rateLimit) || Number.isFinite(low) || Number.isFinite(high),
    );
    /** @type {Map<string, number>} */
    this.angles = new Map();
    /** @type {Map<string, number>} rates and angles that are commanded */
    this.rates = new Map();
    this.targets = new Map();
    /** @type {number[]} the twist that is commanded, and that which acts */
    this.wanted = AHEAD;
    this.twist = AHEAD;
    /** @type {Map<string, {hinge: string, limit: string, first_s: number, steps: number}>} */
    this.limited = new Map();
    /** @type {{target: number[], now: number[], hinge: Hinge, asked: number, limit: number} | undefined} */
    this.stuck = undefined;
  }

  /** The commands of an input, checked before; rates and angles by the names of hinges. */
  set(
    /** @type {Record<string, number>} */ rates,
    /** @type {Record<string, number>} */ targets,
    /** @type {number[] | undefined} */ twist,
  ) {
    this.rates = new Map(Object.entries(rates));
    this.targets = new Map(Object.entries(targets));
    this.wanted = twist ?? AHEAD;
  }

  /** The twist of a curvature of the path to the left. */
  ofCurvature(/** @type {number} */ curvature) {
    return [1, -this.axle * curvature, curvature];
  }

  /** The same of the angle of a wheel on the middle line. */
  ofAngle(/** @type {number} */ angle) {
    const base = this.places.reduce((sum, [x]) => sum + x, 0) / this.places.length - this.axle;
    if (Math.abs(base) < ON_THE_AXLE * this.size)
      throw new Refused(
        "steering_angle_rad",
        "is that of wheels ahead of or behind a fixed axle, and these lie on it or around the origin; give steering_twist",
        "no such angle",
      );
    if (!(Math.abs(angle) < Math.PI / 2))
      throw new Refused("steering_angle_rad", `is ${angle}; give less than a right angle`, "out of range", angle);
    return this.ofCurvature(tangentOf(angle) / base);
  }

  /** At the start the wheels point as commanded, or as near to it from straight ahead as their stops allow. */
  begin(/** @type {Hinge[]} */ hinges) {
    this.angles = new Map(hinges.map(({ name, angle }) => [name, angle]));
    this.limited.clear();
    this.twist = this.goal();
    if (!this.isLimited || isZero(this.twist)) return;
    this.takeAngles();
    const beyond = this.coordinated.some((hinge) => !isBetween(hinge, this.angle(hinge), OF_ANGLE));
    if (!beyond) return;
    this.twist = AHEAD;
    this.takeAngles();
    this.twist = this.towards(this.unit(this.wanted), 0, Infinity);
    this.takeAngles();
  }

  angle(/** @type {Hinge} */ { name }) {
    return this.angles.get(name) ?? 0;
  }

  /** Whether held inputs take all further steps as the present one. */
  get isSettled() {
    const rests = this.prescribed.every((hinge) => {
      const rate = this.rates.get(hinge.name) ?? 0;
      const target = this.targets.get(hinge.name);
      if (target !== undefined) return target === this.angle(hinge) && isBetween(hinge, target);
      return rate === 0 || (!isStopped(hinge) && Math.abs(rate) <= hinge.rateLimit);
    });
    return rests && this.goal().every((each, k) => each === this.twist[k]);
  }

  goal() {
    return this.isLimited ? this.unit(this.wanted) : this.wanted;
  }

  /** What acts while all is settled. @returns {Acting} */
  rest() {
    return {
      rates: this.prescribed.map(({ name }) => ({ name, rate: this.targets.has(name) ? 0 : (this.rates.get(name) ?? 0) })),
      twist: this.twist,
    };
  }

  /**
   * The rate of each prescribed hinge, and the twist at the end, of one step from `time_s`.
   * @returns {Acting & {undo: () => void}}
   */
  step(/** @type {number} */ time_s, /** @type {number} */ h) {
    const undo = this.undoing();
    try {
      return { rates: this.turn(time_s, h), twist: this.twist, undo };
    } catch (refused) {
      undo();
      throw refused;
    }
  }

  /** What takes back all that happens from now on. @returns {() => void} */
  undoing() {
    const angles = new Map(this.angles),
      limited = new Map(this.limited),
      twist = this.twist;
    return () => {
      this.angles = angles;
      this.limited = limited;
      this.twist = twist;
    };
  }

  /** Rates and angles of one step. @returns {Acting["rates"]} */
  turn(/** @type {number} */ time_s, /** @type {number} */ h) {
    const rates = this.prescribed.map((hinge) => ({ name: hinge.name, rate: this.follow(hinge, time_s, h) }));
    if (this.coordinated.length) this.steer(time_s, h);
    return rates;
  }

  /** The rate of a prescribed hinge over a step, within its limits. */
  follow(/** @type {Hinge} */ hinge, /** @type {number} */ time_s, /** @type {number} */ h) {
    const angle = this.angle(hinge),
      target = this.targets.get(hinge.name) ?? (hinge.follows ? 0 : undefined);
    let wanted = this.rates.get(hinge.name) ?? 0;
    if (target !== undefined) {
      const reachable = within(target, hinge.low, hinge.high);
      if (Math.abs(reachable - target) > OF_ANGLE) this.limit(hinge, "angle", time_s, target, reachable);
      wanted = (reachable - angle) / h;
    }
    let rate = within(wanted, -hinge.rateLimit, hinge.rateLimit);
    if (Math.abs(wanted) > hinge.rateLimit * (1 + ROUNDING))
      this.limit(hinge, "rate", time_s, Math.abs(wanted), hinge.rateLimit);
    const isReached = target !== undefined && rate === wanted,
      end = isReached ? within(target, hinge.low, hinge.high) : angle + h * rate,
      stop = within(end, hinge.low, hinge.high);
    if (Math.abs(stop - end) > OF_ANGLE) {
      this.limit(hinge, "angle", time_s, end, stop);
      rate = (stop - angle) / h;
    }
    this.angles.set(hinge.name, stop);
    return rate;
  }

  /** Counts a limited step; refuses it where the scene says so. */
  limit(
    /** @type {Hinge} */ hinge,
    /** @type {string} */ what,
    /** @type {number} */ time_s,
    /** @type {number} */ value,
    /** @type {number} */ limit,
  ) {
    const unit = what === "rate" ? "rad/s" : "rad";
    if (hinge.refuses)
      throw new Refused(
        `${hinge.place} (${hinge.name})`,
        `at t = ${time_s} s the command asks for ${value} ${unit}, the limit of its ${what} is ${limit} ${unit}; ` +
          'command less, or give at_limit = "saturate"',
        "limit of a hinge",
        value,
        limit,
      );
    const key = `${what} ${hinge.name}`,
      found = this.limited.get(key) ?? { hinge: hinge.name, limit: what, first_s: time_s, steps: 0 };
    this.limited.set(key, { ...found, steps: found.steps + 1 });
  }

  /** The twist goes as far towards the commanded one as the limits of all coordinated hinges allow. */
  steer(/** @type {number} */ time_s, /** @type {number} */ h) {
    const target = this.goal();
    if (!this.isLimited || isZero(target) || isZero(this.twist)) {
      this.twist = target; // a twist of 0 is refused by the core
      return;
    }
    const reached = this.towards(target, time_s, h);
    this.turns(this.twist, reached).forEach((turn, k) => {
      const hinge = this.coordinated[k];
      this.angles.set(hinge.name, this.angle(hinge) + turn);
    });
    this.twist = reached;
  }

  towards(/** @type {number[]} */ target, /** @type {number} */ time_s, /** @type {number} */ h) {
    const now = this.twist,
      part = (/** @type {number} */ share) => now.map((each, k) => each + share * (target[k] - each));
    if (this.stuck && same(this.stuck.target, target) && same(this.stuck.now, now)) {
      const { hinge, asked, limit } = this.stuck; // at a stop, as a step before
      this.limit(hinge, "angle", time_s, asked, limit);
      return now;
    }
    let broken = this.broken(target, h);
    if (!broken) return target;
    let low = 0,
      high = 1;
    for (let k = 0; k < HALVINGS; k++) {
      const middle = 0.5 * (low + high),
        nearer = this.broken(part(middle), h);
      if (nearer) broken = nearer;
      if (nearer) high = middle;
      else low = middle;
    }
    const { hinge, what, limit } = broken,
      turn = this.turns(now, target)[this.coordinated.indexOf(hinge)],
      asked = what === "rate" ? Math.abs(turn) / h : this.angle(hinge) + turn;
    this.limit(hinge, what, time_s, asked, limit);
    if (what !== "angle" || low >= STUCK) return this.unit(part(low));
    this.stuck = { target, now, hinge, asked, limit };
    return now;
  }

  /** The first limit that a step from the present twist to another breaks. */
  broken(/** @type {number[]} */ then, /** @type {number} */ h) {
    const turns = this.turns(this.twist, then);
    for (const [k, hinge] of this.coordinated.entries()) {
      const angle = this.angle(hinge) + turns[k],
        isFast = Number.isFinite(h) && Math.abs(turns[k]) > h * hinge.rateLimit * (1 + ROUNDING);
      if (isFast) return { hinge, what: "rate", limit: hinge.rateLimit };
      if (!isBetween(hinge, angle, OF_ANGLE))
        return { hinge, what: "angle", limit: turns[k] > 0 ? hinge.high : hinge.low };
    }
    return undefined;
  }

  /** The twist of size 1, lengths over the vehicle's; 0 stays 0. */
  unit(/** @type {number[]} */ twist) {
    const largest = Math.max(...twist.map(Math.abs));
    if (!(largest > 0 && largest < Infinity)) return [0, 0, 0];
    const scaled = twist.map((each) => each / largest),
      yaw = scaled[2] * this.size;
    const length = Math.sqrt(scaled[0] * scaled[0] + scaled[1] * scaled[1] + yaw * yaw);
    return scaled.map((each) => each / length);
  }

  /** The velocity at each hinge: ahead, to the left. */
  directions(/** @type {number[]} */ [ahead, aside, yaw]) {
    return this.places.map(([x, y]) => [ahead - yaw * y, aside + yaw * x]);
  }

  /** How far each hinge turns from one twist to another. */
  turns(/** @type {number[]} */ now, /** @type {number[]} */ then) {
    const before = this.directions(now);
    return this.directions(then).map(([x, y], k) => {
      const [x0, y0] = before[k];
      return angleOf(x * x0 + y * y0, y * x0 - x * y0);
    });
  }

  /** Angles of the coordinated hinges, next to those that the scene gives. */
  takeAngles() {
    this.directions(this.twist).forEach(([x, y], k) => {
      const hinge = this.coordinated[k],
        angle = angleOf(x, y);
      this.angles.set(hinge.name, angle + 2 * Math.PI * Math.round((hinge.angle - angle) / (2 * Math.PI)));
    });
  }
}

/** Commands where wheels may slip: servos and loops get angles or rates, coordinated hinges turn along the twist. */
export class SlippingCommands extends Commands {
  /** @param {Hinge[]} hinges @param {any[]} bodies @param {number} axle_x_m */
  constructor(hinges, bodies, axle_x_m) {
    super(hinges, bodies, axle_x_m);
    this.followers = hinges.filter(({ kind, follows }) => follows && kind !== "coordinated");
    /** Direction of each coordinated hinge in [−π, π], and the turns that it is beyond. */
    this.raw = /** @type {number[]} */ ([]);
    this.turnsBeyond = /** @type {number[]} */ ([]);
  }

  begin(/** @type {Hinge[]} */ hinges) {
    super.begin(hinges);
    if (!this.coordinated.length) return;
    askDirection(this.twist);
    this.takeAngles();
    this.raw = this.directions(this.twist).map(([x, y]) => angleOf(x, y));
    this.turnsBeyond = this.coordinated.map((hinge, k) =>
      Math.round((this.angle(hinge) - this.raw[k]) / (2 * Math.PI)),
    );
  }

  get isSettled() {
    const rest = this.followers.every((hinge) => {
      const target = this.targets.get(hinge.name) ?? 0;
      return hinge.follows === "rate" || (target === this.angle(hinge) && isBetween(hinge, target));
    });
    return rest && super.isSettled;
  }

  rest() {
    const { rates, twist } = super.rest(),
      turned = this.coordinated.map((hinge) => ({ name: hinge.name, rate: 0, angle: this.angle(hinge) }));
    return { rates: [...rates, ...this.followers.map((hinge) => this.held(hinge)), ...turned], twist };
  }

  /** Target of a servo or loop, angles as they are. */
  held(/** @type {Hinge} */ { name, follows }) {
    return follows === "rate"
      ? { name, rate: this.rates.get(name) ?? 0 }
      : { name, rate: 0, angle: this.angles.get(name) };
  }

  undoing() {
    const undo = super.undoing(),
      { raw, turnsBeyond } = this;
    return () => {
      undo();
      this.raw = raw;
      this.turnsBeyond = turnsBeyond;
    };
  }

  /** @returns {Acting["rates"]} */
  turn(/** @type {number} */ time_s, /** @type {number} */ h) {
    const before = new Map(this.angles),
      rates = super.turn(time_s, h);
    for (const hinge of this.followers) {
      if (hinge.follows === "angle") this.follow(hinge, time_s, h);
      rates.push(this.held(hinge));
    }
    return [...rates, ...this.coordinate(before, h)];
  }

  /** Angles and rates of coordinated hinges along the twist at the end of a step. */
  coordinate(/** @type {Map<string, number>} */ before, /** @type {number} */ h) {
    if (!this.coordinated.length) return [];
    askDirection(this.twist);
    const found = this.directions(this.twist).map(([x, y]) => angleOf(x, y));
    this.turnsBeyond = found.map((angle, k) => {
      const change = angle - this.raw[k];
      return this.turnsBeyond[k] - (Math.abs(change) > Math.PI ? Math.sign(change) : 0);
    });
    this.raw = found;
    return this.coordinated.map(({ name, follows }, k) => {
      const angle = found[k] + 2 * Math.PI * this.turnsBeyond[k],
        rate = follows ? 0 : (angle - (before.get(name) ?? 0)) / h;
      this.angles.set(name, angle);
      return { name, rate, angle };
    });
  }
}

function askDirection(/** @type {number[]} */ twist) {
  if (isZero(twist))
    throw new Refused(
      "steering_twist",
      "is 0, which gives coordinated wheels no direction; stop by voltages, and keep the twist",
      "twist zero",
    );
}

function same(/** @type {number[]} */ a, /** @type {number[]} */ b) {
  return a.every((each, k) => each === b[k]);
}

export function isStopped(/** @type {Hinge} */ { low, high }) {
  return Number.isFinite(low) || Number.isFinite(high);
}

export function isBetween(/** @type {Hinge} */ { low, high }, /** @type {number} */ angle, allowed = 0) {
  return low - allowed <= angle && angle <= high + allowed;
}
