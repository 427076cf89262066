// The robot's motion over the last seconds, and how much of its grip each wheel uses.
import { colours, surface } from "./drawing.js";
import { byId, element, fixed, shown } from "./texts.js";

const SPAN_S = 10;
const LINES = [
  { name: "forward", of: (/** @type {any} */ out) => out.velocity_body_m_per_s[0], dash: [], ink: "accent" },
  { name: "left", of: (/** @type {any} */ out) => out.velocity_body_m_per_s[1], dash: [], ink: "ink" },
  { name: "turn", of: (/** @type {any} */ out) => out.yaw_rate_rad_per_s, dash: [4, 3], ink: "ink" },
];

/** Velocities as lines; m/s and rad/s share the axis. */
export function drawVelocities(/** @type {any[]} */ history) {
  const { pen, width, height } = surface(byId("velocities"));
  const colour = /** @type {Record<string, string>} */ (colours()),
    end = history.at(-1).t_s;
  const values = history.flatMap(({ out }) => LINES.map((line) => Math.abs(line.of(out)))).filter(Number.isFinite);
  const most = niceTop(Math.max(0.05, ...values)),
    middle = height / 2;
  const x = (/** @type {number} */ t) => width - ((end - t) / SPAN_S) * width;
  const y = (/** @type {number} */ v) => middle - (v / most) * (middle - 8);
  rule(pen, 0, middle, width, colour.line);
  for (const { of, dash, ink } of LINES) {
    pen.beginPath();
    for (const { t_s, out } of history) pen.lineTo(x(t_s), y(of(out)));
    pen.strokeStyle = colour[ink];
    pen.lineWidth = ink === "accent" ? 2 : 1.5;
    pen.setLineDash(dash);
    pen.stroke();
  }
  pen.setLineDash([]);
  label(pen, `${shown(most)}`, 0, 10, colour.soft);
  label(pen, `−${shown(most)}`, 0, height - 2, colour.soft);
}

function niceTop(/** @type {number} */ value) {
  const unit = 10 ** Math.floor(Math.log10(value));
  return unit * ([1, 2, 5, 10].find((times) => times * unit >= value) ?? 10);
}

function rule(
  /** @type {any} */ pen,
  /** @type {number} */ x,
  /** @type {number} */ y,
  /** @type {number} */ width,
  /** @type {string} */ colour,
) {
  pen.strokeStyle = colour;
  pen.lineWidth = 1;
  pen.beginPath();
  pen.moveTo(x, y);
  pen.lineTo(x + width, y);
  pen.stroke();
}

function label(
  /** @type {any} */ pen,
  /** @type {string} */ text,
  /** @type {number} */ x,
  /** @type {number} */ y,
  /** @type {string} */ colour,
) {
  pen.font = "11px system-ui, sans-serif";
  pen.textAlign = "left";
  pen.fillStyle = colour;
  pen.fillText(text, x, y);
}

/** The numbers beside the lines. */
export function showNumbers(/** @type {any} */ out) {
  byId("now-forward").textContent = fixed(out.velocity_body_m_per_s[0]);
  byId("now-left").textContent = fixed(out.velocity_body_m_per_s[1]);
  byId("now-turn").textContent = fixed(out.yaw_rate_rad_per_s);
  byId("now-x").textContent = fixed(out.origin_x_m);
  byId("now-y").textContent = fixed(out.origin_y_m);
  byId("now-heading").textContent = fixed((out.heading_wrapped_rad * 180) / Math.PI, 0);
}

/** Friction coefficient under a wheel; 0 where none is given. */
function frictionOf(/** @type {any} */ scene, /** @type {any} */ wheel) {
  return wheel.friction_coefficient ?? scene.ground?.friction_coefficient ?? scene.vehicle.friction_coefficient ?? 0;
}

/** Grip margin as the core gives it, with hinges what slip has cost, and a bar for each wheel: force over the friction
 * available. */
export function showGrip(/** @type {any} */ { scene, layout }, /** @type {any} */ out) {
  const wheels = layout ? layout.parts.flatMap((/** @type {any} */ part) => part.wheels) : scene.vehicle.wheel;
  const isJudged = layout || wheels.some((/** @type {any} */ wheel) => frictionOf(scene, wheel) > 0);
  const margin = layout ? `${shown(out.slip_loss_J)} J` : `${fixed(out.no_slip_margin_N, 1)} N`;
  byId("margin").textContent = isJudged ? margin : "–";
  byId("margin-of").textContent = layout ? "lost by slip" : "margin";
  const isLost = out.contact_state
    ? out.contact_state.some((/** @type {number} */ s) => s > 0)
    : out.no_slip_margin_N < -1e-9;
  byId("grip-note").textContent = !isJudged
    ? "no friction coefficient given"
    : isLost
      ? lossOf(out)
      : "every wheel holds";
  byId("grip-note").classList.toggle("warn", Boolean(isJudged && isLost));
  const list = byId("grip");
  while (list.children.length > wheels.length) list.lastChild.remove();
  while (list.children.length < wheels.length) list.append(gripRow(list.children.length));
  wheels.forEach((/** @type {any} */ wheel, /** @type {number} */ k) => {
    const i = wheel.number ?? k;
    showWheelGrip(list.children[i], out, i, frictionOf(scene, wheel));
  });
}

function lossOf(/** @type {any} */ out) {
  if (!out.contact_state) return "the ground could not hold this: not true from here on";
  const slipping = out.contact_state
    .map((/** @type {number} */ s, /** @type {number} */ i) => (s > 0 ? i + 1 : 0))
    .filter(Boolean);
  return `${slipping.length > 1 ? "wheels" : "wheel"} ${slipping.join(", ")} slip${slipping.length > 1 ? "" : "s"}`;
}

function gripRow(/** @type {number} */ i) {
  const bar = element("span", { className: "bar" }, element("span"));
  return element(
    "li",
    {},
    element("span", { className: "name" }, `Wheel ${i + 1}`),
    bar,
    element("span", { className: "value" }),
  );
}

function showWheelGrip(
  /** @type {any} */ row,
  /** @type {any} */ out,
  /** @type {number} */ i,
  /** @type {number} */ friction,
) {
  const force = Math.hypot(out.along_N[i], out.lateral_N[i]),
    held = friction * out.normal_N[i];
  const share = held > 0 ? force / held : 0;
  row.children[1].firstChild.style.width = `${Math.min(100, 100 * share).toFixed(1)}%`;
  row.classList.toggle("lost", out.contact_state ? out.contact_state[i] > 0 : share > 1);
  const grip = held > 0 && Number.isFinite(share) ? `${fixed(100 * Math.min(share, 9.99), 0)} %` : "–";
  const speed = out.scrub_Nm
    ? `slip ${fixed(Math.hypot(out.slip_along_m_per_s[i], out.slip_across_m_per_s[i]))} m/s`
    : `${fixed(out.wheel_speed_rad_per_s[i], 1)} rad/s`;
  row.children[2].textContent = `${speed}, ${grip}`;
}
