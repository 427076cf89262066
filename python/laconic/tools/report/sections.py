"""The sections of the project's page, and its goals, which are a page of their own."""

from __future__ import annotations

from collections.abc import Sequence

from laconic.tools.report import pictures, texts
from laconic.tools.report.estimated import table_of
from laconic.tools.report.page import Row, Section, Table


def project_sections(results: dict[str, list[Row]]) -> list[Section]:
    """In order."""
    return [_accuracy(results), _peers(results), _stability(results), _conserved(results), _boards(results),
            _scenes(results), _references(results), _extremes(results), rounding_section(results), _friction(results)]


def goal_sections(results: dict[str, list[Row]]) -> list[Section]:
    """The project's own goals."""
    fields = ("goal", "found", "bound", "wanted", "verdict")
    return [_section("goals", "Goals", (), Table(results["targets"], fields, headed_by="group"))]


def _section(key: str, title: str, pictures_of: Sequence[str], *tables: Table) -> Section:
    return Section(key, title, texts.paragraphs(getattr(texts, key.upper())), pictures_of, tables)


def _accuracy(results: dict[str, list[Row]]) -> Section:
    rows = results["accuracy"]
    drawn = [pictures.error_against_time(rows, scene) for scene in dict.fromkeys(row["scene"] for row in rows)]
    fields = ("scene", "real", "method", "step_s", "status", "error_nu", "estimate_nu", "error_pose", "estimate_pose",
              "error_wheel", "estimate_wheel", "ns_per_step", "us_per_second")
    return _section("accuracy", "Error against run time", drawn, table_of(rows), Table(rows, fields, "All runs", True))


def _peers(results: dict[str, list[Row]]) -> Section:
    rows = results["precision"]
    steps = Table(results["steps"], ("who", "real", "build", "ns_per_step", "ratio", "instructions"), "One step")
    runs = Table(rows, ("who", "real", "setting", "error_nu", "ms"), "All runs (setting: step [s] or tolerance)", True)
    return _section("peers", "Beside other integrators", [pictures.precision(rows)] if rows else [], steps, runs)


def mapped(rows: Sequence[Row]) -> list[str]:
    """The methods of a stability map, in the order of its rows; the friction step counts as one."""
    return list(dict.fromkeys(row["method"] for row in rows))


def _stability(results: dict[str, list[Row]]) -> Section:
    drawn = [pictures.stability(results["map"], method) for method in mapped(results["map"])]
    fields = ("scene", "factor", "inputs", "step_s", "status", "error_nu", "error_path")
    return _section("stability", "Stability map", drawn, Table(results["stiff"], fields))


def _conserved(results: dict[str, list[Row]]) -> Section:
    drawn = [pictures.drift(results["drift"], real, what) for real in ("double", "single") for what in ("energy", "K")
             if results["drift"]]
    fields = ("real", "method", "steps_taken", "worst_growth_ulp", "refused")
    return _section("conserved", "What is conserved", drawn, Table(results["norm"], fields))


def _boards(results: dict[str, list[Row]]) -> Section:
    rows = [row for row in results["boards"] if row["status"] == "ok"]
    main = [row for row in rows if row["processor"] == "Cortex-M4F" and row["real"] == "single"]
    fields = ("processor", "real", "method", "optimisation", "build", "instructions", "step_code", "flash", "tables",
              "state", "worst_stack", "stack_measured", "same_bits")
    return _section("boards", "On a microcontroller", (), Table(main, fields[2:], "Cortex-M4F, single"),
                    Table(rows, fields, "All boards", True))


def _scenes(results: dict[str, list[Row]]) -> Section:
    fields = ("scene", "chosen", "real", "build", "instructions", "step_code", "flash", "state", "worst_stack",
              "same_bits")
    return _section("scenes", "Whole and trimmed, scene by scene", (), Table(results["scenes"], fields))


def _references(results: dict[str, list[Row]]) -> Section:
    auto = [row for row in results["verified"] if row["method"] == "auto"]
    fields = ("case", "method", "step_s", "status", "error_nu", "error_pose", "error_wheel")
    beside = ("case", "step_s", "method", "prototype", "error_nu", "status", "as_good")
    return _section("references", "Reference trajectories", (), Table(auto, fields, "auto"),
                    Table(results["verified"], fields, "Every method", True),
                    Table(results["prototype"], beside, "Beside the prototype's errors"),
                    Table(results["single"], ("method", "step_s", "error_nu", "error_anywhere"),
                          "S1 in single precision: error of ν in rad/s at 10 s, and the largest on the way"))


def _extremes(results: dict[str, list[Row]]) -> Section:
    fields = ("case", "real", "method", "outcome", "error", "digits_lost", "why")
    return _section("extremes", "Extremes", (), Table(results["extremes"], fields))


def rounding_section(results: dict[str, list[Row]]) -> Section:
    """Of a robot's page, too."""
    fields = ("scene", "step_s", "status", "nu_rad_per_s", "heading_rad", "place_m", "heading_rad_per_hour",
              "place_m_per_hour")
    return _section("rounding", "Rounding in single precision", (), Table(results["rounding"], fields))


def _friction(results: dict[str, list[Row]]) -> Section:
    cost = ("run", "processor", "real", "wheels", "median_ideal", "p99_ideal", "worst_ideal", "median_instructions",
            "worst_instructions", "flash", "worst_stack")
    return _section("friction", "Ground with friction", (),
                    Table(results["friction_cost"], cost, "Cost of a step, in ideal steps and in instructions"),
                    Table(results["friction_order"], ("what", "step_s", "error_nu", "order"), "Observed order"),
                    Table(results["friction_extremes"], ("case", "real", "steps_taken", "refused", "finite", "speed"),
                          "Extreme grounds, with voltages that change every ten steps"))
