"""Many steps of motions whose end is known in closed form: rest, straight lines, a spin, circles, free motion with
petals. Heading and place may drift by rounding alone, in both scalar types; the references have 60 digits.

All motions step next to each other in the lanes of a batch, by `auto` and the explicit method of fourth order."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Protocol

import numpy as np
from flint import arb, ctx
from mpmath import mp, mpf

from assurance.common import Clock
from laconic.batch import Batch
from laconic.core import Vehicle
from laconic.errors import Refused, ResultFails
from laconic.scene import Scene, read_scene
from laconic.scene.methods import EXPLICIT
from laconic.tools.report.collocation import BITS, DIGITS, exact, true_states
from laconic.tools.report.drift import free
from laconic.tools.report.stability import strengthened
from laconic.tools.verify.exact.exact_model import ExactModel, Vector, cross, dot, exact_model, numbers_of
from laconic.tools.verify.exact.exact_steps import forcing_of, rate
from laconic.tools.verify.exact.trials import INPUTS

METHODS, STEP_S = ("auto", EXPLICIT), 1e-3
LEAST_STEPS, PIECE = 20_000, 1_000_000
LARGEST_ULP = 16.0  # of heading and place, in units of rounding of what they have come to;
FREE_ULP = 100.0    # where ζ itself turns, which amplifies the rounding of its start in a period,
MOVED_ULP = 2e-4    # and for each step what it changes of ζ, which it rounds: so much of the speed, all one way;
STANDING_M = 1e-12  # and of place what a method's own error at 1 ms holds a motion off by, however long it lasts
STEADY = mpf("1e-40")
TURN_BITS = {"double": 64, "single": 32}
PLACE, HEADING_RAD = complex(100.0, -50.0), 2.0  # of the start
Held = dict[str, list[float]]
Row = dict[str, Any]
NUMBERS: dict[str, Callable[[float], float]] = {"double": float, "single": lambda number: float(np.float32(number))}


@dataclass(frozen=True)
class Place:
    """ν, place as a complex number in metres, heading in rad, and the length of the path so far."""

    nu: Vector
    place: Any
    heading: Any
    path: Any


class Motion(Protocol):
    """A motion by the time; times as exact fractions. `heading` is that of the start."""

    @property
    def model(self) -> ExactModel: ...

    @property
    def heading(self) -> Any: ...

    def at(self, time_s: Fraction) -> Place: ...


def seconds(time_s: Fraction) -> Any:
    return mpf(time_s.numerator) / time_s.denominator


def velocity_of(model: ExactModel, nu: Vector) -> Any:
    """In body axes."""
    return model.radius * mp.mpc(nu[0], nu[1])


@dataclass(frozen=True)
class Steady:
    """ν never changes: rest, a straight line, a circle."""

    model: ExactModel
    nu: Vector
    place: Any
    heading: Any

    def at(self, time_s: Fraction) -> Place:
        """The chord of the arc."""
        t, rate_of_yaw = seconds(time_s), self.nu[2] / self.model.yaw_scale
        v = velocity_of(self.model, self.nu)
        turned = rate_of_yaw * t
        shift = v * t if turned == 0 else v * (mp.expj(turned) - 1) / mp.mpc(0, rate_of_yaw)
        return Place(self.nu, self.place + shift * mp.expj(self.heading), self.heading + turned, abs(v) * t)


def steady_motion(model: ExactModel, held: Held, near: Sequence[float], place: complex, heading: float) -> Steady:
    """The steady motion that the inputs keep, by Newton's method from one that is near; with a force fixed in the world
    there is none. Where nothing acts every such motion is one."""
    b = forcing_of(model, {name: [mpf(x) for x in values] for name, values in held.items()}, mpf(0))(mpf(0))
    free = [k for k in range(3) if any(row[k] for row in model.nu_of_zeta)]
    z = model.zeta([mpf(float(x)) for x in near])
    for _ in range(12):
        missed = rate(model, z, b)
        if max(abs(x) for x in missed) < STEADY * (1 + max(abs(x) for x in z)):
            break
        columns = [[(p - q) / mpf("2e-25") for p, q in zip(
            rate(model, moved(z, k, mpf("1e-25")), b), rate(model, moved(z, k, mpf("-1e-25")), b), strict=True)]
            for k in free]
        jacobian = mp.matrix([[columns[j][i] for j in range(len(free))] for i in free])
        step = mp.lu_solve(jacobian, mp.matrix([missed[i] for i in free]))
        for j, k in enumerate(free):
            z = moved(z, k, -step[j])
    else:
        raise ResultFails("no steady motion was found")
    return Steady(model, model.nu(z), mp.mpc(place), mpf(heading))


def moved(z: Vector, k: int, by: Any) -> Vector:
    return [x + by * (i == k) for i, x in enumerate(z)]


@dataclass(frozen=True)
class Periodic:
    """Free motion: in each period the heading turns by 2π/(|w|Λ), and the path repeats, turned and shifted."""

    model: ExactModel
    held: Held
    nu: Vector
    place: Any
    heading: Any
    period_s: Any
    turn: Any
    shift: Any   # of a period, seen along the heading at its start
    length: Any  # of a period's path, about

    def at(self, time_s: Fraction) -> Place:
        """Whole periods at once, the rest of one by collocation."""
        t = seconds(time_s)
        whole = mp.floor(t / self.period_s)
        rest = t - whole * self.period_s
        nu, shift, turned = along(self.model, self.nu, self.held, rest)
        q = mp.expj(self.turn)
        before = self.shift * (1 - mp.expj(whole * self.turn)) / (1 - q)
        heading = self.heading + whole * self.turn
        place = self.place + mp.expj(self.heading) * before + mp.expj(heading) * shift
        return Place(nu, place, heading + turned, self.length * t / self.period_s)


def periodic_motion(model: ExactModel, held: Held, nu: Sequence[float], place: complex, heading: float) -> Periodic:
    """ψ' = |w| g·ζ, and g·ζ is a + b cos ψ + c sin ψ as ζ turns by ψ about −w: a period takes
    2π/(|w| √(a² − b² − c²))."""
    start = [mpf(float(x)) for x in nu]
    z, w, g = model.zeta(start), model.gyro, model.nu_of_zeta[2]
    size = mp.sqrt(dot(w, w))
    axis = [x / size for x in w]
    a = dot(g, axis) * dot(axis, z)
    b, c = dot(g, z) - a, dot(g, cross(z, axis))
    if not a**2 > b**2 + c**2:
        raise ResultFails("this free motion has no period")
    period = 2 * mp.pi / (size * mp.sqrt(a**2 - b**2 - c**2))
    _, shift, turn = along(model, start, held, period)
    return Periodic(model, held, start, mp.mpc(place), mpf(heading), period, turn, shift,
                    abs(velocity_of(model, start)) * period)


def along(model: ExactModel, nu: Vector, held: Held, time_s: Any) -> tuple[Vector, Any, Any]:
    """ν, shift and turn after a time, from place 0 and heading 0."""
    if time_s == 0:
        return nu, mp.mpc(0), mpf(0)
    with ctx.workprec(BITS):
        start = [exact(x) for x in nu]
    row = true_states(model, start, 0.0, [held], [[fraction_of(time_s)]])[0]
    numbers = [of_ball(x) for x in row[:6]]
    return numbers[:3], mp.mpc(numbers[3], numbers[4]), numbers[5]


def fraction_of(number: Any) -> Fraction:
    """The nearest with 60 digits."""
    return Fraction(mp.nstr(number, DIGITS))


def of_ball(number: arb) -> Any:
    return mpf(number.mid().str(DIGITS, radius=False))


@dataclass(frozen=True)
class Case:
    """A named motion: of a scene's vehicle with its motors or without; `nu`: about what it holds, in rad/s."""

    name: str
    scene: str
    nu: tuple[float, float, float]
    driven: bool = True
    steady: bool = True
    strength: float = 1.0  # of the motors: damping and gain times this


CASES = (  # the free line is that of a vehicle whose centre of mass is in its middle: else it is unstable one way
    Case("rest", "s1", (0.0, 0.0, 0.0)),
    Case("straight line, free", "kuka_youbot", (5.0, -20.0, 0.0), driven=False),
    Case("straight line, driven", "kuka_youbot", (8.0, 3.0, 0.0)),
    Case("spin, free", "s1", (0.0, 0.0, 2.0), driven=False),
    Case("circle, three wheels", "s1", (3.0, 1.0, 1.5)),
    Case("circle, four wheels", "kuka_youbot", (6.0, -2.0, 3.0)),
    Case("circle, damping × 1000", "kuka_youbot", (6.0, -2.0, 3.0), strength=1e3),
    Case("free motion with petals", "paper_three_wheel_free", (0.0, 6.0, 1.0), driven=False, steady=False))


@dataclass(frozen=True)
class Prepared:
    """A case with numbers as the core takes them: doubles, or singles."""

    case: Case
    table: dict[str, Any]
    held: Held
    nu: list[float]
    motion: Motion


def prepared(case: Case, number: Callable[[float], float]) -> Prepared:
    """`number` rounds to the core's scalar type."""
    scene = read_scene(case.scene)
    scene = strengthened(scene, case.strength, (), scene.run.duration_s) if case.driven else free(scene)
    table = rounded({key: value for key, value in scene.vehicle.items() if key != "support"}, number)
    model = exact_model(numbers_of(table))
    held = {name: [0.0] * (len(table["wheel"]) if name in ("voltage_V", "axle_torque_Nm") else 2) for name in INPUTS}
    held["body_moment_Nm"] = [0.0]
    near = allowed(model, case)
    if case.driven:
        held["voltage_V"] = [number(x) for x in voltages(model, scene, near)]
    place, heading = complex(number(PLACE.real), number(PLACE.imag)), number(HEADING_RAD)
    if not case.steady:
        nu = [number(float(x)) for x in near]
        return Prepared(case, table, held, nu, periodic_motion(model, held, nu, place, heading))
    if not case.driven:
        near = [number(float(x)) for x in near]
    motion = steady_motion(model, held, near, place, heading)
    return Prepared(case, table, held, [number(float(x)) for x in motion.nu], motion)


def rounded(value: Any, number: Callable[[float], float]) -> Any:
    """A table with its numbers in the core's scalar type."""
    if isinstance(value, dict):
        return {key: rounded(each, number) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(each, number) for each in value]
    return number(value) if isinstance(value, float) else value


def allowed(model: ExactModel, case: Case) -> list[Any]:
    """The case's ν as far as the constraints allow it; for a free spin the multiple of w that turns as fast."""
    if case.steady and not case.driven and case.nu[2]:
        along = model.nu(model.gyro)
        return [x * mpf(case.nu[2]) / along[2] for x in along]
    return model.nu(model.zeta([mpf(x) for x in case.nu]))


def voltages(model: ExactModel, scene: Scene, nu: list[Any]) -> np.ndarray:
    """Those that balance the motors' damping at this ν."""
    zeta = model.zeta(nu)
    speeds = np.array([float(sum(x * y for x, y in zip(row, zeta, strict=True))) for row in model.wheel_rows])
    damping = scene.vehicle["motor_damping_Nms"] / scene.vehicle["motor_gain_Nm_per_V"]
    return speeds * damping


def digits() -> Any:
    """Within which all of this is computed."""
    return mp.workdps(60)


def total(part: Any) -> Any:
    """A compensated sum's value and rest."""
    return mpf(float(part.value)) + mpf(float(part.rest))


def heading_of(state: Any, real: str) -> Any:
    """Turns, their fraction, and what is left of a unit."""
    unit = mpf(2) ** -TURN_BITS[real]
    return (mpf(int(state.heading.turns)) + int(state.heading.fraction) * unit
            + 2 * unit * mpf(float(state.heading.rest))) * 2 * mp.pi


def row_of(prepared: Prepared, state: Any, real: str, steps: int, step_s: float) -> Row:
    """Errors after so many steps. `aside_m`: of the place, less what the heading's own error brings, which moves it
    along the path."""
    truth, model = prepared.motion.at(steps * Fraction(step_s)), prepared.motion.model
    late = heading_of(state, real) - truth.heading
    off = mp.mpc(total(state.x_m), total(state.y_m)) - truth.place
    turned = truth.heading - prepared.motion.heading
    yaw_rate, path = truth.nu[2] / model.yaw_scale, max(truth.path, mpf(1))
    speed = model.radius * mp.sqrt(sum(x**2 for x in truth.nu))  # of which ν is rounded, whatever the place does
    aside = off
    if abs(turned) > 1:
        aside = off - velocity_of(model, truth.nu) * mp.expj(truth.heading) * late / yaw_rate
    return {"case": prepared.case.name, "steps": steps, "heading_error_rad": float(late),
            "heading_relative": float(abs(late) / max(abs(turned), mpf(1))), "place_error_m": float(abs(off)),
            "place_relative": float(abs(off) / path), "aside_m": float(abs(aside)),
            "reach_m": float(max(speed * steps * mpf(step_s), mpf(1))), "path_m": float(truth.path),
            "turns": float(turned / (2 * mp.pi))}


def run_drift(clock: Clock, seed: int) -> list[str]:
    """Pieces of all runs until the time is over; nothing is drawn."""
    runs = [Run(method, real) for real in NUMBERS for method in METHODS]
    while runs[0].done == 0 or clock:
        for each in runs:
            each.run(LEAST_STEPS if each.done == 0 else PIECE)
    wrong = []
    for each in runs:
        for row in each.rows():
            print(f"  {row['case']}, {each.method}, {each.real}: {row['steps']:.0e} steps, {row['turns']:.3g} turns, "
                  f"heading off by {row['heading_error_rad']:.1e} rad, place by {row['place_error_m']:.1e} m, of that "
                  f"not along the path {row['aside_m']:.1e} m")
            wrong += [f"{row['case']}, {each.method}, {each.real}: {row}"] if drifted(row, each.real) else []
    return wrong


def drifted(row: Row, real: str) -> bool:
    """Whether heading or place is further off than so many roundings of the heading, and of how far ν would lead."""
    unit = float(np.finfo(np.float64 if real == "double" else np.float32).eps) / 2
    is_steady = next(case.steady for case in CASES if case.name == row["case"])
    allowed = (LARGEST_ULP + (0.0 if is_steady else FREE_ULP + MOVED_ULP * row["steps"])) * unit
    is_near = row["heading_relative"] <= allowed and row["place_error_m"] <= allowed * row["reach_m"] + STANDING_M
    return bool(row["status"]) or not is_near


class Run:
    """All motions by one method in one scalar type, but those whose step the method refuses."""

    def __init__(self, method: str, real: str):
        self.method, self.real, self.step_s, self.done = method, real, NUMBERS[real](STEP_S), 0
        with digits():
            made = [prepared(case, NUMBERS[real]) for case in CASES]
        taken = [(each, vehicle) for each in made if takes(vehicle := Vehicle(each.table, real), method, self.step_s)]
        self.cases = [each for each, _ in taken]
        self.batch = Batch([vehicle for _, vehicle in taken], None, method, self.step_s)
        for lane, each in enumerate(self.cases):
            self.batch.start(lane, nu_rad_per_s=each.nu, x_m=PLACE.real, y_m=PLACE.imag, heading_rad=HEADING_RAD)
            volts = each.held["voltage_V"]
            self.batch.voltage_V[: len(volts), lane] = volts

    def run(self, steps: int) -> None:
        """So many more."""
        self.batch.run(steps)
        self.done += steps

    def rows(self) -> list[Row]:
        """How far each motion is from its closed form now."""
        with digits():
            return [row_of(each, self.batch.state(lane), self.real, self.done, self.step_s)
                    | {"status": int(self.batch.status[lane])} for lane, each in enumerate(self.cases)]


def takes(vehicle: Vehicle, method: str, step_s: float) -> bool:
    """Whether the method takes this step: explicit ones end where damping is fast."""
    try:
        vehicle.plant(method, step_s)
    except Refused:
        return False
    return True
