// The same drive as a C program that links the core: robot, start, inputs, and the pose at the end.
import { inputOf } from "./drive.js";

const NESTED = ["payload", "ground", "drive"];
const OWN = [
  "radius_m",
  "inertia_kgm2",
  "motor_gain_Nm_per_V",
  "motor_damping_Nms",
  "friction_coefficient",
  "roller_drag",
  "axle_friction_Nm",
];
const C_CIRCUITS = { driven: "LACONIC_MOTOR_DRIVEN", open: "LACONIC_MOTOR_OPEN", shorted: "LACONIC_MOTOR_SHORTED" };
/** A wheel's own 0 takes the vehicle's value away: own key, the vehicle's member. */
const ZEROS = /** @type {[string, string][]} */ ([
  ["inertia_kgm2", "wheel_inertia_kgm2"],
  ["motor_gain_Nm_per_V", "motor_gain_Nm_per_V"],
  ["motor_damping_Nms", "motor_damping_Nms"],
  ["roller_drag", "ground.roller_drag"],
  ["axle_friction_Nm", "ground.axle_friction_Nm"],
]);

/** @param {any} scene @param {{method: string, step_s: number}} how @param {{changes: any[], steps: number}} drive */
export function cExample(scene, how, drive) {
  /** @type {{steps: number, input: any}[]} */
  const parts = stretches(drive, how.step_s, scene.vehicle.wheel.length);
  return `// ${commentText(scene.name)}: made by the page of Laconic. Compile it with the two files of the core:
// cc -std=c99 -O2 -I. robot.c laconic/laconic.c
#include <laconic/laconic.h>
#include <stdio.h>

${robotText(scene)}
static const struct {
    unsigned long steps;
    laconic_input held;
} drive[] = {
${parts.map(({ steps, input }) => `    {${steps}UL, {${inputText(input)}}},`).join("\n")}
};

static int refused(const laconic_refusal *why) {
    char text[200];
    laconic_message(why, text, sizeof text);
    fprintf(stderr, "%s\\n", text);
    return 1;
}

int main(void) {
    laconic_start start = {${startText(scene.initial ?? {})}};
    laconic_plant plant;
    laconic_pose pose;
    laconic_refusal why;
    const laconic_method *method = laconic_method_by_name("${how.method}");
${setupText(scene)}    if (laconic_plant_start(&plant, &robot, method, ${how.step_s}, &start, &why)) return refused(&why);
    for (size_t i = 0; i < sizeof drive / sizeof drive[0]; i++)
        if (laconic_plant_run(&plant, &drive[i].held, drive[i].steps, &why)) return refused(&why);
    laconic_pose_of(&pose, &plant.model, &plant.state);
    printf("x = %.17g m, y = %.17g m, heading %.17g rad\\n", pose.x_m, pose.y_m, pose.heading_rad);
    return 0;
}
`;
}

function commentText(/** @type {string} */ text) {
  return text.replace(/\s+/g, " ").replace(/[\\?]/g, ""); // nothing that would go on in the next line
}

/** The drive as stretches of held inputs. */
function stretches(/** @type {any} */ drive, /** @type {number} */ step_s, /** @type {number} */ wheels) {
  const begins = drive.changes.map((/** @type {any} */ each) => Math.round(each.t_s / step_s));
  const found = drive.changes.map((/** @type {any} */ each, /** @type {number} */ i) => ({
    steps: (begins[i + 1] ?? drive.steps) - begins[i],
    input: inputOf(each.signals, wheels),
  }));
  if (begins[0] !== 0) found.unshift({ steps: begins[0] ?? drive.steps, input: {} });
  return found.filter((/** @type {{steps: number}} */ { steps }) => steps > 0);
}

function list(/** @type {any} */ value) {
  return Array.isArray(value) ? `{${value.join(", ")}}` : String(value);
}

function members(/** @type {any} */ given) {
  return Object.entries(given)
    .map(([key, value]) => `.${key} = ${list(value)}`)
    .join(", ");
}

function inputText(/** @type {any} */ input) {
  return members(Object.keys(input).length ? input : { body_moment_Nm: 0 });
}

function robotText(/** @type {any} */ scene) {
  const {
    wheel,
    support = [],
    motor,
    ...vehicle
  } = { ...scene.vehicle, ...(scene.ground && { ground: scene.ground }) };
  const plain = Object.entries(vehicle)
    .filter(([key]) => !NESTED.includes(key))
    .map(([key, value]) => `    .${key} = ${value},`);
  const nested = NESTED.filter((key) => vehicle[key]).map((key) => `    .${key} = {${members(vehicle[key])}},`);
  const lines = [...plain, ...nested, `    .wheel_count = ${wheel.length},`];
  if (wheel.length)
    lines.push("    .wheel = {", ...wheel.map((/** @type {any} */ each) => `        {${wheelText(each)}},`), "    },");
  if (support.length)
    lines.push(
      `    .support_count = ${support.length},`,
      `    .support = {${support.map((/** @type {any} */ each) => `{${members(each)}}`).join(", ")}},`,
    );
  const motorText = motor ? `static const laconic_motor motor = {${members(motor)}};\n` : "";
  return `static laconic_vehicle robot = {\n${lines.join("\n")}\n};\n${motorText}`;
}

function wheelText(/** @type {any} */ { kind, driven = true, motor_circuit, ...rest }) {
  const named = Object.entries(rest).map(([key, value]) => [OWN.includes(key) ? `own_${key}` : key, value]);
  return members({
    kind: kind === "fixed" ? "LACONIC_WHEEL_FIXED" : "LACONIC_WHEEL_ROLLER",
    ...Object.fromEntries(named),
    ...(driven ? {} : { undriven: true }),
    ...(motor_circuit && { motor_circuit: C_CIRCUITS[/** @type {keyof typeof C_CIRCUITS} */ (motor_circuit)] }),
  });
}

function startText(/** @type {any} */ { velocity_body_m_per_s, yaw_rate_rad_per_s, ...given }) {
  return Object.keys(given).length ? members(given) : "0";
}

/** What is done before the plant starts: own zeros, the motor, a start given as a velocity. */
function setupText(/** @type {any} */ scene) {
  const lines = [
    ...zeroLines(scene, ZEROS.slice(0, 1)),
    ...(scene.vehicle.motor ? ["if (laconic_motor_fit(&robot, &motor, &why)) return refused(&why);"] : []),
    ...zeroLines(scene, ZEROS.slice(1)),
    ...velocityLines(scene.initial ?? {}),
  ];
  return lines.map((line) => `    ${line}\n`).join("");
}

function zeroLines(/** @type {any} */ scene, /** @type {[string, string][]} */ keys) {
  const wheels = scene.vehicle.wheel;
  return keys
    .filter(([key]) => wheels.some((/** @type {any} */ wheel) => wheel[key] === 0))
    .flatMap(([key, common]) => [
      ...wheels.flatMap((/** @type {any} */ wheel, /** @type {number} */ i) =>
        wheel[key] === undefined ? [`robot.wheel[${i}].own_${key} = robot.${common};`] : [],
      ),
      `robot.${common} = 0;`,
    ]);
}

function velocityLines(
  /** @type {any} */ { velocity_body_m_per_s: [forward, left] = [0, 0], yaw_rate_rad_per_s: turn = 0 },
) {
  if (forward === 0 && left === 0 && turn === 0) return [];
  return [
    "laconic_model model;",
    "if (laconic_prepare(&model, &robot, &why)) return refused(&why);",
    `start.nu_rad_per_s[0] = ${forward} / model.wheel_radius_m;`,
    `start.nu_rad_per_s[1] = ${left} / model.wheel_radius_m;`,
    `start.nu_rad_per_s[2] = model.yaw_scale * ${turn};`,
  ];
}
