/** Laconic for vehicles with hinges: steered wheels, swivel casters, trailers, loaders. Units are SI. */
import type { Ground, Input, Scene, Vehicle, Wheel } from "./index.js";

export { Refused } from "./index.js";

/** Limits of a hinge, and its start. */
export interface HingeLimits {
  stop_low_rad?: number;
  stop_low_deg?: number;
  stop_high_rad?: number;
  stop_high_deg?: number;
  start_angle_rad?: number;
  start_angle_deg?: number;
  start_rate_rad_per_s?: number;
}

/** Of a hinge that follows a command. */
export interface HingeCommandLimits extends HingeLimits {
  rate_limit_rad_per_s?: number;
  at_limit?: "saturate" | "refuse";
}

/** The motor of a hinge at its shaft. */
export interface HingeMotor {
  resistance_ohm: number;
  torque_constant_Nm_per_A: number;
  back_emf_Vs_per_rad: number;
  gear_ratio: number;
  viscous_friction_Nms?: number;
  rotor_inertia_kgm2?: number;
  current_limit_A?: number;
}

/** Of a wheel on ground with friction. */
export interface Contact {
  load_N?: number;
  scrub_radius_m?: number;
  scrub_fade_m?: number;
  creep?: number;
}

/** Of a hinge on ground with friction: servo, or loop of its motor. */
export interface Turned {
  com_z_m?: number;
  dry_friction_Nm?: number;
  servo_gain_Nm_per_rad?: number;
  servo_damping_Nms?: number;
  servo_limit_Nm?: number;
  loop_V_per_rad?: number;
  loop_Vs_per_rad?: number;
  control_period_s?: number;
}

/** A wheel of the carriage or of the body that it names. A steered one may have no axle: it then rolls ahead. */
export interface HingedWheel extends Wheel, HingeCommandLimits, Contact, Turned {
  body?: string;
  steered?: "coordinated" | "prescribed" | "motor" | "servo";
  name?: string;
  scrub_m?: number;
  mass_kg?: number;
  yaw_inertia_kgm2?: number;
  steering_gain_Nm_per_V?: number;
  steering_damping_Nms?: number;
  steering_motor?: HingeMotor;
}

/** What a caster and a trailer have. */
export interface Towed extends HingeLimits, Contact {
  com_z_m?: number;
  dry_friction_Nm?: number;
  name?: string;
  parent?: string;
  radius_m: number;
  mass_kg?: number;
  yaw_inertia_kgm2?: number;
  com_x_m?: number;
  wheel_inertia_kgm2?: number;
  damping_Nms?: number;
}

export interface Caster extends Towed {
  x_m: number;
  y_m: number;
  trail_m: number;
  offset_m?: number;
  twin_m?: number;
  driven?: boolean;
}

export interface Trailer extends Towed {
  hitch_x_m: number;
  hitch_y_m?: number;
  length_m: number;
  track_m: number;
}

/** Any body on a vertical hinge. */
export interface Body extends HingeCommandLimits, Turned {
  hitch?: boolean;
  name: string;
  parent?: string;
  hinge: "free" | "motor" | "prescribed" | "coordinated";
  hinge_x_m: number;
  hinge_y_m?: number;
  mass_kg: number;
  yaw_inertia_kgm2: number;
  com_x_m?: number;
  com_y_m?: number;
  damping_Nms?: number;
  stiffness_Nm?: number;
  rest_rad?: number;
  rest_deg?: number;
  gain_Nm_per_V?: number;
  motor?: HingeMotor;
}

/** Mass, inertia and centre of mass are those of the carriage alone with its own wheels. */
export interface HingedVehicle extends Omit<Vehicle, "wheel"> {
  wheel?: HingedWheel[];
  caster?: Caster[];
  trailer?: Trailer[];
  body?: Body[];
}

/** A scene with the keys of its TOML file. */
export interface HingedScene extends Omit<Scene, "vehicle" | "ground" | "run"> {
  vehicle: HingedVehicle;
  /** With friction_coefficient wheels may slip; some keys of hinges and wheels act there alone. */
  ground?: Ground;
  run?: { step_s?: number; method?: MethodName };
}

/** In the package: the names of the core's methods for hinges. */
export type MethodName = string;

/** Numbers by the names of hinges or bodies. */
export type ByName = Record<string, number>;

/** What acts; what is not given is 0. Coordinated wheels point straight ahead without a command. */
export interface HingedInput extends Input {
  hinge_voltage_V?: ByName;
  hinge_torque_Nm?: ByName;
  /** Of prescribed hinges. */
  steering_rate_rad_per_s?: ByName;
  /** Of prescribed hinges by name; one number is that of a wheel on the middle line, for coordinated wheels. */
  steering_angle_rad?: ByName | number;
  /** Motion along which coordinated wheels point: ahead, to the left, yaw rate; only their proportion counts. */
  steering_twist?: ArrayLike<number>;
  steering_curvature_per_m?: number;
}

export interface HingedOutputs {
  /** Of the carriage's centre of mass, in body axes: ahead, to the left. */
  velocity_body_m_per_s: number[];
  yaw_rate_rad_per_s: number;
  /** Of the carriage's centre of mass. */
  x_m: number;
  y_m: number;
  /** Not wrapped. */
  heading_rad: number;
  /** Of each hinge, not wrapped. */
  hinge_angle_rad: ByName;
  hinge_rate_rad_per_s: ByName;
  /** Place of each body's hinge in the world, and direction of the body in (−π, π]. */
  body_x_m: ByName;
  body_y_m: ByName;
  body_heading_rad: ByName;
  /** Of the vehicle's wheels, then those of casters and trailers. */
  wheel_speed_rad_per_s: number[];
  wheel_angle_rad: number[];
  energy_J: number;
  /** From here on of ground with friction alone; docs/signals.md names them. Forces are those of the ground on wheels. */
  slip_along_m_per_s?: number[];
  slip_across_m_per_s?: number[];
  /** 0 sticks or rolls, 1 slips, 2 has lifted. */
  contact_state?: number[];
  along_N?: number[];
  /** 90 degrees to the right of along_N; slip_across_m_per_s counts to the left. */
  lateral_N?: number[];
  scrub_Nm?: number[];
  /** Of wheels, then of supports. */
  normal_N?: number[];
  wheel_torque_Nm?: number[];
  hinge_torque_Nm?: ByName;
  friction_torque_Nm?: ByName;
  stop_torque_Nm?: ByName;
  /** Of wheels, then of hinges. */
  motor_current_A?: number[];
  drive_limit?: number[];
  supply_current_A?: number;
  supply_voltage_V?: number;
  spring_energy_J?: number;
  supply_energy_J?: number;
  outer_work_J?: number;
  servo_work_J?: number;
  slip_loss_J?: number;
  scrub_loss_J?: number;
  axle_loss_J?: number;
  hinge_loss_J?: number;
  stop_loss_J?: number;
  motor_loss_J?: number;
  supply_loss_J?: number;
  numerical_loss_J?: number;
}

/** Forces that ground and hinges must deliver. */
export interface HingedReactions {
  wheel_torque_Nm: number[];
  along_N: number[];
  lateral_N: number[];
  brake_Nm: number[];
  hinge_reaction_Nm: ByName;
  /** Of the parent on the body at its hinge, in the body's axes. */
  hinge_force_along_N: ByName;
  hinge_force_across_N: ByName;
}

/** A limit that held a command back. */
export interface Limited {
  hinge: string;
  limit: "rate" | "angle";
  first_s: number;
  steps: number;
}

/** A vehicle with hinges at its start; free() gives its memory back. */
export class HingedRobot {
  private constructor();
  readonly step_s: number;
  /** Names of the bodies, parents first. */
  readonly bodies: string[];
  readonly wheelCount: number;
  readonly bodyCount: number;
  readonly steps: number;
  readonly time_s: number;
  /** What acts: the twist of coordinated wheels and the rates of prescribed hinges. */
  readonly commands: { steering_twist?: number[]; steering_rate_rad_per_s: ByName };
  /** Which limits held commands back; a scene with at_limit = "refuse" refuses instead. */
  readonly limited: Limited[];
  /**
   * Sets what acts from now on; before the first step also where coordinated wheels point at the start. A new twist is
   * reached within one step, or as fast as limits allow. @throws Refused; nothing changes then
   */
  setInput(input: HingedInput): void;
  /** @throws Refused where a step cannot be taken or a limit refuses; the steps before it were */
  run(steps: number): void;
  outputs(): HingedOutputs;
  /** @throws Refused where the wheels allow no motion, and where they may slip */
  reactions(): HingedReactions;
  free(): void;
}

export class LaconicHinges {
  private constructor();
  readonly version: string;
  readonly maxWheels: number;
  readonly maxBodies: number;
  readonly methods: { name: MethodName; order: number }[];
  /** Whether this engine computes as the core requires. */
  readonly arithmeticIsSound: boolean;
  /** @throws Refused */
  robot(scene: HingedScene, run?: { method?: MethodName; step_s?: number }): HingedRobot;
}

/** Loads the core's part for hinges. */
export function load(): Promise<LaconicHinges>;
