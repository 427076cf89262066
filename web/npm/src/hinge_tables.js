// Bodies on hinges in a scene: steered wheels, casters and trailers, and the general body that they are short for.
import { askFinite, askFlag, askList, askTable, toldOf, unknownKey } from "./checks.js";
import { OF_WHEELS, contactOf, noEffect, parentKey, refusedForGround, turnedBy } from "./hinge_friction.js";
import { HINGE_KEYS } from "./hinge_keys.js";
import { Refused } from "./refused.js";
import { inPlace, inRad } from "./scene.js";

/**
 * @typedef {{name: string, kind: string, place: string, low: number, high: number, rateLimit: number,
 *   refuses: boolean, angle: number, rate: number, follows: string}} Hinge what the core does not know of a hinge
 * @typedef {Record<string, any>} Body the numbers of a body, its name, its parent's name and its hinge's kind
 * @typedef {{table: Record<string, any>, body: string, place: string, contact: Record<string, number>}} Wheel
 *   a wheel without what its body is
 * @typedef {{body: Body, hinge: Hinge, wheels: Wheel[]}} Part what one table contributes
 * @typedef {{bodies: Body[], hinges: Hinge[], wheels: Wheel[]}} Hung all of a vehicle, parents first
 */

export const CARRIAGE = "carriage";
export const HINGE_KINDS = ["free", "motor", "prescribed", "coordinated"]; // numbered from 1
const COMMANDED = ["prescribed", "coordinated"];
const ROLLS_FORWARD_RAD = -Math.PI / 2; // the axle of a wheel whose positive speed is forward
const NAME = /^[\p{L}_][\p{L}\p{N}_-]*$/u; // it stands in brackets behind a signal
const OF_EACH_WHEEL = ["body", "steered", ...OF_WHEELS];
/** @type {Record<string, {holds: (value: number) => boolean, give: string}>} */
const RULES = {
  POSITIVE: { holds: (value) => value > 0, give: "is not positive; give a value above 0" },
  NOT_NEGATIVE: { holds: (value) => value >= 0, give: "is negative; give 0 or more" },
  NOT_ZERO: { holds: (value) => value !== 0, give: "is 0; give another value" },
};

function isCommanded(/** @type {string} */ kind) {
  return COMMANDED.includes(kind);
}

/** Every body that a vehicle has, and all its wheels with the names of their bodies; `slips`: the ground has friction.
 * @param {any} vehicle @param {boolean} slips @returns {Hung} */
export function readHinges(vehicle, slips) {
  const lists = Object.fromEntries(["wheel", "body", "caster", "trailer"].map((form) => [form, listOf(vehicle, form)]));
  /** @type {Wheel[]} */
  const wheels = [];
  /** @type {Part[]} */
  const parts = lists.body.map(({ place, given }) => general(place, given, slips));
  lists.wheel.forEach(({ place, given }, index) => {
    const { wheel, part } = ownWheel(place, given, index + 1, slips);
    wheels.push(wheel);
    if (part) parts.push(part);
  });
  const short = [...lists.caster.map(({ place, given }, index) => caster(place, given, index + 1, slips))];
  short.push(...lists.trailer.map(({ place, given }, index) => trailer(place, given, index + 1, slips)));
  const sorted = parentsFirst(checkNames([...parts, ...short]));
  const names = [CARRIAGE, ...sorted.map(({ hinge }) => hinge.name)];
  for (const { body, place } of wheels)
    if (!names.includes(body)) throw noBody(`${place}.body`, body, names);
  wheels.push(...short.flatMap((part) => part.wheels));
  return { bodies: sorted.map(({ body }) => body), hinges: sorted.map(({ hinge }) => hinge), wheels };
}

function listOf(/** @type {any} */ vehicle, /** @type {string} */ form) {
  const given = vehicle[form] ?? [];
  askList(`vehicle.${form}`, given);
  return Array.from(given, (each, index) => {
    const place = `vehicle.${form}[${index + 1}]`;
    return { place, given: inRad(place, askTable(place, each)) };
  });
}

/** The values of a table's keys, with those that are left out; `others` are read elsewhere. */
function read(
  /** @type {string} */ place,
  /** @type {Record<string, any>} */ given,
  /** @type {(key: string) => boolean} */ isOther = () => false,
) {
  const known = HINGE_KEYS[place.replaceAll(/\[\d+\]/g, "[#]")];
  for (const key of Object.keys(given))
    if (!Object.hasOwn(known, key) && !isOther(key)) throw unknownKey(`${place}.${key}`, Object.keys(known));
  return Object.fromEntries(
    Object.entries(known).map(([key, traits]) => [key, valueOf(`${place}.${key}`, given[key], traits)]),
  );
}

function valueOf(/** @type {string} */ path, /** @type {any} */ given, /** @type {any} */ traits) {
  if (given === undefined) {
    if ("default" in traits) return traits.default;
    const give = traits.choices ? `one of ${traits.choices.join(", ")}` : traits.kind === "text" ? "a text" : "a number";
    throw new Refused(path, `is missing; give ${give}`, "missing");
  }
  if (traits.kind === "true or false") return askFlag(path, given);
  if (traits.kind === "number") return checkedNumber(path, given, traits.rule);
  if (typeof given !== "string")
    throw new Refused(path, `${toldOf(given)} is no text; give one in quotes, or take it out`, "not a text");
  if (traits.choices && !traits.choices.includes(given))
    throw new Refused(path, `there is no ${toldOf(given)}; use ${traits.choices.join(", ")}`, "unknown kind");
  return given;
}

function checkedNumber(/** @type {string} */ path, /** @type {any} */ given, /** @type {string | undefined} */ rule) {
  const value = askFinite(path, given);
  if (rule && !RULES[rule].holds(value)) throw new Refused(path, `${value} ${RULES[rule].give}`, "out of range", value);
  return value;
}

/** A wheel of the vehicle's own list; a steered one is a body with the wheel under its hinge. */
function ownWheel(
  /** @type {string} */ place,
  /** @type {Record<string, any>} */ given,
  /** @type {number} */ number,
  /** @type {boolean} */ slips,
) {
  const isOfHinge = (/** @type {string} */ key) => Object.hasOwn(HINGE_KEYS["vehicle.wheel[#]"], key);
  const table = Object.fromEntries(Object.entries(given).filter(([key]) => !isOfHinge(key)));
  delete table.steering_motor;
  const own = read(place, given, () => true),
    body = own.body ?? CARRIAGE,
    contact = contactOf(place, given, own, slips);
  if (own.steered === null) {
    for (const key of Object.keys(given))
      if ((isOfHinge(key) && !OF_EACH_WHEEL.includes(key)) || key === "steering_motor")
        throw noEffect(`${place}.${key}`, "has a meaning for a steered wheel alone; give steered, or take it out");
    return { wheel: { table, body, place, contact }, part: undefined };
  }
  if (table.kind !== "fixed")
    throw new Refused(`${place}.kind`, `is ${toldOf(table.kind)}; a steered wheel is "fixed" to what turns it`, "kind");
  if (own.steered === "servo" && !slips)
    throw new Refused(
      `${place}.steered`,
      '"servo" gives way, which needs ground.friction_coefficient; give it, or "prescribed"',
      "no effect",
    );
  const hinge = hingeOf(place, own, own.steered, `wheel_${number}`),
    at = placeOf(place, table);
  const turned = { name: hinge.name, parent: body, hinge: own.steered, hinge_x_m: at.x_m, hinge_y_m: at.y_m };
  const numbers = { ...turned, mass_kg: own.mass_kg, yaw_inertia_kgm2: own.yaw_inertia_kgm2 };
  const motor = motorOf(place, given, own, own.steered, "steering_", slips);
  const under = { axle_rad: ROLLS_FORWARD_RAD, ...at.rest, x_m: 0, y_m: own.scrub_m };
  return {
    wheel: { table: under, body: hinge.name, place, contact },
    part: turnedBy({ body: withMotor(numbers, motor), hinge, wheels: [] }, given, own, slips),
  };
}

function placeOf(/** @type {string} */ path, /** @type {Record<string, any>} */ table) {
  const { x_m, y_m, ...rest } = inPlace(path, table);
  for (const [key, value] of Object.entries({ x_m, y_m }))
    if (value === undefined) throw new Refused(`${path}.${key}`, "is missing; give a number", "missing");
  return { x_m: askFinite(`${path}.x_m`, x_m), y_m: askFinite(`${path}.y_m`, y_m), rest };
}

function caster(
  /** @type {string} */ place,
  /** @type {Record<string, any>} */ given,
  /** @type {number} */ number,
  /** @type {boolean} */ slips,
) {
  const own = read(place, given),
    left = own.twin_m === null ? [own.offset_m] : [own.offset_m + own.twin_m / 2, own.offset_m - own.twin_m / 2];
  const hinge = hingeOf(place, own, "free", `caster_${number}`);
  const part = freePart(hinge, own, { hinge_x_m: own.x_m, hinge_y_m: own.y_m }, own.trail_m, left, own.driven ?? false);
  return slidingPart(part, given, own, slips);
}

function trailer(
  /** @type {string} */ place,
  /** @type {Record<string, any>} */ given,
  /** @type {number} */ number,
  /** @type {boolean} */ slips,
) {
  const own = read(place, given),
    half = own.track_m / 2;
  const hinge = hingeOf(place, own, "free", `trailer_${number}`);
  const at = { hinge_x_m: own.hitch_x_m, hinge_y_m: own.hitch_y_m, ...(slips && { hitch: true }) };
  return slidingPart(freePart(hinge, own, at, own.length_m, [half, -half], false), given, own, slips);
}

/** What a caster or trailer and its wheels have where these may slip. @returns {Part} */
function slidingPart(/** @type {Part} */ part, /** @type {any} */ given, /** @type {any} */ own, /** @type {boolean} */ slips) {
  const { place } = part.hinge,
    contact = contactOf(place, given, own, slips);
  if (slips && !own.wheel_inertia_kgm2)
    throw new Refused(
      `${place}.wheel_inertia_kgm2`,
      "is 0, and a wheel that may slip has a speed of its own; give a value above 0",
      "out of range",
    );
  return turnedBy({ ...part, wheels: part.wheels.map((each) => ({ ...each, contact })) }, given, own, slips);
}

/** A body on a free hinge with wheels on one axle behind it. */
function freePart(
  /** @type {Hinge} */ hinge,
  /** @type {Record<string, any>} */ own,
  /** @type {Record<string, any>} */ at,
  /** @type {number} */ behind,
  /** @type {number[]} */ left,
  /** @type {boolean} */ driven,
) {
  const { mass_kg, yaw_inertia_kgm2, damping_Nms } = own;
  const body = { name: hinge.name, parent: own.parent ?? CARRIAGE, hinge: "free", ...at };
  const numbers = { com_x_m: own.com_x_m ?? -behind, mass_kg, yaw_inertia_kgm2, damping_Nms };
  const table = { kind: "fixed", x_m: -behind, axle_rad: ROLLS_FORWARD_RAD, driven, radius_m: own.radius_m };
  const wheels = left.map((y_m) => ({
    table: { ...table, y_m, inertia_kgm2: own.wheel_inertia_kgm2 },
    body: hinge.name,
    place: hinge.place,
    contact: {},
  }));
  return { body: { ...body, ...numbers }, hinge, wheels };
}

function general(/** @type {string} */ place, /** @type {Record<string, any>} */ given, /** @type {boolean} */ slips) {
  const own = read(place, given, (key) => key === "motor"),
    kind = slips && own.hinge === "free" && own.servo_gain_Nm_per_rad ? "servo" : own.hinge,
    hinge = hingeOf(place, own, kind, undefined);
  const numbers = ["hinge_x_m", "hinge_y_m", "mass_kg", "yaw_inertia_kgm2", "com_x_m", "com_y_m", "stiffness_Nm"];
  const body = { name: hinge.name, parent: own.parent ?? CARRIAGE, hinge: own.hinge, rest_rad: own.rest_rad };
  const motor = motorOf(place, given, own, own.hinge, "", slips);
  const found = withMotor({ ...body, ...Object.fromEntries(numbers.map((key) => [key, own[key]])) }, motor);
  for (const key of ["damping_Nms", "stiffness_Nm"])
    if (isCommanded(own.hinge) && found[key])
      throw noEffect(`${place}.${key}`, `has no effect on a ${own.hinge} hinge, whose rate is an input; take it out`);
  if (given.hitch !== undefined && !slips) throw refusedForGround(`${place}.hitch`);
  if (own.hitch) found.hitch = true;
  return turnedBy({ body: found, hinge, wheels: [] }, given, own, slips);
}

/** Gain, damping and inertia of a hinge: given directly, or those of a motor at its shaft. */
function motorOf(
  /** @type {string} */ place,
  /** @type {Record<string, any>} */ given,
  /** @type {Record<string, any>} */ own,
  /** @type {string} */ kind,
  /** @type {string} */ prefix,
  /** @type {boolean} */ slips,
) {
  const key = `${prefix}motor`,
    gain = `${prefix}gain_Nm_per_V`,
    damping = `${prefix}damping_Nms`;
  const direct = { gain_Nm_per_V: own[gain], damping_Nms: own[damping], inertia: 0 };
  if (kind !== "motor") {
    const unused = given[key] !== undefined ? key : given[gain] ? gain : "";
    if (unused)
      throw noEffect(
        `${place}.${unused}`,
        `is given for a hinge that is "${kind}"; take it out, or make the hinge "motor"`,
      );
    return direct;
  }
  if (given[key] === undefined) {
    if (!direct.gain_Nm_per_V)
      throw new Refused(`${place}.${gain}`, `is missing; give it, or a table ${key}, for a hinge with a motor`, "missing");
    return direct;
  }
  for (const each of [gain, damping])
    if (given[each] !== undefined) throw noEffect(`${place}.${each}`, `is given besides ${key}; keep one of them`);
  const m = read(`${place}.${key}`, askTable(`${place}.${key}`, given[key])),
    ratio = m.gear_ratio;
  if (m.current_limit_A !== null && !slips) throw refusedForGround(`${place}.${key}.current_limit_A`);
  return {
    ...(slips && { winding_resistance_ohm: m.resistance_ohm, viscous_friction_Nms: ratio * ratio * m.viscous_friction_Nms }),
    ...(m.current_limit_A !== null && { current_limit_A: m.current_limit_A }),
    gain_Nm_per_V: (ratio * m.torque_constant_Nm_per_A) / m.resistance_ohm,
    damping_Nms:
      ratio * ratio * ((m.torque_constant_Nm_per_A * m.back_emf_Vs_per_rad) / m.resistance_ohm + m.viscous_friction_Nms),
    inertia: ratio * ratio * m.rotor_inertia_kgm2,
  };
}

/** @param {Body} body @param {Record<string, number>} own @returns {Body} */
function withMotor(body, { inertia, ...motor }) {
  return { ...body, ...motor, yaw_inertia_kgm2: body.yaw_inertia_kgm2 + inertia };
}

function hingeOf(
  /** @type {string} */ place,
  /** @type {Record<string, any>} */ own,
  /** @type {string} */ kind,
  /** @type {string | undefined} */ usual,
) {
  const name = own.name ?? usual,
    low = own.stop_low_rad ?? -Infinity,
    high = own.stop_high_rad ?? Infinity;
  if (!NAME.test(name))
    throw new Refused(
      `${place}.name`,
      `is ${toldOf(name)}; use letters, digits, _ and -, with a letter first, as it is part of the names of signals`,
      "unusable name",
    );
  if (name === CARRIAGE)
    throw new Refused(`${place}.name`, `is "${CARRIAGE}", the name of body 0; give another one`, "name taken");
  if (!(low < high))
    throw new Refused(
      `${place}.stop_high_rad`,
      `is ${high}, which is not above stop_low_rad = ${low}; exchange them`,
      "limits exchanged",
    );
  checkCommand(place, own, kind);
  const angle = own.start_angle_rad;
  if (!(low <= angle && angle <= high))
    throw new Refused(
      `${place}.start_angle_rad`,
      `is ${angle}, beyond the stops (${low} to ${high}); start within them`,
      "beyond a stop",
      angle,
    );
  const rateLimit = own.rate_limit_rad_per_s ?? Infinity,
    refuses = own.at_limit === "refuse" || !(isCommanded(kind) || kind === "servo"),
    rate = own.start_rate_rad_per_s;
  return { name, kind, place, low, high, rateLimit, refuses, angle, rate, follows: "" };
}

function checkCommand(
  /** @type {string} */ place,
  /** @type {Record<string, any>} */ own,
  /** @type {string} */ kind,
) {
  if (isCommanded(kind)) {
    if (own.start_rate_rad_per_s)
      throw noEffect(
        `${place}.start_rate_rad_per_s`,
        `has no effect on a hinge that is "${kind}", whose rate is an input; take it out`,
      );
    return;
  }
  if (kind === "servo") return;
  if ((own.rate_limit_rad_per_s ?? null) !== null)
    throw noEffect(
      `${place}.rate_limit_rad_per_s`,
      `has no effect on a hinge that is "${kind}"; take it out, or make it "prescribed" or "coordinated"`,
    );
  if (own.at_limit === "saturate")
    throw noEffect(
      `${place}.at_limit`,
      `"saturate" needs a command to be limited, and this hinge is "${kind}": a stop would push against it, which ` +
        'the model does not have; give "refuse"',
    );
}

function noBody(/** @type {string} */ path, /** @type {string} */ name, /** @type {string[]} */ names) {
  return new Refused(path, `there is no body ${toldOf(name)}; use ${names.join(", ")}`, "body unknown");
}

function checkNames(/** @type {Part[]} */ parts) {
  /** @type {Map<string, string>} */
  const places = new Map();
  for (const { hinge } of parts) {
    if (places.has(hinge.name))
      throw new Refused(
        `${hinge.place}.name`,
        `is ${toldOf(hinge.name)}, as of ${places.get(hinge.name)}; give each body another name`,
        "name taken",
      );
    places.set(hinge.name, hinge.place);
  }
  return parts;
}

/** The same in an order in which each parent comes before its bodies; else as they are given. */
function parentsFirst(/** @type {Part[]} */ parts) {
  const names = [CARRIAGE, ...parts.map(({ hinge }) => hinge.name)];
  for (const { body, hinge } of parts)
    if (!names.includes(body.parent)) throw noBody(`${hinge.place}.${parentKey(hinge)}`, body.parent, names);
  const placed = new Set([CARRIAGE]),
    left = [...parts],
    /** @type {Part[]} */ found = [];
  while (left.length) {
    const at = left.findIndex(({ body }) => placed.has(body.parent));
    if (at < 0)
      throw new Refused(
        `${left[0].hinge.place}.${parentKey(left[0].hinge)}`,
        `hangs on ${toldOf(left[0].body.parent)}, which in the end hangs on this body; let one of them hang on the ` +
          "carriage",
        "parents in a ring",
      );
    const [ready] = left.splice(at, 1);
    found.push(ready);
    placed.add(ready.hinge.name);
  }
  return found;
}

/** The keys of the short forms for those of a body. @type {Record<string, Record<string, string>>} */
const KEYS_OF_FORMS = {
  wheel: {
    hinge_x_m: "x_m",
    hinge_y_m: "y_m",
    damping_Nms: "steering_damping_Nms",
    gain_Nm_per_V: "steering_gain_Nm_per_V",
    parent: "body",
    hinge: "steered",
  },
  caster: { hinge_x_m: "x_m", hinge_y_m: "y_m" },
  trailer: { hinge_x_m: "hitch_x_m", hinge_y_m: "hitch_y_m" },
  body: {},
};
const OF_WHOLE_HINGES = [
  "twist zero",
  "twist jumps",
  "massless hinge",
  "coordinated too few",
  "steered too often",
  "coordinated on body",
  "step beyond trail limit",
]; // not about the number that the core names

/** A refusal of the core by the tables of the scene: the core counts all bodies and all wheels. */
export function inTables(
  /** @type {Refused} */ refused,
  /** @type {Hinge[]} */ hinges,
  /** @type {string[]} */ wheelPlaces,
) {
  let { path } = refused;
  const body = /^vehicle\.body\[(\d+)\](?:\.(\w+))?$/.exec(path),
    wheel = /^vehicle\.wheel\[(\d+)\](.*)$/.exec(path);
  if (body && hinges.length) {
    const hinge = hinges[Math.min(Number(body[1]), hinges.length) - 1],
      form = hinge.place.replace(/^vehicle\.(\w+).*$/, "$1");
    const key = KEYS_OF_FORMS[form][body[2]] ?? body[2];
    path = `${hinge.place}${key && !OF_WHOLE_HINGES.includes(refused.status) ? `.${key}` : ""} (${hinge.name})`;
  } else if (wheel && wheelPlaces[Number(wheel[1]) - 1]) path = wheelPlaces[Number(wheel[1]) - 1] + wheel[2];
  else if (path === "twist" || path === "twist_rate") path = "steering_twist";
  const told = refused.explanation.replace(", or give ground.friction_coefficient, so that wheels slip", "");
  return new Refused(path, told, refused.status, refused.value, refused.limit);
}
