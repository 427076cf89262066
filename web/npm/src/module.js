// The WebAssembly module, and what it says of itself: fields, methods, outputs.
const decoder = new TextDecoder();
const FIRST_OF_GZIP = 0x1f;

/** @param {string} text @returns {Uint8Array<ArrayBuffer>} */
export function bytesOf(text) {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

/** The bytes, or what gzip has made them of, as in the page. @param {Uint8Array<ArrayBuffer>} bytes */
export async function unpacked(bytes) {
  if (bytes[0] !== FIRST_OF_GZIP) return bytes;
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** What the core calls its numbers, and where they are. */
export class Module {
  /** @param {Record<string, any>} exported @param {WebAssembly.Module} compiled */
  constructor(exported, compiled) {
    this.c = exported;
    this.compiled = compiled;
    this.fields = this.listFields();
    this.outputs = this.listOutputs();
    this.methods = this.listMethods();
  }

  /** @param {string} wasm base64 */
  static async load(wasm) {
    const { instance, module } = await WebAssembly.instantiate(await unpacked(bytesOf(wasm)));
    return new Module(instance.exports, module);
  }

  /** @param {number} pointer */
  text(pointer) {
    const bytes = new Uint8Array(this.c.memory.buffer);
    return decoder.decode(bytes.slice(pointer, bytes.indexOf(0, pointer)));
  }

  /** @param {number} pointer @param {number} count */
  reals(pointer, count) {
    return Array.from(new Float64Array(this.c.memory.buffer, pointer, count));
  }

  /** Numbers of the core's fields by their path in a scene: "vehicle.wheel[#].x_m". */
  listFields() {
    const found = new Map();
    for (let number = 1; number < this.c.laconic_web_field_count(); number++) {
      const path = this.text(this.c.laconic_web_field_path(number));
      if (path) found.set(path, number);
    }
    return found;
  }

  listOutputs() {
    const found = [];
    for (let number = 0, row; (row = this.c.laconic_web_output(number)); number++) {
      const [name, offset, count] = new Uint32Array(this.c.memory.buffer, row, 3);
      found.push({ name: this.text(name), offset, count });
    }
    return found;
  }

  listMethods() {
    const found = [];
    for (let number = 0, name; (name = this.c.laconic_web_method_name(number)); number++)
      found.push({ name: this.text(name), number, order: this.c.laconic_web_method_order(number) });
    return found;
  }
}
