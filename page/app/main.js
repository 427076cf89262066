// The page: one robot, its drive, and what the panels show of it.
import { load } from "laconic";
import { Study, drawStudy, tableOf } from "./accuracy.js";
import { drawVelocities, showGrip, showNumbers } from "./charts.js";
import { Controls } from "./controls.js";
import { perWheel } from "./drive.js";
import { Editor } from "./editor.js";
import { setUpExport } from "./exporting.js";
import { ownScene, scenes, slips } from "./facts.js";
import { Fields, setFriction } from "./fields.js";
import { showHash } from "./hash_check.js";
import { Run, SceneDrive } from "./run.js";
import { Stage } from "./stage.js";
import { byId, element, fixed, length, say, shown } from "./texts.js";

const LONGEST_FRAME_S = 0.1;
const PANEL_EVERY = 4; // frames
const FIRST = "robotino2";
const SINGLE_STEP_S = 0.1;

/** Everything that the page knows. */
class Page {
  constructor(/** @type {any} */ laconic) {
    this.laconic = laconic;
    this.how = { method: "auto", step_s: 0.001, ideal: true, fleet: false };
    this.isPlaying = !window.matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.speed = 1;
    this.left_s = 0;
    this.frames = 0;
    this.costs = /** @type {number[]} */ ([]);
    this.stage = new Stage(byId("stage"));
    this.fields = new Fields(() => this.rebuild());
    this.editor = new Editor(() => this.rebuild());
    this.controls = new Controls({ touched: (mode) => this.touched(mode) });
    this.fillChoices();
    this.listen();
    this.choose(FIRST);
    setUpExport(() => ({ scene: this.scene, how: this.how, run: this.run, led: this.led() }));
    requestAnimationFrame((now) => this.frame(now));
  }

  fillChoices() {
    const groups = [["Real robots and examples", (/** @type {string} */ id) => !id.startsWith("paper")], ["From the paper", (/** @type {string} */ id) => id.startsWith("paper")]];
    const options = groups.map(([label, takes]) => element("optgroup", { label },
      ...scenes.filter(({ id }) => /** @type {any} */ (takes)(id)).map(({ id, name }) => element("option", { value: id }, name))));
    byId("robot").append(...options, element("optgroup", { label: "Draw one" }, element("option", { value: "own" }, ownScene().name)));
    byId("method").append(...this.laconic.methods.map((/** @type {any} */ { name, order }) => element("option", { value: name }, `${name}, order ${order}`)));
  }

  listen() {
    byId("robot").addEventListener("change", (/** @type {any} */ event) => this.choose(event.target.value));
    byId("play").addEventListener("click", () => this.play(!this.isPlaying));
    byId("step").addEventListener("click", () => this.singleStep());
    byId("restart").addEventListener("click", () => this.restart());
    byId("speed").addEventListener("change", (/** @type {any} */ event) => (this.speed = Number(event.target.value)));
    byId("method").addEventListener("change", (/** @type {any} */ event) => this.change({ method: event.target.value }));
    byId("step-size").addEventListener("change", (/** @type {any} */ event) => this.change({ step_s: Number(event.target.value) }));
    byId("fleet").addEventListener("change", (/** @type {any} */ event) => this.change({ fleet: event.target.checked }));
    byId("ideal").addEventListener("change", (/** @type {any} */ event) => this.change({ ideal: event.target.checked }));
    byId("friction").addEventListener("change", (/** @type {any} */ event) => this.setGround(event.target.checked));
    byId("zoom-in").addEventListener("click", () => (this.stage.zoom = Math.min(8, this.stage.zoom * 1.4)));
    byId("zoom-out").addEventListener("click", () => (this.stage.zoom = Math.max(0.05, this.stage.zoom / 1.4)));
    byId("study").addEventListener("click", () => this.startStudy(true));
    for (const input of document.querySelectorAll("input[name=view]"))
      input.addEventListener("change", () => this.view(/** @type {HTMLInputElement} */ (input).value));
  }

  /** A robot by its name. */
  choose(/** @type {string} */ id) {
    byId("robot").value = id;
    this.scene = structuredClone(id === "own" ? ownScene() : scenes.find((scene) => scene.id === id));
    this.scene.input ??= [];
    const { method, step_s } = this.scene.run;
    this.how = { ...this.how, method, step_s };
    byId("method").value = method;
    this.showStep(step_s);
    this.sceneDrive = new SceneDrive(this.scene);
    this.run?.free();
    this.run = undefined;
    this.editor.chosen = 0;
    this.fit();
    this.rebuild();
    this.controls.choose(this.sceneDrive.isEmpty && !this.scene.initial ? "velocity" : "scene", false);
    byId("source").textContent = byId("source").title = this.scene.source;
    if (id === "own") this.view("draw");
  }

  /** A step that the list lacks gets its line. */
  showStep(/** @type {number} */ step_s) {
    const select = byId("step-size");
    if (![...select.options].some((option) => Number(option.value) === step_s))
      select.append(element("option", { value: String(step_s) }, `${shown(step_s * 1000)} ms`));
    select.value = [...select.options].find((option) => Number(option.value) === step_s).value;
  }

  fit() {
    this.fields.fit(this.scene);
    this.editor.fit(this.scene);
    byId("ideal-row").hidden = !slips(this.scene);
  }

  change(/** @type {any} */ part) {
    this.how = { ...this.how, ...part };
    this.rebuild();
  }

  setGround(/** @type {boolean} */ isSlippery) {
    setFriction(this.scene, isSlippery);
    this.fit();
    this.rebuild();
  }

  /** The run anew after a change: the same drive until the same instant. What the core refuses stops the robot. */
  rebuild() {
    try {
      const before = this.run;
      const run = before ? Run.again(this.laconic, this.scene, this.how, before) : new Run(this.laconic, structuredClone(this.scene), this.how);
      run.scene = structuredClone(this.scene);
      before?.free();
      const isSame = before?.scene.id === run.scene.id && before?.scene.vehicle.wheel.length === run.scene.vehicle.wheel.length;
      this.run = run;
      this.controls.fit(run.main.robot, run.scene, isSame);
      if (!isSame) this.stage.reset();
      this.refuse(undefined);
      this.startStudy();
      this.showPanels();
    } catch (refused) {
      this.refuse(refused);
    }
  }

  /** Shows a refusal near its field, and over the stage, as a field may be out of sight; undefined: none. */
  refuse(/** @type {any} */ refused) {
    this.refused = refused;
    this.fields.refuse(refused);
    this.editor.refuse(refused);
    const isOfMethod = Boolean(refused?.path.startsWith("run."));
    byId("method-error").textContent = isOfMethod ? refused.explanation : "";
    byId("banner").hidden = !refused;
    byId("banner").textContent = refused ? refused.message : "";
  }

  touched(/** @type {string} */ mode) {
    if (mode === "scene") return this.run && this.restart();
    this.ended = false;
    if (!this.isPlaying && this.run && this.run.steps === 0) this.play(true);
    return undefined;
  }

  play(/** @type {boolean} */ isPlaying) {
    this.isPlaying = isPlaying;
    if (isPlaying && this.ended) this.restart();
    byId("play").textContent = isPlaying ? "Pause" : "Play";
    this.left_s = 0;
    this.showPanels();
  }

  singleStep() {
    this.play(false);
    this.advance(SINGLE_STEP_S);
    this.showPanels();
    if (this.run) say(`at ${fixed(this.run.time_s)} s`);
  }

  restart() {
    if (this.refused) return;
    this.run?.free();
    this.run = undefined;
    this.ended = false;
    this.left_s = 0;
    this.rebuild();
    this.stage.reset();
  }

  /** Takes the steps that so much time is worth. */
  advance(/** @type {number} */ seconds) {
    if (!this.run || this.refused) return;
    this.left_s += seconds;
    const steps = Math.floor(this.left_s / this.run.step_s + 1e-6);
    this.left_s -= steps * this.run.step_s;
    try {
      if (this.controls.mode === "scene") this.lead(steps);
      else {
        this.run.set(this.controls.signals());
        this.run.advance(steps);
      }
    } catch (refused) {
      this.refuse(refused);
    }
  }

  /** By the scene's inputs; at their end it rests. */
  lead(/** @type {number} */ steps) {
    if (this.ended) return;
    this.ended = /** @type {SceneDrive} */ (this.sceneDrive).lead(/** @type {Run} */ (this.run), steps);
    if (!this.ended) return;
    this.play(false);
    say("the scene’s drive has ended");
  }

  /** The scene's own drive, from start to end, for an export before anything was driven. */
  led() {
    const { changes, duration_s } = /** @type {SceneDrive} */ (this.sceneDrive);
    return { changes, steps: Math.round(duration_s / this.how.step_s) };
  }

  frame(/** @type {number} */ now) {
    requestAnimationFrame((next) => this.frame(next));
    const passed = Math.min((now - (this.before ?? now)) / 1000, LONGEST_FRAME_S), start = performance.now();
    this.before = now;
    this.controls.pollGamepad();
    if (this.isPlaying) this.advance(passed * this.speed);
    if (this.isDrawing) this.editor.draw();
    else if (this.run) this.stage.draw(this.run, Boolean(this.refused));
    if (this.frames++ % PANEL_EVERY === 0) this.showPanels();
    this.costs.push(performance.now() - start);
    if (this.costs.length > 60) this.costs.shift();
    this.study?.advance();
  }

  showPanels() {
    if (!this.run) return;
    const out = this.run.main.robot.outputs();
    byId("time").textContent = `${fixed(this.run.time_s)} s`;
    if (this.controls.mode === "scene") this.controls.follow(this.run.signals);
    showNumbers(out);
    showGrip(this.run.scene, out);
    drawVelocities(this.run.history);
    byId("error-now").textContent = length(this.run.error_m());
    byId("error-of").textContent = this.run.reference ? `${this.run.reference.method} at ${shown((this.run.step_s / this.run.parts) * 1000)} ms` : "no reference";
    this.showLegend();
    if (!this.study) return;
    drawStudy(this.study, this.how);
    if (!this.tabled) tableOf(this.study);
    this.tabled = this.study.isDone;
  }

  showLegend() {
    const run = /** @type {Run} */ (this.run);
    byId("legend-ideal").hidden = !run.ideal;
    byId("legend-fleet").hidden = run.fleet.length === 0;
    byId("ideal-note").textContent = this.how.ideal && run.idealRefused ? run.idealRefused : "";
    const cost = this.costs.reduce((sum, each) => sum + each, 0) / Math.max(1, this.costs.length);
    byId("figures").textContent = `${run.actors.length} ${run.actors.length > 1 ? "vehicles" : "vehicle"}, ${fixed(cost, 1)} ms a frame`;
    const { x_m, y_m, heading_rad } = run.main.robot.outputs();
    byId("figures").dataset.pose = JSON.stringify([x_m, y_m, heading_rad]); // with all digits, for tests and curious people
    Object.assign(byId("figures").dataset, { frames: this.frames, cost_ms: cost.toFixed(3), vehicles: run.actors.length });
  }

  /** Measures error and cost: with a turn that every method finds hard, or with what acts now. */
  startStudy(isOfNow = false) {
    const run = /** @type {Run} */ (this.run);
    const signals = isOfNow && Object.keys(run.signals).length ? run.signals : this.usualSignals(run);
    this.study = new Study(this.laconic, run.scene, signals);
    this.tabled = false;
  }

  /** A curve at half the speed; without motors the first inputs of the scene. */
  usualSignals(/** @type {Run} */ run) {
    if (this.controls.hasMotors) return perWheel("voltage_V", run.main.robot.voltagesFor(...this.controls.most.map((value) => value / 2)));
    const acts = (/** @type {any} */ signals) => Object.values(signals).some((value) => value !== 0);
    return this.sceneDrive?.changes.find(({ signals }) => acts(signals))?.signals ?? {};
  }

  view(/** @type {string} */ name) {
    this.isDrawing = name === "draw";
    /** @type {any} */ (document.querySelector(`input[name=view][value=${name}]`)).checked = true;
    document.body.dataset.view = name;
    for (const [id, isShown] of /** @type {[string, boolean][]} */ ([["stage", !this.isDrawing], ["drawing", this.isDrawing], ["drive-panel", !this.isDrawing], ["wheel-panel", this.isDrawing]]))
      byId(id).hidden = !isShown;
  }
}

const laconic = await load();
if (window.matchMedia("(max-width: 1099px)").matches) for (const part of document.querySelectorAll("aside details")) part.removeAttribute("open");
const page = new Page(laconic);
page.play(page.isPlaying);
page.view("drive");
await showHash(laconic);
