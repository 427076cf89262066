// A scene as TOML that `laconic simulate` reads: the robot, its start, and what was driven.
import { inputsOf } from "./drive.js";

const SUBTABLES = ["motor", "drive", "payload"];
const LISTS = ["wheel", "support", "body", "caster", "trailer"];

/**
 * @param {any} scene @param {{method: string, step_s: number}} how
 * @param {{changes: any[], time_s: number} | undefined} drive
 */
export function sceneToml(scene, how, drive) {
  const vehicle = Object.fromEntries(Object.entries(scene.vehicle).filter(([key]) => !LISTS.includes(key)));
  const inputs = drive ? inputsOf(drive.changes) : (scene.input ?? []);
  const duration_s = drive ? drive.time_s : scene.run.duration_s;
  return [
    "# Made by the page of Laconic. Run it: laconic simulate FILE.toml --plot path.png\n",
    pairs({ name: scene.name, source: scene.source }),
    table("vehicle", without(vehicle, SUBTABLES)),
    ...SUBTABLES.filter((name) => vehicle[name]).map((name) => table(`vehicle.${name}`, vehicle[name])),
    ...LISTS.flatMap((name) =>
      (scene.vehicle[name] ?? []).map((/** @type {any} */ each) => table(`[vehicle.${name}]`, each)),
    ),
    ...["ground", "initial"].filter((name) => scene[name]).map((name) => table(name, scene[name])),
    ...inputs.map((/** @type {any} */ each) => table("[input]", each)),
    table("run", { duration_s, step_s: how.step_s, method: how.method }),
  ].join("");
}

function without(/** @type {any} */ given, /** @type {string[]} */ keys) {
  return Object.fromEntries(Object.entries(given).filter(([key]) => !keys.includes(key)));
}

function table(/** @type {string} */ name, /** @type {any} */ given) {
  return `\n[${name}]\n${pairs(given)}`;
}

function pairs(/** @type {any} */ given) {
  return Object.entries(given)
    .map(([key, value]) => `${key} = ${valueText(value)}\n`)
    .join("");
}

/** @param {any} value @returns {string} */
function valueText(value) {
  if (Array.isArray(value)) return `[${value.map(valueText).join(", ")}]`;
  if (typeof value === "object")
    return `{ ${Object.entries(value)
      .map(([key, each]) => `${key} = ${valueText(each)}`)
      .join(", ")} }`;
  if (typeof value === "string") return JSON.stringify(value).replace(/\u007f/g, "\\u007f");
  if (typeof value === "number" && Number.isInteger(value) && Math.abs(value) < 1e15) return value.toFixed(1);
  return String(value);
}
