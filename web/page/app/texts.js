// Numbers and names as people read them.

const ONE_DEGREE = Math.PI / 180;

/** Three significant digits without exponent where that is short; a dash for what is no number. */
export function shown(/** @type {number} */ value, digits = 3) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size < 1e-12) return "0";
  if (size >= 1e5 || size < 1e-3)
    return value
      .toExponential(digits - 1)
      .replace("e", " · 10^")
      .replace("^+", "^");
  return String(Number(value.toPrecision(digits)));
}

/** A fixed number of decimals with a true minus sign, so that columns do not jump. */
export function fixed(/** @type {number} */ value, decimals = 2) {
  if (!Number.isFinite(value)) return "–";
  const text = Math.abs(value).toFixed(decimals);
  return value < 0 && Number(text) !== 0 ? `−${text}` : text;
}

/** A number as it stands in a field: short, though its last digits may not show. */
export function entry(/** @type {number | string} */ value) {
  const text = String(value);
  if (text.length <= 8 || typeof value === "string") return text;
  const size = Math.abs(value);
  if (size < 1e-3 || size >= 1e6) return value.toExponential(3).replace(/\.?0+e/, "e");
  return String(Number(value.toPrecision(5)));
}

/** A length by its best unit. */
export function length(/** @type {number} */ metres) {
  if (!Number.isFinite(metres)) return "–";
  if (Math.abs(metres) < 1e-10) return "< 0.1 nm";
  const units = /** @type {[number, string][]} */ ([
    [1, "m"],
    [1e-3, "mm"],
    [1e-6, "µm"],
    [1e-9, "nm"],
  ]);
  const [size, unit] = units.find(([size]) => Math.abs(metres) >= size) ?? [1e-9, "nm"];
  return `${shown(metres / size, 2)} ${unit}`;
}

/** A power of ten with real superscripts. */
export function power(/** @type {number} */ exponent) {
  const digits = [...String(Math.abs(exponent))].map((digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(digit)]).join("");
  return `10${exponent < 0 ? "⁻" : ""}${digits}`;
}

/** Two significant digits, downwards: the end of a slider. */
export function roundDown(/** @type {number} */ value) {
  if (!(value > 0) || !Number.isFinite(value)) return 1;
  const unit = 10 ** (Math.floor(Math.log10(value)) - 1);
  return Number((Math.floor(value / unit) * unit).toPrecision(2));
}

export function inDegrees(/** @type {number} */ rad) {
  return Number((rad / ONE_DEGREE).toFixed(9));
}

export function inRadians(/** @type {number} */ deg) {
  return deg * ONE_DEGREE;
}

/** An element by its id, which the page has. @returns {any} */
export function byId(/** @type {string} */ id) {
  return document.getElementById(id);
}

/** @param {string} tag @param {Record<string, any>} [properties] @param {...any} children @returns {any} */
export function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties))
    if (name in made) /** @type {any} */ (made)[name] = value;
    else made.setAttribute(name, value);
  made.append(...children);
  return made;
}

/** Tells those who listen, once and politely. */
export function say(/** @type {string} */ text) {
  byId("status").textContent = text;
}
