// Wheels drawn on a canvas: place, turn, kind, add, delete; with the pointer, with keys, and as numbers.
import { colours, drawBody, drawWheel, radiusOf, reach, surface } from "./drawing.js";
import { byId, fixed, inDegrees, inRadians, say } from "./texts.js";
import { numberTyped } from "./typed.js";
import { NUMBERS, clean, showWheel, tellOfWheels } from "./wheel_form.js";
import { addToWheels, freePlace, takeFromWheels } from "./wheels.js";

const PLACE_SNAP_M = 0.005;
const TURN_SNAP = Math.PI / 36;
const KEY_M = 0.01,
  FINE_M = 0.001;
const HANDLE_PX = 16;
const USUAL_ROLLER = { omni: Math.PI / 2, mecanum: Math.PI / 4 };
/** The canvas on which wheels are drawn, and the numbers of the wheel that is chosen. */
export class Editor {
  constructor(/** @type {() => void} */ changed, /** @type {number} */ mostWheels) {
    this.changed = changed;
    this.mostWheels = mostWheels;
    this.canvas = byId("drawing");
    this.chosen = 0;
    /** @type {string} */
    this.drag = "";
    this.listen();
  }

  listen() {
    this.canvas.addEventListener("pointerdown", (/** @type {PointerEvent} */ event) => this.down(event));
    this.canvas.addEventListener("pointermove", (/** @type {PointerEvent} */ event) => this.move(event));
    for (const name of ["pointerup", "pointercancel"]) this.canvas.addEventListener(name, () => this.up());
    this.canvas.addEventListener("dblclick", (/** @type {MouseEvent} */ event) => this.add(this.placeOf(event)));
    this.canvas.addEventListener("keydown", (/** @type {KeyboardEvent} */ event) => this.key(event));
    byId("add-wheel").addEventListener("click", () => this.add([0, 0]));
    byId("delete-wheel").addEventListener("click", () => this.remove());
    byId("wheel-kind").addEventListener("change", (/** @type {any} */ event) => this.setKind(event.target.value));
    for (const [key, , unit] of NUMBERS)
      byId(`wheel-${key}`).addEventListener("change", (/** @type {any} */ event) =>
        this.setNumber(key, unit, event.target.value),
      );
  }

  get wheels() {
    return this.scene.vehicle.wheel;
  }

  get wheel() {
    return this.wheels[this.chosen];
  }

  fit(/** @type {any} */ scene) {
    this.scene = scene;
    this.chosen = Math.max(0, Math.min(this.chosen, scene.vehicle.wheel.length - 1));
    showWheel(this);
  }

  /** Pixels a metre; the same while something is dragged. */
  get scale() {
    if (!this.drag || !this.held)
      this.held =
        Math.min(this.canvas.clientWidth, this.canvas.clientHeight) / (2.5 * Math.max(0.12, reach(this.scene.vehicle)));
    return this.held;
  }

  draw() {
    const { pen, width, height } = surface(this.canvas),
      colour = colours(),
      scale = this.scale,
      px = 1 / scale;
    pen.translate(width / 2, height / 2);
    pen.rotate(-Math.PI / 2);
    pen.scale(scale, -scale);
    this.drawAxes(pen, px, Math.max(width, height) / scale, colour);
    drawBody(pen, this.scene.vehicle, { fill: colour.wash, stroke: colour.soft, width: px });
    this.wheels.forEach((/** @type {any} */ wheel, /** @type {number} */ i) =>
      drawWheel(pen, this.scene.vehicle, wheel, 0, {
        tread: colour.card,
        stroke: i === this.chosen ? colour.accent : colour.ink,
        width: (i === this.chosen ? 2.5 : 1) * px,
      }),
    );
    if (this.wheel) this.drawHandle(pen, px, colour);
    this.drawNumbers(pen, px, colour);
  }

  drawAxes(/** @type {any} */ pen, /** @type {number} */ px, /** @type {number} */ far, /** @type {any} */ colour) {
    let step = this.scale > 600 ? 0.05 : this.scale > 120 ? 0.1 : 0.5;
    while (far > 500 * step) step *= 10; // a wheel far away would ask for millions of lines
    pen.strokeStyle = colour.grid;
    pen.lineWidth = px;
    pen.beginPath();
    for (let at = -Math.ceil(far / step) * step; at < far; at += step) {
      (pen.moveTo(at, -far), pen.lineTo(at, far));
      (pen.moveTo(-far, at), pen.lineTo(far, at));
    }
    pen.stroke();
    pen.strokeStyle = colour.line;
    pen.beginPath();
    (pen.moveTo(-far, 0), pen.lineTo(far, 0), pen.moveTo(0, -far), pen.lineTo(0, far));
    pen.stroke();
    const { com_x_m: x = 0, com_y_m: y = 0 } = this.scene.vehicle;
    pen.beginPath();
    pen.arc(x, y, 4 * px, 0, 2 * Math.PI);
    pen.fillStyle = colour.ink;
    pen.fill();
  }

  /** Where the chosen wheel is turned: beyond it, along its axle. */
  handle() {
    const far = radiusOf(this.scene.vehicle, this.wheel) + 34 / this.scale,
      { x_m, y_m, axle_rad } = this.wheel;
    return [x_m + far * Math.cos(axle_rad), y_m + far * Math.sin(axle_rad)];
  }

  drawHandle(/** @type {any} */ pen, /** @type {number} */ px, /** @type {any} */ colour) {
    const [x, y] = this.handle();
    pen.strokeStyle = pen.fillStyle = colour.accent;
    pen.lineWidth = 1.5 * px;
    pen.beginPath();
    pen.moveTo(this.wheel.x_m, this.wheel.y_m);
    pen.lineTo(x, y);
    pen.stroke();
    pen.beginPath();
    pen.arc(x, y, 6 * px, 0, 2 * Math.PI);
    pen.fill();
  }

  drawNumbers(/** @type {any} */ pen, /** @type {number} */ px, /** @type {any} */ colour) {
    this.wheels.forEach((/** @type {any} */ wheel, /** @type {number} */ i) => {
      const out = radiusOf(this.scene.vehicle, wheel) + 12 * px,
        far = Math.hypot(wheel.x_m, wheel.y_m) || 1;
      pen.save();
      pen.translate(wheel.x_m * (1 + out / far), wheel.y_m * (1 + out / far));
      pen.scale(px, -px);
      pen.rotate(Math.PI / 2);
      pen.font = "600 13px system-ui, sans-serif";
      pen.textAlign = "center";
      pen.textBaseline = "middle";
      pen.fillStyle = i === this.chosen ? colour.accent : colour.soft;
      pen.fillText(String(i + 1), 0, 0);
      pen.restore();
    });
  }

  /** A place of the pointer in the body's frame. */
  placeOf(/** @type {MouseEvent} */ event) {
    const box = this.canvas.getBoundingClientRect();
    return [
      (box.top + box.height / 2 - event.clientY) / this.scale,
      (box.left + box.width / 2 - event.clientX) / this.scale,
    ];
  }

  down(/** @type {PointerEvent} */ event) {
    const [x, y] = this.placeOf(event),
      near = HANDLE_PX / this.scale;
    this.canvas.setPointerCapture(event.pointerId);
    if (this.wheel && Math.hypot(...minus(this.handle(), [x, y])) < near) {
      this.drag = "turn";
      return;
    }
    const distances = this.wheels.map(
      (/** @type {any} */ w) => Math.hypot(w.x_m - x, w.y_m - y) - radiusOf(this.scene.vehicle, w),
    );
    const nearest = distances.indexOf(Math.min(...distances));
    if (nearest >= 0 && distances[nearest] < near / 2) {
      this.choose(nearest);
      this.drag = "place";
      this.grab = minus([this.wheel.x_m, this.wheel.y_m], [x, y]);
    }
  }

  move(/** @type {PointerEvent} */ event) {
    if (!this.drag) return;
    const [x, y] = this.placeOf(event);
    if (this.drag === "turn")
      this.wheel.axle_rad = wrapped(snap(Math.atan2(y - this.wheel.y_m, x - this.wheel.x_m), TURN_SNAP));
    else this.place(snap(x + (this.grab?.[0] ?? 0), PLACE_SNAP_M), snap(y + (this.grab?.[1] ?? 0), PLACE_SNAP_M));
    this.moved = true;
    showWheel(this);
  }

  up() {
    if (this.moved) this.finish();
    this.drag = "";
    this.moved = false;
  }

  place(/** @type {number} */ x_m, /** @type {number} */ y_m) {
    Object.assign(this.wheel, { x_m: clean(x_m), y_m: clean(y_m) });
  }

  key(/** @type {KeyboardEvent} */ event) {
    const step = event.shiftKey ? FINE_M : KEY_M,
      { x_m = 0, y_m = 0 } = this.wheel ?? {};
    const turn = (/** @type {number} */ by) => (this.wheel.axle_rad = wrapped(this.wheel.axle_rad + by));
    /** @type {Record<string, () => void>} */
    const ofWheel = {
      ArrowUp: () => this.place(x_m + step, y_m),
      ArrowDown: () => this.place(x_m - step, y_m),
      ArrowLeft: () => this.place(x_m, y_m + step),
      ArrowRight: () => this.place(x_m, y_m - step),
      ",": () => turn(TURN_SNAP),
      ".": () => turn(-TURN_SNAP),
    };
    if (ofWheel[event.key] && this.wheel) ofWheel[event.key]();
    else if (event.key === "PageDown" || event.key === "PageUp") return this.step(event);
    else if (event.key === "Delete" && this.wheel) return this.remove();
    else if (event.key === "Insert") return this.add([0, 0]);
    else return;
    event.preventDefault();
    this.finish();
  }

  step(/** @type {KeyboardEvent} */ event) {
    event.preventDefault();
    const count = this.wheels.length,
      by = event.key === "PageDown" ? 1 : -1;
    if (count) this.choose((this.chosen + by + count) % count);
  }

  choose(/** @type {number} */ i) {
    this.chosen = i;
    showWheel(this);
    say(this.inWords());
  }

  inWords() {
    const { kind, x_m, y_m, axle_rad } = this.wheel;
    const place = `${fixed(x_m, 3)} m ahead, ${fixed(y_m, 3)} m to the left`;
    return `Wheel ${this.chosen + 1}, ${kind}, ${place}, axle at ${fixed(inDegrees(axle_rad), 0)} degrees`;
  }

  add(/** @type {number[]} */ wanted) {
    const { kind = "omni", axle_rad = -Math.PI / 2, roller_rad } = this.wheel ?? {};
    if (this.wheels.length >= this.mostWheels)
      return tellOfWheels(`A robot has ${this.mostWheels} wheels at most; delete one first, or move one.`);
    const [x, y] = freePlace(this.wheels, wanted);
    addToWheels(this.scene, {
      kind,
      x_m: snap(x, PLACE_SNAP_M),
      y_m: snap(y, PLACE_SNAP_M),
      axle_rad,
      ...(kind !== "fixed" && { roller_rad: roller_rad ?? Math.PI / 2 }),
    });
    this.chosen = this.wheels.length - 1;
    this.finish();
  }

  remove() {
    if (!this.wheel) return;
    takeFromWheels(this.scene, this.chosen);
    this.chosen = Math.max(0, Math.min(this.chosen, this.wheels.length - 1));
    this.finish();
  }

  setKind(/** @type {string} */ kind) {
    this.wheel.kind = kind;
    if (kind === "fixed") {
      delete this.wheel.roller_rad;
      delete this.wheel.roller_drag;
    } else this.wheel.roller_rad = USUAL_ROLLER[/** @type {"omni" | "mecanum"} */ (kind)];
    this.finish();
  }

  setNumber(/** @type {string} */ key, /** @type {string} */ unit, /** @type {string} */ text) {
    const value = numberTyped(`vehicle.wheel[${this.chosen + 1}].${key}`, text);
    this.wheel[key] = unit === "°" ? inRadians(value) : value;
    this.finish();
  }

  finish() {
    this.changed();
    showWheel(this);
    say(this.wheel ? this.inWords() : "no wheels");
  }
}

function minus(/** @type {number[]} */ a, /** @type {number[]} */ b) {
  return [a[0] - b[0], a[1] - b[1]];
}

function snap(/** @type {number} */ value, /** @type {number} */ unit) {
  return Number((Math.round(value / unit) * unit).toPrecision(12));
}

function wrapped(/** @type {number} */ angle) {
  return Math.atan2(Math.sin(angle), Math.cos(angle));
}
