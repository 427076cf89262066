"""Where a vehicle is after any time, in 60 digits, in three kinds of motion: at rest or steady (a line, a circle), and
free, where ζ turns about w with a period, so that the place moves by the same turn and shift in each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Protocol

from flint import arb, ctx
from mpmath import mp, mpf

from laconic.errors import ResultFails
from laconic.population.collocation import DIGITS, exact, true_states
from laconic.population.nodes import BITS
from laconic.verification.derivatives.exact_model import ExactModel, Vector, cross, dot
from laconic.verification.derivatives.exact_steps import forcing_of, rate

STEADY = mpf("1e-40")
Held = dict[str, list[float]]


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
