// The page: one robot, its drive, and what the panels show of it.
import { load } from "laconic";
import { load as loadHinges } from "laconic/hinges";
import { Study } from "./accuracy.js";
import { fillChoices, listenFor, showMethods, showStep } from "./choices.js";
import { Controls } from "./controls.js";
import { Editor } from "./editor.js";
import { allowExport, setUpExport } from "./exporting.js";
import { ownScene, scenes, slips } from "./facts.js";
import { Fields, setFriction } from "./fields.js";
import { showHash } from "./hash_check.js";
import { Cores, hasHinges } from "./hinged.js";
import { showPanels } from "./panels.js";
import { Run, SceneDrive } from "./run.js";
import { Stage } from "./stage.js";
import { byId, fixed, say } from "./texts.js";
import { worded } from "./typed.js";
import { refuseWheel } from "./wheel_form.js";

const LONGEST_FRAME_S = 0.1;
const PANEL_EVERY = 4; // frames
const AWAKE_FRAMES = 40; // that are drawn after the last thing that happened: the view comes to rest
const STUDY_WAIT = 15; // frames without a change before errors and costs are measured
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
    this.awake = AWAKE_FRAMES;
    this.studyWait = STUDY_WAIT;
    /** @type {Run | undefined} */
    this.run = undefined;
    this.costs = /** @type {number[]} */ ([]);
    this.stage = new Stage(byId("stage"));
    this.fields = new Fields(() => this.rebuild());
    this.editor = new Editor(() => this.drawn(), laconic.maxWheels);
    this.controls = new Controls({ touched: (mode) => this.touched(mode) });
    fillChoices();
    listenFor(this);
    this.choose(FIRST);
    setUpExport(() => ({ scene: this.scene, how: this.how, run: this.run, led: this.led() }));
    requestAnimationFrame((now) => this.frame(now));
  }

  /** A robot by its name. */
  choose(/** @type {string} */ id) {
    byId("robot").value = id;
    this.scene = structuredClone(id === "own" ? ownScene() : scenes.find((scene) => scene.id === id));
    this.scene.input ??= [];
    const { method, step_s } = this.scene.run;
    this.how = { ...this.how, method, step_s };
    showMethods(this.laconic.methodsOf(this.scene), method);
    showStep(step_s);
    this.run?.free();
    this.run = undefined;
    this.ended = false;
    this.editor.chosen = 0;
    this.fit();
    this.rebuild();
    this.controls.choose(this.sceneDrive?.isEmpty && !this.scene.initial ? "velocity" : "scene", false);
    byId("source").textContent = byId("source").title = this.scene.source;
    if (id === "own") this.view("draw");
    else if (this.isDrawing && hasHinges(this.scene)) this.view("drive");
  }

  fit() {
    const hinged = hasHinges(this.scene);
    this.fields.changedPath = undefined;
    this.fields.fit(this.scene);
    if (!hinged) this.editor.fit(this.scene);
    byId("ideal-row").hidden = !slips(this.scene);
    for (const id of ["friction-row", "error-line"]) byId(id).hidden = hinged;
    byId("grip-panel").hidden = hinged && !slips(this.scene);
    byId("hinges-panel").hidden = !hinged;
    byId("draw-view").disabled = hinged;
    byId("draw-view").parentElement.title = hinged ? "Not for robots with hinges: edit the exported scene" : "";
  }

  change(/** @type {any} */ part) {
    this.how = { ...this.how, ...part };
    this.rebuild();
  }

  drawn() {
    this.fields.changedPath = undefined;
    this.rebuild();
  }

  setGround(/** @type {boolean} */ isSlippery) {
    setFriction(this.scene, isSlippery);
    this.fit();
    this.rebuild();
  }

  /** The run anew after a change: the same drive until the same instant. What the core refuses stops the robot. */
  rebuild() {
    this.sceneDrive = new SceneDrive(this.scene);
    try {
      const before = this.run;
      const run = before
        ? Run.again(this.laconic, this.scene, this.how, before)
        : new Run(this.laconic, structuredClone(this.scene), this.how);
      run.scene = structuredClone(this.scene);
      before?.free();
      const isSame =
        before?.scene.id === run.scene.id && before?.scene.vehicle.wheel.length === run.scene.vehicle.wheel.length;
      this.run = run;
      this.controls.fit(run.main.robot, run.scene, isSame);
      if (!isSame) this.stage.reset();
      this.refuse(undefined);
      this.stopped = false;
      allowExport(true, !run.layout);
      this.startStudy();
      showPanels(this);
    } catch (refused) {
      this.refuse(refused);
      allowExport(false, false);
    }
  }

  /** Shows a refusal near its field, and over the stage, as a field may be out of sight; undefined: none. */
  refuse(/** @type {any} */ thrown) {
    const refused = worded(thrown);
    this.refused = refused;
    this.fields.refuse(refused);
    refuseWheel(refused);
    const isOfMethod = Boolean(refused?.path.startsWith("run."));
    byId("method-error").textContent = isOfMethod ? refused.explanation : "";
    byId("banner").hidden = !refused;
    byId("banner").textContent = refused ? refused.message : "";
  }

  touched(/** @type {string} */ mode) {
    this.wake();
    if (mode === "scene") return this.run && this.restart();
    this.ended = false;
    if (this.stopped) this.goOn();
    if (!this.isPlaying && this.run && this.run.steps === 0) this.play(true);
    return undefined;
  }

  /** After a refusal in motion, which left the robot as it was, another command may be taken. */
  goOn() {
    this.stopped = false;
    this.left_s = 0;
    this.refuse(undefined);
  }

  play(/** @type {boolean} */ isPlaying) {
    this.isPlaying = isPlaying;
    if (isPlaying && this.ended) this.restart();
    byId("play").textContent = isPlaying ? "Pause" : "Play";
    this.left_s = 0;
    showPanels(this);
  }

  singleStep() {
    this.play(false);
    this.advance(SINGLE_STEP_S);
    showPanels(this);
    if (this.run) say(`at ${fixed(this.run.time_s)} s`);
  }

  /** From the start; a robot that the core refuses stays where it stopped. */
  restart() {
    const before = this.run;
    this.run = undefined;
    this.ended = false;
    this.left_s = 0;
    this.rebuild();
    this.stage.reset();
    if (this.run) before?.free();
    else this.run = before;
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
      this.stopped = true;
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
    const passed = Math.min((now - (this.before ?? now)) / 1000, LONGEST_FRAME_S),
      start = performance.now();
    this.before = now;
    this.controls.pollGamepad();
    if (this.isPlaying) this.advance(passed * this.speed);
    if (this.isPlaying || --this.awake >= 0) this.draw();
    if (this.frames++ % PANEL_EVERY === 0 && (this.isPlaying || !this.tabled)) showPanels(this);
    this.costs.push(performance.now() - start);
    if (this.costs.length > 60) this.costs.shift();
    if (--this.studyWait < 0) this.study?.advance();
  }

  draw() {
    if (this.isDrawing) this.editor.draw();
    else if (this.run) this.stage.draw(this.run, Boolean(this.refused));
  }

  /** Something happened that may show. */
  wake() {
    this.awake = AWAKE_FRAMES;
  }

  /** Measures error and cost: with a turn that every method finds hard, or with what acts now. */
  startStudy(isOfNow = false) {
    const run = /** @type {Run} */ (this.run);
    const signals = isOfNow && Object.keys(run.signals).length ? run.signals : this.usualSignals();
    this.study = new Study(this.laconic, run.scene, signals);
    this.studyWait = STUDY_WAIT;
    this.tabled = false;
  }

  /** A curve at half the speed; without motors the first inputs of the scene. */
  usualSignals() {
    const usual = this.controls.way.usual();
    if (usual) return usual;
    const acts = (/** @type {any} */ signals) => Object.values(signals).some((value) => value !== 0);
    return this.sceneDrive?.changes.find(({ signals }) => acts(signals))?.signals ?? {};
  }

  view(/** @type {string} */ name) {
    this.isDrawing = name === "draw";
    /** @type {any} */ (document.querySelector(`input[name=view][value=${name}]`)).checked = true;
    document.body.dataset.view = name;
    for (const [id, isShown] of /** @type {[string, boolean][]} */ ([
      ["stage", !this.isDrawing],
      ["drawing", this.isDrawing],
      ["drive-panel", !this.isDrawing],
      ["wheel-panel", this.isDrawing],
    ]))
      byId(id).hidden = !isShown;
  }
}

const [laconic, hinges] = await Promise.all([load(), loadHinges()]);
if (window.matchMedia("(max-width: 1099px)").matches)
  for (const part of document.querySelectorAll("aside details")) part.removeAttribute("open");
const page = new Page(new Cores(laconic, hinges));
page.play(page.isPlaying);
page.view("drive");
await showHash(laconic);
