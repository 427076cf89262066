"""The sections of the project's page, and its goals, which are a page of their own.

The texts of the report's page above its pictures and tables, by section; paragraphs are separated by empty lines.
"""

from __future__ import annotations

from collections.abc import Sequence

from laconic.scene.methods import EXACT, EXPLICIT
from laconic.tools.report import pictures
from laconic.tools.report.collect import MAP_SCENE
from laconic.tools.report.estimated import table_of
from laconic.tools.report.page import Row, Section, Table

GOALS = """
The project's own goals, each computed from the measurements of the other page.
"""

ACCURACY = """
Each point is one step size, from 1 to 100 ms (or parts and multiples of a step that fits none of these). Full lines:
double; dashed: single. The error is the largest of the
three components of ν at twenty instants or fewer of the first ten seconds, over max(1, largest ν), against a separate
numpy reference with an error of about 1e-11. Run time: thread CPU time of a step with held inputs, pose and
wheel angles included. `auto` picks one of the methods, so its large hollow circles lie on that method's points. In
the grey band the error may be the reference's own. With friction or limits of a drive the reference is the same step,
forty times finer than the finest here, and its own error, which the band shows, is what it differs from a run of twice
that step: the step is of first order.

Choose the lowest point that fits your run time. The core refused steps without a point.

The first table compares the error that a run estimates of itself (docs/accuracy.md) with the true one, where that
is above the reference's own error and rounding.
"""

PEERS = """
Scene S1 (three omni wheels, all voltages a square wave of 1 s), steps of 10 ms, gcc -O2. Both sides in one run,
interleaved, thread CPU time, the least of many rounds; `ratio` is the time over that of CasADi's generated RK4 of the
same nine states. Instructions by cachegrind, as I(2n) − I(n). The core computes the forcing of a held input once for
all its steps, CasADi's step computes it every time.

The general solvers restart at every jump of the voltages. Adams and BDF are CVODE's, from C.
"""

STABILITY = f"""
Scene {MAP_SCENE}, its motors from a tenth of their strength to a million times that: four voltage steps of a quarter
second, error of ν at their ends beside the motion in 50 digits. Grey: refused by the core before it could go wrong.
Dashed: h·r = 1. The last map is that of the friction step, on ground with friction, beside itself in much finer steps.

The table: auto on very stiff vehicles. Sinusoids are sampled at the start, middle and end of each step.
"""

CONSERVED = f"""
Free motion of the paper's three-wheel carriage in steps of 0.1 s. Both integrals of the motion, the energy and K =
(Aν)₃, the third component of inertia times velocity, should stay constant.
Curves that coincide are drawn one inside the other.

The table: one step with U = 0 of ten thousand random vehicles in random states, h from 1e-6 to 1e3 s; the A-norm
√(νᵀAν) may not grow. Methods other than {EXACT} refuse the step when it grows by more than their error allows
(2⁻¹⁰).
"""

ROBOT = """
From above; a wheel's roller is the one that touches the ground. `r` is the fastest rate at which the motors damp a
motion of this robot (back-EMF and friction), h its own step: explicit methods need h·r well below 2, `auto` takes
any. With friction that rate changes with the contacts and is left out.

What to take: for an accuracy that you want of ν, pose and wheel angles (relative, against an independent numpy
reference; with friction against a much finer step), the quickest method and step that reached it on this computer, with
the inputs of this scene.
"""

ROBOT_STABILITY = """
This robot, its motors from a tenth of their strength to a million times that: four voltage steps of a quarter second,
error of ν at their ends. Grey: refused by the core before it could go wrong. On ground with friction it is the friction
step's, beside itself in much finer steps.
"""

ROBOT_BOARD = """
One step of this scene on a Cortex-M4F at -Os, under QEMU (-icount): instructions, not cycles; the same digits in
every run. `whole`: with the whole core; `trimmed`: with a core built for this scene alone (cmake -DLACONIC_SCENE=…).
Code: the functions that a step can reach. Flash: all that a step links, its prepared constants included. Stack: the
worst path of the call graph. `host's bits`: the state is the host's to the last bit.
"""

BOARDS = """
Scene S1 with pose and wheel angles under QEMU (-icount): instructions, not cycles; the same digits in every run.
Code: the functions that a step can reach. Flash: all that a step links, its prepared constants included. Stack: worst
path of the call graph, and the most that a run was seen to use. Where the processor has no double-precision FPU (all
but the M7) double is emulated; on the M3 and M4 soft_double.c adds and subtracts, since libgcc rounds some differences
wrongly (docs/c.md).
"""

SCENES = """
The same scene with the whole core and with a core built for it alone (cmake -DLACONIC_SCENE=…), by its own method,
-Os, Cortex-M4F. Whole and trimmed give the same bits; `host's bits`: so does the host.
"""

REFERENCES = """
Solutions to 25 digits; errors over max(1, largest value of that kind in the case).
"""

EXTREMES = """
Numbers at the edge: S1's vehicle with one thing changed, a hundred steps of 10 ms (ten of 1 s) by auto and by the
method of order 8. `right`: ν is within 1e-6, plus the digits that the condition number takes, of the motion in 50
digits; `coarse`: some digits are, as the step is long; `number`: finite, but too far to be followed.
"""


ROUNDING = f"""
What single precision can and cannot do: proved bounds of what rounding does in one step of {EXPLICIT} to ν, heading
and place, for all states within what the scene's run shows of each axis, beside the same step in exact arithmetic with
the same prepared constants. Per hour: what heading and place are off by for their own rounding if every step rounded as
badly as it can, all one way; an error of ν acts on them besides, as any does. As the sums of a state carry what they
could not take up, the bounds do not grow with the way travelled or the turns made.
"""


def paragraphs(text: str) -> list[str]:
    """Split at empty lines, each in one line."""
    return [" ".join(part.split()) for part in text.strip().split("\n\n")]

FRICTION = """
Where wheels slip or motors reach limits, each step solves one convex problem for the contact forces. How long that
takes differs from step to step; an ideal step is an RK4 step of three wheels that roll (598 instructions on the host,
479 on a Cortex-M4F, in single). Double has no hardware on a Cortex-M4F.

The runs: the scene's own inputs on ground with friction, and voltages that change every ten steps with motors at their
limits, in which few steps begin near the solution.

The step is of first order, also where a motor reaches its current limit or leaves it within a step. Errors of ν at the
end of 0.4 s are those against the same step 64 times finer than the finest.
"""


def project_sections(results: dict[str, list[Row]]) -> list[Section]:
    """In order."""
    return [_accuracy(results), _peers(results), _stability(results), _conserved(results), _boards(results),
            _scenes(results), _references(results), _extremes(results), rounding_section(results), _friction(results)]


def goal_sections(results: dict[str, list[Row]]) -> list[Section]:
    """The project's own goals."""
    fields = ("goal", "found", "bound", "wanted", "verdict")
    return [_section("goals", "Goals", (), Table(results["targets"], fields, headed_by="group"))]


def _section(key: str, title: str, pictures_of: Sequence[str], *tables: Table) -> Section:
    return Section(key, title, paragraphs(globals()[key.upper()]), pictures_of, tables)


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
