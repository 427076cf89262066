// How a robot with hinges is driven: wanted velocity and steering as voltages and commands of its hinges.
import { mostVoltage, perWheel } from "./drive.js";
import { slips } from "./facts.js";
import { isCoordinated, layoutOf, steeringBase } from "./hinged.js";
import { roundDown } from "./texts.js";

const DEGREES = 180 / Math.PI;
const USUAL_STEERING_RAD = 1;
const OF_STOPS = 0.9; // that the driver's slider uses
const OF_LIMIT = 0.98; // of a rate
const FOLLOWS_PER_S = 4; // rate of a hinge that follows an angle, over the angle that is left
const SETTLED_RAD = 1e-4;
const MOST_RATE = 1; // rad/s of a hinge without a limit
const CURVE_S = 2;
const SMALL = 1e-9;
const ALIGNED_STEPS = 20; // in which the speed of a wheel grows while its module turns to its direction
const STEERED = ["prescribed", "motor", "servo"];

/** @typedef {import("./hinged.js").Part} Part */
/** @typedef {{x: number, y: number, turn: number}} Twist of the body's origin, in body axes */

/** One robot's way: three directions, what each wheel and hinge takes, and the signals that follow. */
export class HingedWay {
  constructor(/** @type {any} */ scene, /** @type {any} */ robot) {
    this.robot = robot;
    this.scene = scene;
    this.layout = layoutOf(scene);
    this.parts = this.layout.parts;
    this.volts = mostVoltage(scene);
    this.wheels = this.parts.flatMap((part, of) => part.wheels.map((wheel) => ({ ...wheel, of })));
    const own = this.parts.filter(({ hinge }) => STEERED.includes(hinge?.kind)),
      coordinated = this.parts.filter(isCoordinated);
    // Where wheels may slip, hinges that turn by themselves can steer together.
    this.isEach = !coordinated.length && slips(scene) && own.filter(({ parent }) => parent === 0).length > 1;
    this.together = this.isEach ? own.filter(({ parent }) => parent === 0) : coordinated;
    const hasAxle = this.parts[0].wheels.some(({ kind }) => kind === "fixed") && this.layout.axle.isAcross;
    this.isSwerve = this.together.length > 0 && !hasAxle;
    this.steered = this.together.length ? undefined : own[0];
    this.isSteered = !this.isSwerve && Boolean(this.steered || this.together.length);
    this.hasMotors = this.wheels.some((wheel) => this.idle(wheel) > 0);
    this.twist = [1, 0, 0];
    /** @type {number[]} angles to which modules that turn by themselves are commanded */
    this.aims = this.parts.map(() => 0);
    /** @type {number[]} */
    this.most = [1, 1, 1];
    this.sign = 1;
    this.fit();
    this.knobs = [...this.wheelKnobs(), ...this.hingeKnobs()];
  }

  fit() {
    const fastest = Math.min(
      ...this.wheels.map((wheel) => this.volts * this.idle(wheel) * wheel.radius_m).filter((speed) => speed > 0),
    );
    const speed = Number.isFinite(fastest) ? roundDown(fastest) : 1,
      far = Math.max(...this.placed(this.parts.map(() => 0)).map(({ x, y }) => Math.hypot(x, y)));
    const angle = this.isSteered ? this.mostAngle() : 0;
    this.most = [speed, speed, this.isSteered ? angle : roundDown(speed / Math.max(far, 0.05))];
    this.able = [this.hasMotors, this.isSwerve && this.hasMotors, this.isSteered || this.hasMotors];
    this.labels = ["Forward", this.isSwerve ? "Left" : "", this.isSteered ? "Steer" : "Turn"];
    this.units = ["m/s", "m/s", this.isSteered ? "°" : "rad/s"];
    this.scales = [1, 1, this.isSteered ? DEGREES : 1];
    this.words = this.isSteered ? "Steer" : "Velocity";
    // A positive slider turns the vehicle to the left, also where the steered body is behind.
    this.sign = this.steered && this.motionAt(this.anglesAt(0.1)).turn < 0 ? -1 : 1;
  }

  hint(/** @type {string} */ mode) {
    if (mode === "scene")
      return "What the scene gives wheels and hinges over time. Touch a slider or a key to take over.";
    if (mode === "wheels") return "The voltage of each motor, and what each hinge is commanded.";
    if (this.isSwerve) return "Velocity of the body’s origin: all steered wheels point along it.";
    return this.isSteered
      ? "Speed of the body’s origin and angle of its steering, followed as fast as motor and limits allow."
      : "Velocity of the body’s origin; casters follow by themselves.";
  }

  /** Speed of a wheel for each volt while nothing holds it back; 0: it has no motor. */
  idle(/** @type {any} */ wheel) {
    if (wheel.driven === false) return 0;
    const { vehicle } = this.layout,
      own = vehicle.motor ? shaft(vehicle.motor) : vehicle;
    const gain = wheel.motor_gain_Nm_per_V ?? own.motor_gain_Nm_per_V ?? 0,
      damping = wheel.motor_damping_Nms ?? own.motor_damping_Nms ?? 0;
    return gain !== 0 && damping > 0 ? gain / damping : 0;
  }

  /** The largest angle of the steering: of wheels that steer together that of one in their middle. */
  mostAngle() {
    if (!this.together.length) return mostOf(/** @type {Part} */ (this.steered).hinge, USUAL_STEERING_RAD);
    const base = steeringBase(this.layout, this.together);
    const angles = this.together.map(({ at, hinge }) => {
      const stop = OF_STOPS * Math.min(-hinge.low, hinge.high);
      if (!Number.isFinite(stop)) return USUAL_STEERING_RAD;
      const ahead = Math.abs(at[0] - this.layout.axle.x_m); // the wheel at the inside turns farthest
      return Math.atan((Math.abs(base) * Math.tan(stop)) / (ahead + Math.abs(at[1]) * Math.tan(stop)));
    });
    return roundDown(Math.min(...angles) * DEGREES) / DEGREES;
  }

  // ---- what moves how

  /** Angles of all bodies where the steering is at one, all others straight; those of free bodies are not known. */
  anglesAt(/** @type {number} */ angle) {
    if (this.isSwerve) return this.parts.map((part) => this.directionOf(part, this.twist));
    if (!this.together.length) return this.parts.map((part) => (part === this.steered ? angle : 0));
    const curvature = Math.tan(angle) / steeringBase(this.layout, this.together),
      twist = [1, -this.layout.axle.x_m * curvature, curvature];
    return this.parts.map((part) => this.directionOf(part, twist));
  }

  directionOf(/** @type {Part} */ part, /** @type {number[]} */ [ahead, aside, turn]) {
    const [x, y] = part.at;
    return this.together.includes(part) ? Math.atan2(aside + turn * x, ahead - turn * y) : 0;
  }

  /** Each wheel in the body frame: its place, the way it rolls, and whether something guides it. */
  placed(/** @type {number[]} */ angles) {
    /** @type {{x: number, y: number, angle: number, isGuided: boolean}[]} */
    const frames = [];
    this.parts.forEach(({ parent, at, hinge }, k) => {
      if (parent < 0) return frames.push({ x: 0, y: 0, angle: 0, isGuided: true });
      const above = frames[parent],
        [x, y] = turned(at, above.angle);
      const isGuided = above.isGuided && hinge.kind !== "free";
      return frames.push({ x: above.x + x, y: above.y + y, angle: above.angle + angles[k], isGuided });
    });
    return this.wheels.map((wheel) => {
      const { x, y, angle, isGuided } = frames[wheel.of],
        [wx, wy] = turned([wheel.x_m, wheel.y_m], angle),
        way = angle + wheel.axle_rad + Math.PI / 2;
      return { wheel, x: x + wx, y: y + wy, along: [Math.cos(way), Math.sin(way)], isGuided };
    });
  }

  /** The motion at 1 m/s ahead that guided wheels allow, hinges held: least squares of their slips to the side. */
  motionAt(/** @type {number[]} */ angles, /** @type {number | undefined} */ turn = undefined) {
    let [yy, yt, tt, y1, t1] = [0, 0, 0, 0, 0];
    for (const { wheel, x, y, along, isGuided } of this.placed(angles)) {
      if (!isGuided || wheel.kind !== "fixed") continue;
      const [ax, ay] = [-along[1], along[0]], // slip = ax · ahead + ay · left + (ay x − ax y) · turn
        ofTurn = ay * x - ax * y;
      [yy, yt, tt] = [yy + ay * ay, yt + ay * ofTurn, tt + ofTurn * ofTurn];
      [y1, t1] = [y1 + ax * ay, t1 + ax * ofTurn];
    }
    const determinant = yy * tt - yt * yt;
    if (turn !== undefined) return { x: 1, y: yy > SMALL ? -(y1 + yt * turn) / yy : 0, turn };
    if (Math.abs(determinant) < SMALL) return { x: 1, y: yy > SMALL ? -y1 / yy : 0, turn: 0 };
    return { x: 1, y: (t1 * yt - y1 * tt) / determinant, turn: (y1 * yt - t1 * yy) / determinant };
  }

  /** Voltages at which all motors idle in a motion; all less where one would need more than there is. */
  voltages(/** @type {Twist} */ { x: ahead, y: left, turn }, /** @type {number[]} */ angles) {
    /** @type {number[]} */
    const found = new Array(this.wheels.length).fill(0);
    for (const { wheel, x, y, along } of this.placed(angles)) {
      const idle = this.idle(wheel),
        speed = (along[0] * (ahead - turn * y) + along[1] * (left + turn * x)) / wheel.radius_m;
      if (idle) found[wheel.number] = speed / idle;
    }
    const largest = Math.max(...found.map(Math.abs)),
      part = largest > this.volts ? this.volts / largest : 1;
    return found.map((value) => value * part);
  }

  // ---- signals

  /** What acts for a wanted velocity, or speed and steering. @returns {Record<string, number>} */
  driven(/** @type {number[]} */ wanted) {
    if (this.isSwerve) return this.swerved(wanted);
    const angle = this.isSteered ? this.sign * wanted[2] : 0,
      angles = this.anglesAt(angle),
      at = this.motionAt(angles, this.isSteered ? undefined : wanted[2]);
    const motion = this.isSteered
      ? { x: wanted[0], y: at.y * wanted[0], turn: at.turn * wanted[0] }
      : { ...at, x: wanted[0] };
    const volts = perWheel("voltage_V", this.voltages(motion, angles));
    return { ...volts, ...(this.isSteered && this.steering(angle, angles)) };
  }

  /** Steered wheels point along the velocity, or against it where that is nearer to where they point now. */
  swerved(/** @type {number[]} */ [x, y, turn]) {
    if (this.isEach) return this.aimed([x, y, turn]);
    const acting = this.robot.commands.steering_twist ?? this.twist,
      size = this.layout.size;
    if (x !== 0 || y !== 0 || turn !== 0) {
      const isAhead = x * acting[0] + y * acting[1] + turn * acting[2] * size * size >= 0;
      this.twist = [x, y, turn].map((value) => (isAhead ? value : -value));
    }
    const volts = this.voltages({ x, y, turn }, this.anglesAt(0));
    return { ...perWheel("voltage_V", volts), ...perWheel("steering_twist", this.twist) };
  }

  /** Modules that turn by themselves: each to its direction or the opposite one, whichever is nearer. A wheel drives
   * as far as it points there. @returns {Record<string, number>} */
  aimed(/** @type {number[]} */ twist) {
    const now = this.robot.outputs().hinge_angle_rad;
    if (twist.some((each) => each !== 0))
      this.aims = this.parts.map((part, k) => this.aimOf(part, twist, now[part.name], this.aims[k]));
    const volts = this.voltages({ x: twist[0], y: twist[1], turn: twist[2] }, this.aims);
    for (const { number, of } of this.wheels) {
      if (!this.together.includes(this.parts[of])) continue;
      const aligned = Math.cos(this.aims[of] - now[this.parts[of].name]);
      volts[number] *= Math.max(0, Math.round(ALIGNED_STEPS * aligned) / ALIGNED_STEPS);
    }
    return { ...perWheel("voltage_V", volts), ...this.turningEach(this.aims) };
  }

  /** @returns {number} */
  aimOf(
    /** @type {Part} */ part,
    /** @type {number[]} */ [ahead, aside, turn],
    /** @type {number} */ now,
    /** @type {number} */ before,
  ) {
    const [x, y] = part.at,
      [vx, vy] = [ahead - turn * y, aside + turn * x];
    if (!this.together.includes(part) || Math.hypot(vx, vy) < SMALL) return before;
    const quarters = Math.round(((part.wheels[0]?.axle_rad ?? -Math.PI / 2) + Math.PI / 2) / (Math.PI / 2)),
      way = Math.atan2(vy, vx) - (quarters * Math.PI) / 2;
    const angle = way + Math.PI * Math.round((now - way) / Math.PI),
      { low, high } = part.hinge;
    return angle > high ? angle - Math.PI : angle < low ? angle + Math.PI : angle;
  }

  /** The commands that bring the steering to an angle, or hinges that turn by themselves to theirs.
   * @returns {Record<string, number>} */
  steering(/** @type {number} */ angle, /** @type {number[]} */ angles) {
    if (this.isEach) return this.turningEach(angles);
    if (this.together.length)
      return { steering_curvature_per_m: Math.tan(angle) / steeringBase(this.layout, this.together) };
    return this.turning(/** @type {Part} */ (this.steered), angle);
  }

  /** @returns {Record<string, number>} */
  turningEach(/** @type {number[]} */ angles) {
    return Object.assign({}, ...this.together.map((part) => this.turning(part, angles[this.parts.indexOf(part)])));
  }

  /** The command that brings one hinge to an angle. @returns {Record<string, number>} */
  turning(/** @type {Part} */ { name, hinge }, /** @type {number} */ angle) {
    if (this.usesAngle(hinge)) return { [`steering_angle_rad[${name}]`]: angle };
    const left = angle - this.robot.outputs().hinge_angle_rad[name],
      rate = Math.abs(left) < SETTLED_RAD ? 0 : FOLLOWS_PER_S * left;
    if (hinge.kind === "prescribed" || hinge.follows) return { [`steering_rate_rad_per_s[${name}]`]: clamped(rate, mostRate(hinge)) };
    return { [`hinge_voltage_V[${name}]`]: clamped(rate / this.hingeIdle(hinge), this.hingeVolts(name)) };
  }

  /** Angles are followed within a limit of rate; a scene that gives rates keeps to them, as one hinge has one command.
   * Servos and position loops take angles. */
  usesAngle(/** @type {any} */ { name, kind, rateLimit, follows }) {
    const rate = `steering_rate_rad_per_s[${name}]`,
      isByRate = this.scene.input.some((/** @type {any} */ { signal }) => signal === rate);
    if (follows) return follows === "angle";
    return kind === "prescribed" && Number.isFinite(rateLimit) && !isByRate;
  }

  /** Rate of a hinge for each volt of its motor while nothing holds it back. */
  hingeIdle(/** @type {any} */ { place }) {
    const [, form, number] = /** @type {any} */ (/^vehicle\.(\w+)\[(\d+)\]$/.exec(place)),
      table = this.scene.vehicle[form][number - 1],
      motor = table.steering_motor ?? table.motor;
    const { motor_gain_Nm_per_V: gain, motor_damping_Nms: damping } = motor
      ? shaft(motor)
      : {
          motor_gain_Nm_per_V: table.steering_gain_Nm_per_V ?? table.gain_Nm_per_V,
          motor_damping_Nms: table.steering_damping_Nms ?? table.damping_Nms,
        };
    return gain / (damping || gain);
  }

  hingeVolts(/** @type {string} */ name) {
    return mostVoltage(this.scene, `hinge_voltage_V[${name}]`);
  }

  // ---- one by one

  wheelKnobs() {
    const signal = this.hasMotors ? "voltage_V" : "axle_torque_Nm",
      { mass_kg, wheel_radius_m } = this.layout.vehicle;
    return this.wheels
      .filter((wheel) => (this.hasMotors ? this.idle(wheel) > 0 : this.parts[wheel.of].hinge?.kind !== "free"))
      .sort((a, b) => a.number - b.number)
      .map(({ number, of }) => ({
        id: `wheel-${number}`,
        label: of > 0 && this.parts[of].wheels.length === 1 ? `Wheel of ${this.parts[of].name}` : `Wheel ${number + 1}`,
        unit: this.hasMotors ? "V" : "N·m",
        most: this.hasMotors ? this.volts : roundDown((mass_kg * wheel_radius_m) / 2),
        ...plainKnob(`${signal}[${number + 1}]`),
      }));
  }

  hingeKnobs() {
    const inDegreesPerS = { unit: "°/s", scale: DEGREES };
    if (this.isSwerve && !this.isEach)
      return ["ahead", "left", "yaw"].map((label, k) => ({
        id: `twist-${k}`,
        label: `Twist ${label}`,
        unit: "",
        most: 1.5,
        usual: this.twist[k],
        ...plainKnob(`steering_twist[${k + 1}]`),
      }));
    if (this.together.length && !this.isEach) return [this.curvatureKnob()];
    const usual = this.isSwerve ? Math.PI : USUAL_STEERING_RAD;
    return this.parts.flatMap(({ name, hinge }) => {
      const about = { id: `hinge-${name}`, label: `Hinge ${name}` };
      if (hinge?.kind === "motor" && !hinge.follows)
        return [{ ...about, unit: "V", most: this.hingeVolts(name), ...plainKnob(`hinge_voltage_V[${name}]`) }];
      if (hinge?.kind !== "prescribed" && !hinge?.follows) return [];
      return this.usesAngle(hinge)
        ? [{ ...about, unit: "°", scale: DEGREES, most: mostOf(hinge, usual), ...plainKnob(`steering_angle_rad[${name}]`) }]
        : [{ ...about, ...inDegreesPerS, most: mostRate(hinge), ...plainKnob(`steering_rate_rad_per_s[${name}]`) }];
    });
  }

  curvatureKnob() {
    const base = steeringBase(this.layout),
      signal = "steering_curvature_per_m";
    return {
      id: "steering",
      label: "Steering",
      unit: "°",
      scale: DEGREES,
      most: this.mostAngle(),
      of: (/** @type {number} */ level) => ({ [signal]: Math.tan(level) / base }),
      from: (/** @type {Record<string, number>} */ signals) => Math.atan((signals[signal] ?? 0) * base),
    };
  }

  /** A curve at half the speed from the start, where errors of methods show. @returns {Record<string, number>} */
  usual() {
    const half = this.most.map((value) => value / 2);
    if (this.isEach) return this.driven([half[0], 0, 0]);
    if (this.isSwerve || !this.steered || this.steered.hinge.follows) return this.driven(half);
    const { name, hinge } = this.steered,
      volts = perWheel("voltage_V", this.voltages({ x: half[0], y: 0, turn: 0 }, this.anglesAt(0))),
      rate = (this.sign * half[2]) / CURVE_S;
    return hinge.kind === "prescribed"
      ? { ...volts, [`steering_rate_rad_per_s[${name}]`]: clamped(rate, mostRate(hinge)) }
      : { ...volts, [`hinge_voltage_V[${name}]`]: clamped(rate / this.hingeIdle(hinge), this.hingeVolts(name)) };
  }
}

function plainKnob(/** @type {string} */ signal) {
  return {
    of: (/** @type {number} */ level) => ({ [signal]: level }),
    from: (/** @type {Record<string, number>} */ signals) => signals[signal] ?? 0,
  };
}

/** Gain and damping of a motor at its shaft. */
function shaft(/** @type {any} */ motor) {
  const { gear_ratio: n, resistance_ohm: ohm, viscous_friction_Nms: friction = 0 } = motor;
  return {
    motor_gain_Nm_per_V: (n * motor.torque_constant_Nm_per_A) / ohm,
    motor_damping_Nms: n * n * ((motor.torque_constant_Nm_per_A * motor.back_emf_Vs_per_rad) / ohm + friction),
  };
}

/** The largest angle of a hinge that a slider gives. */
function mostOf(/** @type {any} */ { low, high }, /** @type {number} */ usual) {
  const stop = OF_STOPS * Math.min(-low, high);
  return Number.isFinite(stop) ? roundDown(stop * DEGREES) / DEGREES : usual;
}

function mostRate(/** @type {any} */ { rateLimit }) {
  return Number.isFinite(rateLimit) ? OF_LIMIT * rateLimit : MOST_RATE;
}

function clamped(/** @type {number} */ value, /** @type {number} */ most) {
  return Math.max(-most, Math.min(most, value));
}

function turned(/** @type {number[]} */ [x, y], /** @type {number} */ angle) {
  const [cosine, sine] = [Math.cos(angle), Math.sin(angle)];
  return [cosine * x - sine * y, sine * x + cosine * y];
}
