// What each method's error costs: every method in many steps against the core's most accurate one in fine steps.
// a little in every frame.
import { inputOf } from "./drive.js";
import { colours, surface } from "./drawing.js";
import { plain } from "./facts.js";
import { referenceOf } from "./run.js";
import { byId, element, length, power, shown } from "./texts.js";

export const STUDY_S = 2;
const STEPS_S = [0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001];
const FINE_S = { ideal: 1e-4, friction: 2e-5 };
const BUDGET_MS = 4; // of a frame
const MEASURE_MS = 1; // that one cost is measured over
const ROUNDS = 4; // of measurements: the least counts, as other work only adds to it
const FLOOR_M = 1e-15; // below it lie roundings

/** @typedef {{method: string, step_s: number, error_m: number, cost_us: number}} Point */

/** One study of one robot and one manoeuvre: the inputs held for two seconds from the start. */
export class Study {
  constructor(/** @type {any} */ laconic, /** @type {any} */ scene, /** @type {Record<string, number>} */ signals) {
    this.laconic = laconic;
    this.scene = scene;
    this.signals = signals;
    /** @type {Point[]} */
    this.points = [];
    this.work = this.go();
    this.isDone = false;
  }

  /** Works for a part of a frame. */
  advance() {
    const end = performance.now() + BUDGET_MS;
    while (!this.isDone && performance.now() < end) this.isDone = Boolean(this.work.next().done);
  }

  *go() {
    const place = yield* this.referencePlace();
    if (!place) return;
    for (const step_s of STEPS_S)
      for (const { name } of this.laconic.methodsOf(this.scene)) {
        const point = this.measure(name, step_s, place);
        if (point) this.points.push(point);
        yield;
      }
    for (let round = 1; round < ROUNDS; round++)
      for (const point of this.points) {
        point.cost_us = Math.min(point.cost_us, this.measure(point.method, point.step_s, place)?.cost_us ?? Infinity);
        yield;
      }
  }

  *referencePlace() {
    const probe = this.laconic.robot(plain(this.scene), { method: "auto", step_s: 0.001 });
    const fine = probe.hasFriction ? FINE_S.friction : FINE_S.ideal;
    this.input = inputOf(this.signals, probe.wheelCount);
    probe.free();
    const found = referenceOf(this.laconic, this.scene, fine);
    if (!found) return undefined;
    this.referenceText = `${found.method}, ${shown(fine * 1000)} ms`;
    found.robot.setInput(this.input);
    const steps = Math.round(STUDY_S / fine),
      chunk = 500;
    try {
      for (let taken = 0; taken < steps; taken += chunk) {
        found.robot.run(Math.min(chunk, steps - taken));
        yield;
      }
      return found.robot.outputs();
    } catch {
      return undefined;
    } finally {
      found.robot.free();
    }
  }

  /** Error at the end of the first run; cost of as many more as take some milliseconds. @returns {Point | undefined} */
  measure(/** @type {string} */ method, /** @type {number} */ step_s, /** @type {any} */ place) {
    let robot;
    try {
      robot = this.laconic.robot(plain(this.scene), { method, step_s });
      robot.setInput(this.input);
      const steps = Math.round(STUDY_S / step_s);
      robot.run(steps);
      const { x_m, y_m } = robot.outputs();
      return { method, step_s, error_m: Math.hypot(x_m - place.x_m, y_m - place.y_m), cost_us: costOf(robot, steps) };
    } catch {
      return undefined; // the core refuses this method with this step
    } finally {
      robot?.free();
    }
  }
}

/** Microseconds for one simulated second. */
function costOf(/** @type {any} */ robot, /** @type {number} */ steps) {
  const start = performance.now();
  let runs = 0,
    now = start;
  for (; now - start < MEASURE_MS; now = performance.now(), runs++) robot.run(steps);
  return ((now - start) * 1000) / (runs * STUDY_S);
}

/** Error over cost, both in powers of ten; the chosen method in the accent's colour. */
export function drawStudy(/** @type {Study} */ study, /** @type {{method: string, step_s: number}} */ how) {
  const { pen, width, height } = surface(byId("accuracy")),
    colour = colours();
  const box = { left: 34, right: width - 8, top: 10, bottom: height - 20 };
  const points = study.points.map((each) => ({ ...each, error_m: Math.max(each.error_m, FLOOR_M) }));
  const axes = {
    x: decades(
      points.map(({ cost_us }) => cost_us),
      1,
      3,
    ),
    y: decades(
      points.map(({ error_m }) => error_m),
      -9,
      -3,
    ),
  };
  const x = (/** @type {number} */ v) => along(v, axes.x, box.left, box.right),
    y = (/** @type {number} */ v) => along(v, axes.y, box.bottom, box.top);
  drawDecades(pen, axes, box, x, y, colour);
  const names = [...new Set(points.map(({ method }) => method))].sort((a) => (a === how.method ? 1 : -1));
  for (const name of names) {
    const ofMethod = points.filter(({ method }) => method === name),
      isChosen = name === how.method;
    drawMethod(
      pen,
      ofMethod.map((p) => ({ x: x(p.cost_us), y: y(p.error_m), isNow: isChosen && p.step_s === how.step_s })),
      isChosen ? colour.accent : colour.soft,
      isChosen,
    );
  }
}

function decades(/** @type {number[]} */ values, /** @type {number} */ low, /** @type {number} */ high) {
  if (values.length === 0) return [low, high];
  const logs = values.map(Math.log10);
  return [Math.floor(Math.min(...logs)), Math.max(Math.ceil(Math.max(...logs)), Math.floor(Math.min(...logs)) + 1)];
}

function along(
  /** @type {number} */ value,
  /** @type {number[]} */ [low, high],
  /** @type {number} */ from,
  /** @type {number} */ to,
) {
  return from + ((Math.log10(value) - low) / (high - low)) * (to - from);
}

function drawDecades(
  /** @type {any} */ pen,
  /** @type {any} */ axes,
  /** @type {any} */ box,
  /** @type {any} */ x,
  /** @type {any} */ y,
  /** @type {any} */ colour,
) {
  pen.font = "11px system-ui, sans-serif";
  pen.strokeStyle = colour.grid;
  pen.fillStyle = colour.soft;
  pen.lineWidth = 1;
  const every = Math.ceil((axes.y[1] - axes.y[0]) / 6);
  for (let e = axes.y[0]; e <= axes.y[1]; e += every) {
    line(pen, box.left, y(10 ** e), box.right, y(10 ** e));
    pen.textAlign = "right";
    pen.fillText(power(e), box.left - 5, y(10 ** e) + 4);
  }
  for (let e = axes.x[0]; e <= axes.x[1]; e++) {
    line(pen, x(10 ** e), box.top, x(10 ** e), box.bottom);
    pen.textAlign = e === axes.x[1] ? "right" : "center";
    pen.fillText(power(e), x(10 ** e), box.bottom + 15);
  }
}

function line(
  /** @type {any} */ pen,
  /** @type {number} */ x1,
  /** @type {number} */ y1,
  /** @type {number} */ x2,
  /** @type {number} */ y2,
) {
  pen.beginPath();
  pen.moveTo(x1, y1);
  pen.lineTo(x2, y2);
  pen.stroke();
}

function drawMethod(
  /** @type {any} */ pen,
  /** @type {any[]} */ points,
  /** @type {string} */ colour,
  /** @type {boolean} */ isChosen,
) {
  pen.strokeStyle = pen.fillStyle = colour;
  pen.globalAlpha = isChosen ? 1 : 0.6;
  pen.lineWidth = isChosen ? 2 : 1;
  pen.beginPath();
  for (const { x, y } of points) pen.lineTo(x, y);
  pen.stroke();
  for (const { x, y, isNow } of points) {
    pen.beginPath();
    pen.arc(x, y, isNow ? 5.5 : isChosen ? 3 : 2, 0, 2 * Math.PI);
    pen.fill();
  }
  pen.globalAlpha = 1;
}

/** The same as a table, for those who read it. */
export function tableOf(/** @type {Study} */ study) {
  const rows = study.points.map(({ method, step_s, error_m, cost_us }) =>
    element(
      "tr",
      {},
      ...[
        method,
        `${shown(step_s * 1000)} ms`,
        error_m < FLOOR_M ? "rounding" : length(error_m),
        `${shown(cost_us, 2)} µs`,
      ].map((text) => element("td", {}, text)),
    ),
  );
  byId("accuracy-rows").replaceChildren(...rows);
  byId("accuracy-note").textContent = study.isDone
    ? `Error of the place after ${STUDY_S} s against ${study.referenceText ?? "no reference"}.`
    : "Measuring …";
}
