// What both canvases share: their colours, their pixels, and how a robot looks from above.

/** Colours of the style sheet, by their names there. */
export function colours() {
  const style = getComputedStyle(document.documentElement);
  const named = (/** @type {string} */ name) => style.getPropertyValue(`--${name}`).trim();
  return {
    ink: named("ink"),
    soft: named("soft"),
    line: named("line"),
    card: named("card"),
    accent: named("accent"),
    wash: named("wash"),
    warn: named("warn"),
    grid: named("grid"),
  };
}

/** The context of a canvas, as many pixels as the screen has; sizes are CSS pixels. */
export function surface(/** @type {HTMLCanvasElement} */ canvas) {
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth,
    height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  return { pen, width, height };
}

/** Points around the wheels, outermost alone, in order. */
export function hull(/** @type {number[][]} */ points) {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (/** @type {number[][]} */ list) => {
    const kept = /** @type {number[][]} */ ([]);
    for (const p of list) {
      while (kept.length > 1 && turn(kept.at(-2), kept.at(-1), p) <= 0) kept.pop();
      kept.push(p);
    }
    return kept.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())];
}

function turn(/** @type {any} */ a, /** @type {any} */ b, /** @type {any} */ c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

export function radiusOf(/** @type {any} */ vehicle, /** @type {any} */ wheel) {
  const radius = wheel.radius_m ?? vehicle.wheel_radius_m;
  return radius > 0 && Number.isFinite(radius) ? radius : 0.03;
}

/** How far the robot reaches from its origin. */
export function reach(/** @type {any} */ vehicle) {
  const places = [...vehicle.wheel, ...(vehicle.support ?? [])];
  const far = places.map((/** @type {any} */ p) => Math.hypot(p.x_m, p.y_m) + radiusOf(vehicle, p));
  return Math.max(0.08, ...far.filter(Number.isFinite));
}

/** Corners of the body: around every wheel and support. */
function corners(/** @type {any} */ vehicle) {
  const places = [...vehicle.wheel, ...(vehicle.support ?? [])];
  if (places.length === 0) return ring(0, 0, 0.1);
  const around = places.flatMap((/** @type {any} */ p) => ring(p.x_m, p.y_m, radiusOf(vehicle, p) * 0.9));
  return hull(places.length < 3 ? [...around, ...ring(0, 0, reach(vehicle) * 0.8)] : around);
}

export function ring(/** @type {number} */ x, /** @type {number} */ y, /** @type {number} */ r) {
  return Array.from({ length: 12 }, (_, k) => [
    x + r * Math.cos((k * Math.PI) / 6),
    y + r * Math.sin((k * Math.PI) / 6),
  ]);
}

/** The body in its own frame, one unit a metre. */
export function drawBody(
  /** @type {CanvasRenderingContext2D} */ pen,
  /** @type {any} */ vehicle,
  /** @type {any} */ style,
) {
  drawOutline(pen, corners(vehicle), style);
  drawNose(pen, reach(vehicle), style);
}

/** What encloses a body. @param {any} pen @param {number[][]} points @param {any} style */
export function drawOutline(pen, points, style) {
  pen.beginPath();
  for (const [x, y] of points) pen.lineTo(x, y);
  pen.closePath();
  pen.lineJoin = "round";
  if (style.fill) {
    pen.fillStyle = style.fill;
    pen.fill();
  }
  pen.strokeStyle = style.stroke;
  pen.lineWidth = style.width;
  pen.setLineDash(style.dash ?? []);
  pen.stroke();
  pen.setLineDash([]);
}

export function drawNose(/** @type {CanvasRenderingContext2D} */ pen, /** @type {number} */ size, /** @type {any} */ style) {
  pen.beginPath();
  pen.moveTo(size * 0.22, size * 0.14);
  pen.lineTo(size * 0.38, 0);
  pen.lineTo(size * 0.22, -size * 0.14);
  pen.stroke();
}

/** How a wheel is drawn: in the colour of warnings where it slips or has lifted. */
export function rimOf(/** @type {any} */ out, /** @type {number} */ i, /** @type {number} */ px, /** @type {any} */ colour) {
  const isLost = out.contact_state?.[i] > 0;
  return { tread: colour.card, stroke: isLost ? colour.warn : colour.ink, width: isLost ? 2 * px : px };
}

/** One wheel from above: its tread, and the axes of its rollers where they touch the ground, moved on by its angle. */
export function drawWheel(
  /** @type {CanvasRenderingContext2D} */ pen,
  /** @type {any} */ vehicle,
  /** @type {any} */ wheel,
  /** @type {number} */ angle,
  /** @type {any} */ style,
) {
  const radius = radiusOf(vehicle, wheel),
    half = radius * (wheel.kind === "fixed" ? 0.3 : 0.42);
  pen.save();
  pen.translate(wheel.x_m, wheel.y_m);
  pen.rotate(wheel.axle_rad + Math.PI / 2); // now x is the way the wheel rolls, −y the axle
  pen.fillStyle = style.tread;
  pen.strokeStyle = style.stroke;
  pen.lineWidth = style.width;
  pen.beginPath();
  pen.roundRect(-radius, -half, 2 * radius, 2 * half, half * 0.35);
  pen.fill();
  pen.save();
  pen.clip();
  drawRollers(pen, wheel, radius, half, angle);
  pen.restore();
  pen.beginPath();
  pen.roundRect(-radius, -half, 2 * radius, 2 * half, half * 0.35);
  pen.stroke();
  pen.restore();
}

/** Bars across the tread, square to the way it rolls for fixed wheels, along the rollers' axes for others. */
function drawRollers(
  /** @type {CanvasRenderingContext2D} */ pen,
  /** @type {any} */ wheel,
  /** @type {number} */ radius,
  /** @type {number} */ half,
  /** @type {number} */ angle,
) {
  const count = 6,
    spacing = Math.PI / count;
  const gamma = wheel.kind === "fixed" ? 0 : (wheel.roller_rad ?? Math.PI / 2);
  const dx = Math.sin(gamma),
    dy = -Math.cos(gamma); // the axle is −y here
  pen.beginPath();
  for (let k = 0; k < count; k++) {
    const around = ((((k * spacing - angle) % Math.PI) + Math.PI) % Math.PI) - Math.PI / 2;
    const x = radius * Math.sin(around),
      size = half * (Math.abs(dx) > 0.95 ? 0.3 : 1.1) * Math.max(0.25, Math.cos(around));
    pen.moveTo(x - dx * size, -dy * size);
    pen.lineTo(x + dx * size, dy * size);
  }
  pen.stroke();
}
