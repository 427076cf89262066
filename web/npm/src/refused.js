// What the core refuses, by the field's name and with the remedy.

/** An error whose `message` is one line: field, what is wrong, remedy. */
export class Refused extends Error {
  /** @param {string} path @param {string} explanation @param {string} status */
  constructor(path, explanation, status, value = 0, limit = 0) {
    super(path ? `${path}: ${explanation}` : explanation);
    this.name = "Refused";
    this.path = path;
    this.explanation = explanation;
    this.status = status;
    this.value = value;
    this.limit = limit;
  }

  /** The refusal of the last call. @param {import("./module.js").Module} module @param {number} robot */
  static of(module, robot) {
    const { c } = module;
    const line = module.text(c.laconic_web_text(robot));
    const [path, ...rest] = c.laconic_web_refused_field(robot) ? line.split(": ") : ["", line];
    const explanation = rest.join(": ");
    return new Refused(
      path,
      explanation,
      module.text(c.laconic_web_status_name(c.laconic_web_refused_status(robot))),
      c.laconic_web_refused_value(robot),
      c.laconic_web_refused_limit(robot),
    );
  }
}
