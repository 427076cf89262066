// The panels beside the view: numbers, grip, error and cost, legend.
import { drawStudy, tableOf } from "./accuracy.js";
import { drawVelocities, showGrip, showNumbers } from "./charts.js";
import { showHinges } from "./hinged_view.js";
import { byId, fixed, length, shown } from "./texts.js";

/** Everything that tells what the robot does now. */
export function showPanels(/** @type {any} */ page) {
  if (!page.run) return;
  const out = page.run.main.robot.outputs();
  byId("time").textContent = `${fixed(page.run.time_s)} s`;
  if (page.controls.mode === "scene") page.controls.follow(page.run.signals);
  showNumbers(out);
  if (page.run.layout) showHinges(page.run, out);
  if (!page.run.layout || page.run.main.robot.hasFriction) showGrip(page.run, out);
  drawVelocities(page.run.history);
  byId("error-now").textContent = length(page.run.error_m());
  byId("error-of").textContent = page.run.reference
    ? `${page.run.reference.method} at ${shown((page.run.step_s / page.run.parts) * 1000)} ms`
    : "no reference";
  showLegend(page);
  if (!page.study) return;
  drawStudy(page.study, page.how);
  if (!page.tabled) tableOf(page.study);
  page.tabled = page.study.isDone;
}

function showLegend(/** @type {any} */ page) {
  const { run } = page;
  byId("legend-ideal").hidden = !run.ideal;
  const behind = (run.trails?.all ?? []).map((/** @type {any} */ { name }) => name);
  byId("legend-trails").hidden = behind.length === 0;
  byId("legend-trails").lastChild.textContent = behind.join(", ");
  byId("legend-fleet").hidden = run.fleet.length === 0;
  byId("ideal-note").textContent = page.how.ideal && run.idealRefused ? run.idealRefused : "";
  const cost = median(page.costs); // as other work on the machine only adds to it
  byId("figures").textContent =
    `${run.actors.length} ${run.actors.length > 1 ? "vehicles" : "vehicle"}, ${fixed(cost, 1)} ms a frame`;
  const { x_m, y_m, heading_rad } = run.main.robot.outputs();
  byId("figures").dataset.pose = JSON.stringify([x_m, y_m, heading_rad]); // with all digits
  Object.assign(byId("figures").dataset, {
    frames: page.frames,
    cost_ms: cost.toFixed(3),
    vehicles: run.actors.length,
  });
}

function median(/** @type {number[]} */ values) {
  return [...values].sort((a, b) => a - b)[values.length >> 1] ?? 0;
}
