// The dialog that shows what is exported, copies it and saves it.
import { cExample } from "./export_c.js";
import { sceneToml } from "./export_toml.js";
import { byId, say } from "./texts.js";

/** @param {() => {scene: any, how: any, run: import("./run.js").Run | undefined}} current */
export function setUpExport(current) {
  const dialog = byId("export");
  let name = "";
  const open = (/** @type {string} */ title, /** @type {string} */ file, /** @type {string} */ text) => {
    name = file;
    byId("export-title").textContent = title;
    byId("export-text").value = text;
    dialog.showModal();
    byId("export-text").scrollTop = 0;
  };
  byId("export-toml").addEventListener("click", () => open("Scene as TOML", "robot.toml", tomlOf(current())));
  byId("export-c").addEventListener("click", () => open("Example in C", "robot.c", cOf(current())));
  byId("export-close").addEventListener("click", () => dialog.close());
  byId("export-save").addEventListener("click", () => save(name, byId("export-text").value));
  byId("export-copy").addEventListener("click", () => copy(byId("export-text")));
}

/** A robot that the core refuses is none to take away; the banner tells what to mend. */
export function allowExport(/** @type {boolean} */ isWhole, /** @type {boolean} */ hasC) {
  for (const [id, isAllowed] of /** @type {[string, boolean][]} */ ([
    ["export-toml", isWhole],
    ["export-c", isWhole && hasC],
  ])) {
    byId(id).disabled = !isAllowed;
    byId(id).title = isAllowed ? "" : isWhole ? "Not for robots with hinges yet" : "Not while the robot is refused";
  }
}

function tomlOf(/** @type {any} */ { scene, how, run }) {
  return sceneToml(scene, how, run?.steps ? run : undefined);
}

/** Without a drive so far: the wheels' inputs of the scene, for its duration. */
function cOf(/** @type {any} */ { scene, how, run, led }) {
  return cExample(scene, how, run?.steps ? run : led);
}

function save(/** @type {string} */ name, /** @type {string} */ text) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: "text/plain" }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

async function copy(/** @type {any} */ area) {
  area.select();
  try {
    await navigator.clipboard.writeText(area.value);
  } catch {
    document.execCommand("copy"); // where a page from disk has no clipboard
  }
  byId("export-copy").textContent = "Copied";
  say("copied");
  setTimeout(() => (byId("export-copy").textContent = "Copy"), 1500);
}
