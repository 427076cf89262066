// How a robot with hinges looks from above, and what the panel tells of its hinges.
import { drawNose, drawOutline, drawWheel, hull, rimOf, ring } from "./drawing.js";
import { DRAWBAR, middle } from "./hinged.js";
import { byId, element, fixed, shown } from "./texts.js";

const DEGREES_PER_RAD = 180 / Math.PI;
const HALF_TURN = Math.PI;

/** @typedef {import("./hinged.js").Part} Part */

/** The carriage in its own frame, one unit a metre. */
export function drawCarriage(/** @type {any} */ pen, /** @type {any} */ layout, /** @type {any} */ style) {
  drawOutline(pen, outline(layout.parts[0].corners), style);
  const front = Math.max(...layout.parts[0].corners.map((/** @type {number[]} */ [x, , r]) => x + 0.3 * r));
  pen.save();
  pen.translate(front - 0.5 * layout.size, 0);
  drawNose(pen, layout.size, style);
  pen.restore();
}

function outline(/** @type {number[][]} */ corners) {
  return hull(corners.flatMap(([x, y, r]) => ring(x, y, Math.max(r, 1e-3))));
}

/** All bodies in the world: outlines below, wheels and hinges above them. */
export function drawHung(
  /** @type {any} */ pen,
  /** @type {any} */ layout,
  /** @type {any} */ out,
  /** @type {number} */ px,
  /** @type {any} */ colour,
) {
  const style = { fill: colour.wash, stroke: colour.accent, width: 1.5 * px };
  for (const part of layout.parts)
    inFrame(pen, part, out, () => {
      if (part.parent < 0) drawCarriage(pen, layout, style);
      else if (part.form === "trailer" || part.form === "body") drawTowed(pen, part, style);
    });
  for (const part of layout.parts)
    inFrame(pen, part, out, () => drawRolling(pen, part, layout.vehicle, out, px, colour));
}

/** Draws in a body's own frame. */
function inFrame(
  /** @type {any} */ pen,
  /** @type {Part} */ { name, parent },
  /** @type {any} */ out,
  /** @type {() => void} */ draw,
) {
  pen.save();
  if (parent < 0) pen.translate(out.origin_x_m, out.origin_y_m);
  else pen.translate(out.body_x_m[name], out.body_y_m[name]);
  pen.rotate(parent < 0 ? out.heading_rad : out.body_heading_rad[name]);
  draw();
  pen.restore();
}

/** A frame; a trailer has a drawbar. */
function drawTowed(/** @type {any} */ pen, /** @type {Part} */ part, /** @type {any} */ style) {
  drawOutline(pen, outline(part.corners), style);
  if (part.form !== "trailer") return;
  pen.beginPath();
  pen.moveTo(0, 0);
  pen.lineTo(DRAWBAR * middle(part.wheels)[0], 0);
  pen.stroke();
}

/** Wheels of a body, the fork of a caster, and the hinge as a dot. */
function drawRolling(
  /** @type {any} */ pen,
  /** @type {Part} */ part,
  /** @type {any} */ vehicle,
  /** @type {any} */ out,
  /** @type {number} */ px,
  /** @type {any} */ colour,
) {
  pen.strokeStyle = pen.fillStyle = colour.ink;
  pen.lineWidth = 1.5 * px;
  if (part.form === "caster")
    for (const { x_m, y_m } of part.wheels) {
      pen.beginPath();
      pen.moveTo(0, 0);
      pen.lineTo(x_m, y_m);
      pen.stroke();
    }
  for (const wheel of part.wheels) {
    const { number } = wheel;
    drawWheel(pen, vehicle, wheel, out.wheel_angle_rad[number], rimOf(out, number, px, colour));
  }
  if (part.parent < 0) return;
  pen.beginPath();
  pen.arc(0, 0, 2.5 * px, 0, 2 * Math.PI);
  pen.fillStyle = colour.ink;
  pen.fill();
}

/** Energy, each hinge between its stops, and what held commands back or folded. */
export function showHinges(/** @type {any} */ run, /** @type {any} */ out) {
  const { robot } = run.main,
    limited = robot.limited;
  byId("energy").textContent = `${shown(out.energy_J)} J`;
  const told = [
    ...[...run.trails.folded].map(([name, time_s]) => `${name} folds beyond 90° since ${fixed(time_s)} s`),
    ...limited.map(
      (/** @type {any} */ { hinge, limit, first_s, steps }) =>
        `${hinge}: limit of its ${limit} for ${fixed(steps * run.step_s)} s, first at ${fixed(first_s)} s`,
    ),
  ];
  byId("hinges-note").textContent = told.length ? `; ${told.join("; ")}` : "";
  byId("hinges-note").classList.toggle("warn", run.trails.folded.size > 0);
  const list = byId("hinges"),
    hung = run.layout.parts.slice(1);
  while (list.children.length > hung.length) list.lastChild.remove();
  while (list.children.length < hung.length) list.append(hingeRow());
  hung.forEach((/** @type {Part} */ part, /** @type {number} */ k) => {
    showHinge(list.children[k], part, out);
    const isFolded = run.trails.folded.has(part.name);
    list.children[k].classList.toggle("limited", isFolded || isHeldBack(run, part.name, limited));
  });
}

function hingeRow() {
  const bar = element("span", { className: "bar" }, element("span"));
  return element("li", {}, element("span", { className: "name" }), bar, element("span", { className: "value" }));
}

/** A mark for the angle, left at the left, from stop to stop or over a whole turn. */
function showHinge(/** @type {any} */ row, /** @type {Part} */ { name, hinge }, /** @type {any} */ out) {
  const angle = out.hinge_angle_rad[name],
    wrapped_rad = Math.atan2(Math.sin(angle), Math.cos(angle)),
    hasStops = Number.isFinite(hinge.low) && Number.isFinite(hinge.high);
  const [low, high, at] = hasStops ? [hinge.low, hinge.high, angle] : [-HALF_TURN, HALF_TURN, wrapped_rad];
  row.children[0].textContent = row.children[0].title = name;
  const share = Math.min(1, Math.max(0, (high - at) / (high - low)));
  row.children[1].firstChild.style.left = `${(100 * share).toFixed(1)}%`;
  const rate = out.hinge_rate_rad_per_s[name] * DEGREES_PER_RAD;
  row.children[2].textContent = `${fixed(at * DEGREES_PER_RAD, 1)}°, ${fixed(rate, 0)}°/s`;
}

/** Whether a limit of this hinge counted a step since the last look. */
function isHeldBack(/** @type {any} */ run, /** @type {string} */ name, /** @type {any[]} */ limited) {
  const steps = limited.filter(({ hinge }) => hinge === name).reduce((sum, each) => sum + each.steps, 0);
  run.heldBack ??= new Map();
  const [before = 0, at = -1, was = false] = run.heldBack.get(name) ?? [];
  if (run.steps === at) return was;
  run.heldBack.set(name, [steps, run.steps, steps > before]);
  return steps > before;
}
