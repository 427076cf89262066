// The lists and buttons of the page: what they offer, and what they call.
import { ownScene, scenes } from "./facts.js";
import { byId, element, shown } from "./texts.js";

const EVENTS = ["input", "change", "click", "dblclick", "keydown", "keyup", "pointerdown", "pointermove", "resize"];

export function fillChoices(/** @type {any} */ laconic) {
  const groups = [
    ["Real robots and examples", (/** @type {string} */ id) => !id.startsWith("paper")],
    ["From the paper", (/** @type {string} */ id) => id.startsWith("paper")],
  ];
  const options = groups.map(([label, takes]) =>
    element(
      "optgroup",
      { label },
      ...scenes
        .filter(({ id }) => /** @type {any} */ (takes)(id))
        .map(({ id, name }) => element("option", { value: id }, name)),
    ),
  );
  byId("robot").append(
    ...options,
    element("optgroup", { label: "Draw one" }, element("option", { value: "own" }, ownScene().name)),
  );
  byId("method").append(
    ...laconic.methods.map((/** @type {any} */ { name, order }) =>
      element("option", { value: name }, `${name}, order ${order}`),
    ),
  );
}

/** A step that the list lacks gets its line. */
export function showStep(/** @type {number} */ step_s) {
  const select = byId("step-size");
  if (![...select.options].some((option) => Number(option.value) === step_s))
    select.append(element("option", { value: String(step_s) }, `${shown(step_s * 1000)} ms`));
  select.value = [...select.options].find((option) => Number(option.value) === step_s).value;
}

export function listenFor(/** @type {any} */ page) {
  byId("robot").addEventListener("change", (/** @type {any} */ event) => page.choose(event.target.value));
  byId("play").addEventListener("click", () => page.play(!page.isPlaying));
  byId("step").addEventListener("click", () => page.singleStep());
  byId("restart").addEventListener("click", () => page.restart());
  byId("speed").addEventListener("change", (/** @type {any} */ event) => (page.speed = Number(event.target.value)));
  byId("method").addEventListener("change", (/** @type {any} */ event) => page.change({ method: event.target.value }));
  byId("step-size").addEventListener("change", (/** @type {any} */ event) =>
    page.change({ step_s: Number(event.target.value) }),
  );
  byId("fleet").addEventListener("change", (/** @type {any} */ event) => page.change({ fleet: event.target.checked }));
  byId("ideal").addEventListener("change", (/** @type {any} */ event) => page.change({ ideal: event.target.checked }));
  byId("friction").addEventListener("change", (/** @type {any} */ event) => page.setGround(event.target.checked));
  byId("zoom-in").addEventListener("click", () => (page.stage.zoom = Math.min(8, page.stage.zoom * 1.4)));
  byId("zoom-out").addEventListener("click", () => (page.stage.zoom = Math.max(0.05, page.stage.zoom / 1.4)));
  byId("study").addEventListener("click", () => page.startStudy(true));
  for (const input of document.querySelectorAll("input[name=view]"))
    input.addEventListener("change", () => page.view(/** @type {HTMLInputElement} */ (input).value));
  for (const name of EVENTS) window.addEventListener(name, () => page.wake(), true);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => page.wake());
}
