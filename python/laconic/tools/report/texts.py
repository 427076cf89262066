"""The texts of the report's page above its pictures and tables, by section; paragraphs are separated by empty lines."""

from __future__ import annotations

from laconic.scene.methods import EXACT, EXPLICIT
from laconic.tools.report.collect import MAP_SCENE

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
