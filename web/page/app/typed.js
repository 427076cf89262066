// Numbers as they were typed: where the core is given none, the refusal says what stands in the field.
const MOST_SHOWN_TYPED = 40; // characters

const DECIMAL = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i; // what Number() takes besides, such as 0x10, is a slip
const THOUSANDS = /^[+-]?[1-9]\d{0,2},\d{3}$/; // or a decimal comma: the reader must say which

/** @type {Map<string, string>} */
const notNumbers = new Map();

/** The number in a field; NaN where there is none, which the core refuses. A comma is a decimal point, too, where it can
 * be nothing else. */
export function numberTyped(/** @type {string} */ path, /** @type {string} */ text) {
  const given = text.trim(),
    plain = given.replace(",", "."),
    value = DECIMAL.test(plain) && !THOUSANDS.test(given) ? Number(plain) : Number.NaN;
  if (Number.isNaN(value)) notNumbers.set(path, given);
  else notNumbers.delete(path);
  return value;
}

/** A refusal as a reader of the form understands it. */
export function worded(/** @type {any} */ refused) {
  if (refused?.status !== "not finite" || !Number.isNaN(refused.value)) return refused;
  const text = (notNumbers.get(refused.path) ?? "").slice(0, MOST_SHOWN_TYPED);
  const explanation = THOUSANDS.test(text)
    ? `“${text}” is ${text.replace(",", "")} or ${text.replace(",", ".")}; give one of them`
    : text
      ? `“${text}” is no number; give one`
      : "a number is missing; give one";
  return { path: refused.path, explanation, message: `${refused.path}: ${explanation}` };
}
