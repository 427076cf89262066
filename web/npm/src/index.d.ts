/** Laconic: the dynamics of wheeled robots. Units are SI and stand in the names; angles in rad. */

/** Omni: rollers square to the axle. Mecanum: rollers at roller_rad to the axle. */
export type WheelKind = "omni" | "mecanum" | "roller" | "fixed";

/** One wheel; its place in the body frame: x ahead, y to the left, or distance_m and bearing_rad. */
export interface Wheel {
  kind: WheelKind;
  x_m?: number;
  y_m?: number;
  distance_m?: number;
  bearing_rad?: number;
  bearing_deg?: number;
  /** Direction of the axle; a wheel that rolls ahead has −π/2. */
  axle_rad?: number;
  axle_deg?: number;
  /** From the axle to the roller's axis. */
  roller_rad?: number;
  roller_deg?: number;
  locked?: boolean;
  driven?: boolean;
  motor_circuit?: "driven" | "open" | "shorted";
  radius_m?: number;
  inertia_kgm2?: number;
  motor_gain_Nm_per_V?: number;
  motor_damping_Nms?: number;
  friction_coefficient?: number;
  roller_drag?: number;
  axle_friction_Nm?: number;
}

export interface Vehicle {
  mass_kg: number;
  /** About the vertical through the centre of mass, wheels included. */
  yaw_inertia_kgm2: number;
  com_x_m?: number;
  com_y_m?: number;
  com_z_m?: number;
  wheel_radius_m: number;
  wheel_inertia_kgm2?: number;
  motor_gain_Nm_per_V?: number;
  motor_damping_Nms?: number;
  /** For the no-slip margin only. */
  friction_coefficient?: number;
  motor?: {
    resistance_ohm: number;
    torque_constant_Nm_per_A: number;
    back_emf_Vs_per_rad: number;
    gear_ratio: number;
    viscous_friction_Nms?: number;
    rotor_inertia_kgm2?: number;
  };
  drive?: { supply_V?: number; supply_resistance_ohm?: number; current_limit_A?: number };
  payload?: { mass_kg: number; x_m: number; y_m: number; yaw_inertia_kgm2: number };
  wheel: Wheel[];
  support?: { x_m: number; y_m: number }[];
}

/** With a friction coefficient wheels slip. */
export interface Ground {
  friction_coefficient?: number;
  roller_drag?: number;
  axle_friction_Nm?: number;
  slope_rad?: number;
  slope_deg?: number;
  slope_heading_rad?: number;
  slope_heading_deg?: number;
}

/** A scene with the keys of its TOML file. */
export interface Scene {
  name?: string;
  vehicle: Vehicle;
  ground?: Ground;
  initial?: {
    nu_rad_per_s?: number[];
    velocity_body_m_per_s?: number[];
    yaw_rate_rad_per_s?: number;
    x_m?: number;
    y_m?: number;
    heading_rad?: number;
    wheel_speed_rad_per_s?: number[];
  };
  run?: { step_s?: number; method?: MethodName };
}

/** In the package: the names of the core's methods. */
export type MethodName = string;

/** What acts, one item for each wheel; what is not given is 0. */
export interface Input {
  voltage_V?: ArrayLike<number>;
  axle_torque_Nm?: ArrayLike<number>;
  body_force_N?: ArrayLike<number>;
  body_moment_Nm?: number;
  world_force_N?: ArrayLike<number>;
  world_force_point_m?: ArrayLike<number>;
}

export interface Outputs {
  nu_rad_per_s: number[];
  /** Of the centre of mass, in body axes: ahead, to the left. */
  velocity_body_m_per_s: number[];
  yaw_rate_rad_per_s: number;
  energy_J: number;
  /** Of the centre of mass. */
  x_m: number;
  y_m: number;
  origin_x_m: number;
  origin_y_m: number;
  heading_rad: number;
  heading_wrapped_rad: number;
  wheel_speed_rad_per_s: number[];
  wheel_angle_rad: number[];
  wheel_torque_Nm: number[];
  along_N: number[];
  lateral_N: number[];
  brake_Nm: number[];
  /** Wheels, then supports. */
  normal_N: number[];
  no_slip_margin_N: number;
  /** From here on: only with friction or limits of the drive. 0 sticks or rolls, 1 slips, 2 has lifted. */
  contact_state?: number[];
  slip_along_m_per_s?: number[];
  slip_across_m_per_s?: number[];
  drive_limit?: number[];
  motor_current_A?: number[];
  supply_current_A?: number;
  supply_voltage_V?: number;
  supply_energy_J?: number;
  slip_loss_J?: number;
}

/** What is refused, by the core or before it: `message` names the field, what is wrong and the remedy in one line. */
export class Refused extends Error {
  readonly path: string;
  readonly explanation: string;
  readonly status: string;
  readonly value: number;
  readonly limit: number;
}

/** A robot at its start; free() gives its memory back. */
export class Robot {
  private constructor();
  readonly step_s: number;
  readonly wheelCount: number;
  readonly pointCount: number;
  readonly hasFriction: boolean;
  readonly steps: number;
  readonly time_s: number;
  /**
   * Sets what acts from now on. @throws Refused for an unknown input, a list of another length, and what is no finite
   * number; nothing changes then
   */
  setInput(input: Input): void;
  /** @throws Refused for no whole number, and where a step cannot be taken; the steps before it were */
  run(steps: number): void;
  outputs(): Outputs;
  /** Least voltages that hold a velocity of the body's origin on ideal ground [m/s, m/s, rad/s]. */
  voltagesFor(forward: number, left: number, turn: number): number[];
  /** Least axle torques [N·m] that accelerate the body's origin so from rest; 0: fixed wheels hold it. */
  torquesFor(forward: number, left: number, turn: number): number[];
  /** The nearest velocity of the body's origin that the wheels allow. */
  allowed(forward: number, left: number, turn: number): number[];
  /** Motor gain of a wheel, counted from 0 [N·m/V]; 0: it has no motor. @throws Refused without such a wheel */
  motorGain(wheel: number): number;
  free(): void;
}

export class Laconic {
  private constructor();
  readonly version: string;
  readonly maxWheels: number;
  readonly methods: { name: MethodName; order: number }[];
  /** Whether this engine computes as the core requires. */
  readonly arithmeticIsSound: boolean;
  /** @throws Refused */
  robot(scene: Scene, run?: { method?: MethodName; step_s?: number }): Robot;
  /** Numbers that depend on every bit of many trajectories: of six methods together, then of each later one; equal on
   * every platform. */
  hash(): string;
}

/** Loads the core. */
export function load(): Promise<Laconic>;
