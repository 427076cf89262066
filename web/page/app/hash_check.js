// The bits of this browser against those of the native core: computed beside the page, in a worker.
import { nativeHash } from "./facts.js";
import { byId } from "./texts.js";

const WORKER = `onmessage = async ({ data }) => {
  const instance = await WebAssembly.instantiate(data);
  const lines = [];
  for (let line = 0, bits; (bits = instance.exports.laconic_web_hash(line)); line++)
    lines.push(BigInt.asUintN(64, bits).toString(16).padStart(16, "0"));
  postMessage(lines.join(" "));
};`;

/** Shows whether they are equal. */
export async function showHash(/** @type {any} */ laconic) {
  const found = await hashBeside(laconic.module.compiled).catch(() => laconic.hash());
  const isSame = found === nativeHash;
  byId("hash").textContent = found;
  byId("hash-verdict").textContent = isSame
    ? "Same bits as the native core"
    : `Not the bits of the native core, ${nativeHash}`;
  byId("bits").dataset.same = String(isSame);
}

/** @returns {Promise<string>} */
function hashBeside(/** @type {WebAssembly.Module} */ compiled) {
  return new Promise((resolve, reject) => {
    const url = URL.createObjectURL(new Blob([WORKER], { type: "text/javascript" }));
    const worker = new Worker(url);
    worker.onmessage = ({ data }) => {
      resolve(data);
      worker.terminate();
      URL.revokeObjectURL(url);
    };
    worker.onerror = reject;
    worker.postMessage(compiled);
  });
}
