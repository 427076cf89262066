// Numbers as they were typed: where the core is given none, the refusal says what stands in the field.
const MOST_SHOWN_TYPED = 40; // characters

/** @type {Map<string, string>} */
const notNumbers = new Map();

/** The number in a field; NaN where there is none, which the core refuses. A comma is a decimal point, too. */
export function numberTyped(/** @type {string} */ path, /** @type {string} */ text) {
  const plain = text.trim().replace(",", "."),
    value = plain === "" ? Number.NaN : Number(plain);
  if (Number.isNaN(value)) notNumbers.set(path, text.trim());
  else notNumbers.delete(path);
  return value;
}

/** A refusal as a reader of the form understands it. */
export function worded(/** @type {any} */ refused) {
  if (refused?.status !== "not finite" || !Number.isNaN(refused.value)) return refused;
  const text = (notNumbers.get(refused.path) ?? "").slice(0, MOST_SHOWN_TYPED);
  const explanation = text ? `“${text}” is no number; give one` : "a number is missing; give one";
  return { path: refused.path, explanation, message: `${refused.path}: ${explanation}` };
}
