// The lists and buttons of the page: what they offer, and what they call.
import { ownScene, scenes } from "./facts.js";
import { hasHinges } from "./hinged.js";
import { byId, element, shown } from "./texts.js";

const EVENTS = ["input", "change", "click", "dblclick", "keydown", "keyup", "pointerdown", "pointermove", "resize"];

export function fillChoices() {
  const isOfPaper = (/** @type {any} */ { id }) => id.startsWith("paper");
  const groups = [
    ["Real robots and examples", (/** @type {any} */ scene) => !isOfPaper(scene) && !hasHinges(scene)],
    ["Steered wheels, casters, trailers", hasHinges],
    ["From the paper", isOfPaper],
  ];
  const options = groups.map(([label, takes]) =>
    element(
      "optgroup",
      { label },
      ...scenes
        .filter((scene) => /** @type {any} */ (takes)(scene))
        .map(({ id, name }) => element("option", { value: id }, name)),
    ),
  );
  byId("robot").append(
    ...options,
    element("optgroup", { label: "Draw one" }, element("option", { value: "own" }, ownScene().name)),
  );
}

/** The methods of the core that a robot has, one of them chosen. */
export function showMethods(/** @type {any[]} */ methods, /** @type {string} */ chosen) {
  byId("method").replaceChildren(
    ...methods.map(({ name, order }) => element("option", { value: name }, `${name}, order ${order}`)),
  );
  byId("method").value = chosen;
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
