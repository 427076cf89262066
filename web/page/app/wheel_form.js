// The numbers of the wheel that is chosen in the editor, and a button for each wheel.
import { byId, element, inDegrees, say } from "./texts.js";

const DRAWN_KINDS = ["omni", "mecanum", "fixed"];
export const NUMBERS = /** @type {[string, string, string][]} */ ([
  ["x_m", "Ahead", "m"],
  ["y_m", "To the left", "m"],
  ["axle_rad", "Axle", "°"],
  ["roller_rad", "Roller to axle", "°"],
]);

/** Fills the form. @param {any} editor */
export function showWheel(editor) {
  const { wheel } = editor;
  showList(editor);
  byId("wheel-numbers").disabled = !wheel;
  byId("delete-wheel").disabled = !wheel;
  if (!wheel) return;
  byId("wheel-kind").value = DRAWN_KINDS.includes(wheel.kind) ? wheel.kind : "mecanum";
  for (const [key, , unit] of NUMBERS) {
    const input = byId(`wheel-${key}`),
      value = wheel[key] ?? 0;
    if (document.activeElement !== input || !input.matches(":invalid"))
      input.value = Number.isFinite(value) ? String(unit === "°" ? inDegrees(value) : clean(value)) : "";
  }
  byId("wheel-roller_rad").disabled = wheel.kind === "fixed";
}

function showList(/** @type {any} */ editor) {
  const list = byId("wheel-list");
  while (list.children.length > editor.wheels.length) list.lastChild.remove();
  while (list.children.length < editor.wheels.length) {
    const i = list.children.length;
    const made = element("button", { type: "button" }, String(i + 1));
    made.addEventListener("click", () => editor.choose(i));
    list.append(made);
  }
  [...list.children].forEach((/** @type {any} */ button, i) => {
    button.setAttribute("aria-pressed", String(i === editor.chosen));
    button.setAttribute("aria-label", `Wheel ${i + 1}, ${editor.wheels[i].kind}`);
  });
}

/** Tells below the wheel's numbers, and those who listen, why something was not done. */
export function tellOfWheels(/** @type {string} */ text) {
  byId("wheel-error").textContent = text;
  say(text);
}

/** Shows a refusal of a wheel's number. */
export function refuseWheel(/** @type {any} */ refused) {
  const isOfWheels = Boolean(refused?.path.startsWith("vehicle.wheel")) && !refused.path.startsWith("vehicle.wheel_");
  byId("wheel-error").textContent = isOfWheels ? refused.message : "";
}

/** Without the digits that adding decimals leaves behind. */
export function clean(/** @type {number} */ value) {
  return Number(value.toPrecision(15));
}
