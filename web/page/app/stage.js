// The world from above: paths, robots, grid. World x points up and y to the left, as a robot at its start sees them.
import { colours, drawBody, drawWheel, reach, rimOf, surface } from "./drawing.js";
import { drawCarriage, drawHung } from "./hinged_view.js";
import { fixed } from "./texts.js";

const EASE = 0.12; // of the way that the view goes in a frame
const calm = window.matchMedia("(prefers-reduced-motion: reduce)");

/** The view of a run. */
export class Stage {
  constructor(/** @type {HTMLCanvasElement} */ canvas) {
    this.canvas = canvas;
    this.zoom = 1;
    /** @type {number[] | undefined} */
    this.centre = undefined;
  }

  /** Jumps to the robot. */
  reset() {
    this.centre = undefined;
  }

  draw(/** @type {import("./run.js").Run} */ run, stopped = false) {
    const { pen, width, height } = surface(this.canvas);
    const out = run.main.robot.outputs(),
      colour = colours();
    const scale = (this.zoom * Math.min(width, height)) / (run.layout ? 8 * run.layout.size : 11 * reach(run.scene.vehicle));
    this.moveTo([out.origin_x_m, out.origin_y_m]);
    drawGrid(pen, width, height, scale, this.centre ?? [0, 0], colour);
    pen.save();
    pen.translate(width / 2, height / 2);
    pen.rotate(-Math.PI / 2);
    pen.scale(scale, -scale);
    pen.translate(-(this.centre?.[0] ?? 0), -(this.centre?.[1] ?? 0));
    this.drawRun(pen, run, out, scale, { ...colour, accent: stopped ? colour.soft : colour.accent });
    pen.restore();
    drawScale(pen, width, height, scale, colour);
  }

  moveTo(/** @type {number[]} */ place) {
    const [x, y] = this.centre ?? place;
    const part = this.centre && !calm.matches ? EASE : 1;
    this.centre = [x + part * (place[0] - x), y + part * (place[1] - y)];
  }

  drawRun(
    /** @type {any} */ pen,
    /** @type {any} */ run,
    /** @type {any} */ out,
    /** @type {number} */ scale,
    /** @type {any} */ colour,
  ) {
    const px = 1 / scale;
    for (const actor of run.fleet) drawPath(pen, actor.path, colour.line, px, []);
    for (const actor of run.fleet)
      placed(pen, actor.robot.outputs(), () => {
        const style = { stroke: colour.soft, width: px };
        if (run.layout) drawCarriage(pen, run.layout, style);
        else drawBody(pen, actor.scene.vehicle, style);
      });
    for (const { path } of run.trails?.all ?? []) drawPath(pen, path, colour.soft, 1.5 * px, []);
    if (run.ideal) this.drawIdeal(pen, run, px, colour);
    drawPath(pen, run.main.path, colour.accent, 2 * px, []);
    if (run.layout) drawHung(pen, run.layout, out, px, colour);
    placed(pen, out, () => {
      if (run.layout) drawVelocity(pen, out, run.layout.size, px, colour);
      else this.drawMain(pen, run.scene.vehicle, out, px, colour);
    });
  }

  drawIdeal(/** @type {any} */ pen, /** @type {any} */ { ideal, layout }, /** @type {number} */ px, /** @type {any} */ colour) {
    drawPath(pen, ideal.path, colour.soft, 1.5 * px, [5 * px, 4 * px]);
    const style = { stroke: colour.soft, width: 1.5 * px, dash: [5 * px, 4 * px] };
    placed(pen, ideal.robot.outputs(), () =>
      layout ? drawCarriage(pen, layout, style) : drawBody(pen, ideal.scene.vehicle, style),
    );
  }

  drawMain(
    /** @type {any} */ pen,
    /** @type {any} */ vehicle,
    /** @type {any} */ out,
    /** @type {number} */ px,
    /** @type {any} */ colour,
  ) {
    drawBody(pen, vehicle, { fill: colour.wash, stroke: colour.accent, width: 1.5 * px });
    vehicle.wheel.forEach((/** @type {any} */ wheel, /** @type {number} */ i) => {
      drawWheel(pen, vehicle, wheel, out.wheel_angle_rad[i], rimOf(out, i, px, colour));
    });
    drawVelocity(pen, out, reach(vehicle), px, colour);
  }
}

/** Draws in the robot's own frame. */
function placed(/** @type {any} */ pen, /** @type {any} */ out, /** @type {() => void} */ draw) {
  pen.save();
  pen.translate(out.origin_x_m, out.origin_y_m);
  pen.rotate(out.heading_rad);
  draw();
  pen.restore();
}

function drawPath(
  /** @type {any} */ pen,
  /** @type {number[]} */ path,
  /** @type {string} */ colour,
  /** @type {number} */ width,
  /** @type {number[]} */ dash,
) {
  pen.beginPath();
  for (let i = 0; i < path.length; i += 2) pen.lineTo(path[i], path[i + 1]);
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.lineJoin = "round";
  pen.setLineDash(dash);
  pen.stroke();
  pen.setLineDash([]);
}

/** The way that the robot goes in half a second. */
function drawVelocity(
  /** @type {any} */ pen,
  /** @type {any} */ out,
  /** @type {number} */ size,
  /** @type {number} */ px,
  /** @type {any} */ colour,
) {
  const [x, y] = out.velocity_body_m_per_s.map((/** @type {number} */ v) => 0.5 * v),
    far = Math.hypot(x, y);
  if (!(far > size * 0.1)) return;
  const [ux, uy] = [x / far, y / far],
    tip = 7 * px;
  pen.strokeStyle = colour.accent;
  pen.lineWidth = 2 * px;
  pen.beginPath();
  pen.moveTo(0, 0);
  pen.lineTo(x, y);
  pen.moveTo(x - tip * (ux - 0.6 * uy), y - tip * (uy + 0.6 * ux));
  pen.lineTo(x, y);
  pen.lineTo(x - tip * (ux + 0.6 * uy), y - tip * (uy - 0.6 * ux));
  pen.stroke();
}

/** The grid's spacing: 1, 2 or 5 times a power of ten, 40 to 100 pixels. */
function spacing(/** @type {number} */ scale) {
  const least = 44 / scale,
    unit = 10 ** Math.floor(Math.log10(least));
  return unit * ([1, 2, 5, 10].find((times) => times * unit >= least) ?? 10);
}

function drawGrid(
  /** @type {any} */ pen,
  /** @type {number} */ width,
  /** @type {number} */ height,
  /** @type {number} */ scale,
  /** @type {number[]} */ centre,
  /** @type {any} */ colour,
) {
  const step = spacing(scale),
    px = step * scale;
  const along = (/** @type {number} */ size, /** @type {number} */ at) => (((size / 2 + at * scale) % px) + px) % px;
  pen.beginPath();
  for (let x = along(width, centre[1]); x < width; x += px) pen.rect(Math.round(x), 0, 0, height);
  for (let y = along(height, centre[0]); y < height; y += px) pen.rect(0, Math.round(y), width, 0);
  pen.strokeStyle = colour.grid;
  pen.lineWidth = 1;
  pen.stroke();
}

function drawScale(
  /** @type {any} */ pen,
  /** @type {number} */ width,
  /** @type {number} */ height,
  /** @type {number} */ scale,
  /** @type {any} */ colour,
) {
  const step = spacing(scale),
    px = step * scale,
    right = width - 16,
    y = height - 16;
  pen.strokeStyle = pen.fillStyle = colour.soft;
  pen.lineWidth = 1.5;
  pen.beginPath();
  pen.moveTo(right - px, y - 4);
  pen.lineTo(right - px, y);
  pen.lineTo(right, y);
  pen.lineTo(right, y - 4);
  pen.stroke();
  pen.font = "12px system-ui, sans-serif";
  pen.textAlign = "right";
  pen.fillText(step < 1 ? `${fixed(step * 100, 0)} cm` : `${fixed(step, 0)} m`, right, y - 8);
}
