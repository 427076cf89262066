"""Each method's map from state to state in 50 digits, written from docs/integrators.md: what a step does to
(ν, x, y, θ, χ) with the input held."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any

from mpmath import mp, mpf

from laconic.tools.verify.exact.exact_gauss import WHOLE, gauss_8
from laconic.tools.verify.exact.exact_model import ExactModel, Vector, added, cross, dot

MEAN_FORCE_ROUNDS = 3
STIFF = mpf("0.3")

Increment = tuple[Vector, Vector, Vector]  # of ζ, its mean, and 12/h² times its first moment about the middle
Forcing = Callable[[Any], Vector]          # b by the yaw since the step's start


def forcing_of(m: ExactModel, held: dict[str, Vector], heading: Any) -> Forcing:
    """b of an input that is held."""
    v_along, v_across = ([m.radius * x for x in m.nu_of_zeta[i]] for i in (0, 1))
    yaw = [x / m.yaw_scale for x in m.nu_of_zeta[2]]
    t = m.torque_scale
    constant = [mpf(0)] * 3
    for row, gain, volt, torque in zip(m.wheel_rows, m.gains, held["voltage_V"], held["axle_torque_Nm"], strict=True):
        constant = added(constant, t * (gain * volt + torque), row)
    for amount, row in zip([*held["body_force_N"], *held["body_moment_Nm"]], (v_along, v_across, yaw), strict=True):
        constant = added(constant, t * amount, row)

    def b(turned: Any) -> Vector:
        cosine, sine = mp.cos(heading + turned), mp.sin(heading + turned)
        out = list(constant)
        for force, point in ((held["world_force_N"], held["world_force_point_m"]), (m.slope_force, [0, 0])):
            along = cosine * force[0] + sine * force[1]
            across = cosine * force[1] - sine * force[0]
            moment = point[0] * across - point[1] * along
            for amount, row in ((along, v_along), (across, v_across), (moment, yaw)):
                out = added(out, t * amount, row)
        return out

    return b


def quadratic(m: ExactModel, a: Vector, b: Vector) -> Vector:
    """(g·a)(b × w)"""
    turned = cross(b, m.gyro)
    scale = dot(m.nu_of_zeta[2], a)
    return [scale * x for x in turned]


def rate(m: ExactModel, z: Vector, b: Vector) -> Vector:
    return [q - r * x + y for q, r, x, y in zip(quadratic(m, z, z), m.decay, z, b, strict=True)]


def yaw_of(m: ExactModel, path: Vector) -> Any:
    return dot(m.nu_of_zeta[2], path) / m.yaw_scale


# ---------------------------------------------------------------------------------------------- rk4


def rk4(m: ExactModel, h: Any, z: Vector, b: Forcing, varies: bool) -> Increment:
    k1 = rate(m, z, b(mpf(0)))
    z2 = added(z, h / 2, k1)
    k2 = rate(m, z2, b(yaw_of(m, z) * h / 2))
    z3 = added(z, h / 2, k2)
    k3 = rate(m, z3, b(yaw_of(m, z2) * h / 2))
    k4 = rate(m, added(z, h, k3), b(yaw_of(m, z3) * h))
    delta = [h / 6 * (p + 2 * q + 2 * r + s) for p, q, r, s in zip(k1, k2, k3, k4, strict=True)]
    mean = [x + h / 6 * (p + q + r) for x, p, q, r in zip(z, k1, k2, k3, strict=True)]
    return delta, mean, delta


# ------------------------------------------------------------------------------- exponential methods


@lru_cache(maxsize=4096)
def phi(a: Any) -> list[Any]:
    """φ0 … φ5 at −a."""
    if a < 2:
        return [sum(((-a) ** n / mp.factorial(n + k) for n in range(70)), mpf(0)) for k in range(6)]
    found = [mp.exp(-a)]
    for k in range(5):
        found.append((1 / mp.factorial(k) - found[k]) / a)
    return found


def linear_response(r: Any, h: Any, z: Any, delta: Any, change: Any) -> tuple[Any, Any]:
    """Mean and slope of an axis whose increment is delta while b changes linearly by `change`."""
    p = phi(h * r)
    constant = (delta - h * p[2] * change) / (h * p[1])  # the rate at the start that leads there
    mean = z + h * (p[2] * constant + p[3] * change)
    slope = 12 * h * ((p[2] / 2 - p[3]) * constant + (p[3] / 2 - p[4]) * change)
    return mean, slope


def increment_of(m: ExactModel, h: Any, z: Vector, delta: Vector, change: Vector) -> Increment:
    both = [linear_response(*axis) for axis in zip(m.decay, [h] * 3, z, delta, change, strict=True)]
    return delta, [mean for mean, _ in both], [slope for _, slope in both]


def equivalent(m: ExactModel, h: Any, start: Vector, change: Vector) -> Vector:
    """The constant b that leads to the same end."""
    ratios = [phi(h * r)[2] / phi(h * r)[1] for r in m.decay]
    return [s + k * c for s, k, c in zip(start, ratios, change, strict=True)]


def kahan(stiff: bool) -> Callable[..., Increment]:
    """Exponential Kahan; with fast damping the gyroscopic term is taken to vary linearly over the step."""

    def base(m: ExactModel, h: Any, z: Vector, start: Vector, change: Vector) -> Increment:
        unit = [[mpf(i == k) for i in range(3)] for k in range(3)]
        columns = [[(a + b) / 2 for a, b in zip(quadratic(m, z, e), quadratic(m, e, z), strict=True)] for e in unit]
        gain = [h * phi(h * r)[1] for r in m.decay]
        matrix = mp.matrix(3)
        for i in range(3):
            for k in range(3):
                matrix[i, k] = (1 / gain[i] if i == k else 0) - columns[k][i]
        delta = list(mp.lu_solve(matrix, mp.matrix(rate(m, z, equivalent(m, h, start, change)))))
        if not stiff:
            return increment_of(m, h, z, delta, change)
        end = added(z, 1, delta)
        varied = added(quadratic(m, end, end), -1, quadratic(m, z, z))
        beyond = [(phi(h * r)[2] / phi(h * r)[1] - mpf(1) / 2) * x for r, x in zip(m.decay, varied, strict=True)]
        longer = added(delta, 1, list(mp.lu_solve(matrix, mp.matrix(beyond))))
        return increment_of(m, h, z, longer, added(change, 1, varied))

    return base


def free_motion(m: ExactModel, h: Any, z: Vector) -> Vector:
    """The exact free motion: ζ turns about w."""
    g, w = m.nu_of_zeta[2], m.gyro
    square = dot(w, w)
    along, across = h / 2 * dot(g, z), h / 2 * dot(g, cross(z, w))
    curve = h / 2 * (2 * dot(g, w) * dot(w, z) - square * dot(g, z))
    y = along * curve - across**2
    root = mp.sqrt(abs(y))
    if y == 0:
        s, c = mpf(1), mpf(1)
    else:
        s, c = (mp.sin(root) / root, mp.cos(root)) if y > 0 else (mp.sinh(root) / root, mp.cosh(root))
    u = along * s / (c - across * s)  # tan(ψ/2)/|w|
    once = cross(z, w)
    twice = cross(once, w)
    return [x + 2 * u / (1 + square * u**2) * (p + u * q) for x, p, q in zip(z, once, twice, strict=True)]


def damped(m: ExactModel, h: Any, z: Vector, start: Vector, change: Vector) -> Vector:
    """Damping and forcing alone."""
    b = equivalent(m, h, start, change)
    return [x + h * phi(h * r)[1] * (y - r * x) for x, r, y in zip(z, m.decay, b, strict=True)]


def flow(m: ExactModel, h: Any, z: Vector, start: Vector, change: Vector) -> Increment:
    half = [x / 2 for x in change]
    end = damped(m, h / 2, z, start, half)
    end = damped(m, h / 2, free_motion(m, h, end), added(start, mpf(1) / 2, change), half)
    return increment_of(m, h, z, added(end, -1, z), change)


def substep(m: ExactModel, base: Callable[..., Increment], h: Any, z: Vector, yaw: Any, b: Forcing, varies: bool
            ) -> tuple[Increment, Any]:
    start, end = b(yaw), yaw + h * yaw_of(m, z)
    for _ in range(MEAN_FORCE_ROUNDS if varies else 1):
        by = base(m, h, z, start, added(b(end), -1, start) if varies else [mpf(0)] * 3)
        end = yaw + h * yaw_of(m, by[1])
    return by, end


def second_order(base: Callable[..., Increment]) -> Callable[..., Increment]:
    def step(m: ExactModel, h: Any, z: Vector, b: Forcing, varies: bool) -> Increment:
        return substep(m, base, h, z, mpf(0), b, varies)[0]

    return step


def extrapolated(base: Callable[..., Increment]) -> Callable[..., Increment]:
    def step(m: ExactModel, h: Any, z: Vector, b: Forcing, varies: bool) -> Increment:
        whole, _ = substep(m, base, h, z, mpf(0), b, varies)
        first, yaw = substep(m, base, h / 2, z, mpf(0), b, varies)
        second, _ = substep(m, base, h / 2, added(z, 1, first[0]), yaw, b, varies)
        delta = [(4 * (p + q) - w) / 3 for p, q, w in zip(first[0], second[0], whole[0], strict=True)]
        mean = [(2 * (p + q) - w) / 3 for p, q, w in zip(first[1], second[1], whole[1], strict=True)]
        slope = [mpf(3) / 2 * (q - p) + (r + s) / 4
                 for p, q, r, s in zip(first[1], second[1], first[2], second[2], strict=True)]
        return delta, mean, slope

    return step


# -------------------------------------------------------------------------------------------- pose


def chord(m: ExactModel, h: Any, by: Increment) -> tuple[Any, Any, Any]:
    """Displacement along and across the mid-step heading, and the yaw, from mean and first moment of ζ."""
    path, bend = [h * x for x in by[1]], [h * x for x in by[2]]
    yaw, yaw_bend = yaw_of(m, path), yaw_of(m, bend) / 12
    a = yaw / 2
    sinc = mp.sin(a) / a if a else mpf(1)
    j = (mp.sin(a) - a * mp.cos(a)) / (2 * a**2) if a else mpf(0)
    v, turned = [m.radius * mp.mpc(dot(m.nu_of_zeta[0], x), dot(m.nu_of_zeta[1], x)) for x in (path, bend)]
    moved = sinc * v + mp.mpc(0, 1) * (j * turned - yaw_bend * v)
    return moved.real, moved.imag, yaw


# ----------------------------------------------------------------------------------------- taylor-8

TAYLOR_ORDER = 8

def node_weights() -> list[tuple[Any, Any]]:
    """Gauss' four nodes on 0 … 1 with their weights, in the working precision."""
    inner, outer = (mp.sqrt(mpf(3) / 7 + sign * mpf(2) / 7 * mp.sqrt(mpf(6) / 5)) for sign in (-1, 1))
    light, heavy = ((18 - mp.sqrt(30)) / 72, (18 + mp.sqrt(30)) / 72)
    return [((1 + sign * root) / 2, weight) for root, weight in ((inner, heavy), (outer, light)) for sign in (-1, 1)]


def series(m: ExactModel, h: Any, z: Vector, world: Callable[[], tuple[Vector, Vector, Vector]]) -> list[Vector]:
    """Coefficients of sⁿ of ζ over the step."""
    constant, by_cosine, by_sine = world()
    terms, turn, cosine, sine = [z], [], [mpf(1)], [mpf(0)]
    for n in range(TAYLOR_ORDER):
        turn.append(h * yaw_of(m, terms[n]))
        sums = [mpf(0)] * 3 if n else list(constant)
        sums = added(added(sums, cosine[n], by_cosine), sine[n], by_sine)
        for j in range(n + 1):
            sums = added(sums, 1, quadratic(m, terms[j], terms[n - j]))
        sums = [s - r * x for s, r, x in zip(sums, m.decay, terms[n], strict=True)]
        terms.append([h / (n + 1) * x for x in sums])
        cosine.append(-sum((turn[j] * sine[n - j] for j in range(n + 1)), mpf(0)) / (n + 1))
        sine.append(sum((turn[j] * cosine[n - j] for j in range(n + 1)), mpf(0)) / (n + 1))
    return terms


def taylor_8(m: ExactModel, h: Any, z: Vector, b: Forcing, varies: bool) -> tuple[Increment, tuple[Any, Any, Any]]:
    """The increment, and the displacement by quadrature."""

    def parts() -> tuple[Vector, Vector, Vector]:
        ahead, aside, back = b(mpf(0)), b(mp.pi / 2), b(mp.pi)
        constant = [(p + q) / 2 for p, q in zip(ahead, back, strict=True)]
        return constant, added(ahead, -1, constant), added(aside, -1, constant)

    terms = series(m, h, z, parts)
    delta = [sum(terms[n][k] for n in range(1, TAYLOR_ORDER + 1)) for k in range(3)]
    mean = [sum(terms[n][k] / (n + 1) for n in range(TAYLOR_ORDER + 1)) for k in range(3)]
    yaw, moved = h * yaw_of(m, mean), mp.mpc(0)
    for node, weight in node_weights():
        at = [sum(terms[n][k] * node**n for n in range(TAYLOR_ORDER + 1)) for k in range(3)]
        sofar = [sum(terms[n][k] * node ** (n + 1) / (n + 1) for n in range(TAYLOR_ORDER + 1)) for k in range(3)]
        velocity = m.radius * mp.mpc(dot(m.nu_of_zeta[0], at), dot(m.nu_of_zeta[1], at))
        moved += h * weight * velocity * mp.expj(h * yaw_of(m, sofar) - yaw / 2)
    return (delta, mean, delta), (moved.real, moved.imag, yaw)


REIMPLEMENTED = ("rk4", "taylor-8", "exponential-kahan", "exponential-kahan-4", "exact-flow", "exact-flow-4",
                 "exponential-gauss-8")
METHODS: dict[str, Callable[[bool], Callable[..., Increment]]] = {
    "rk4": lambda stiff: rk4,
    "exponential-kahan": lambda stiff: second_order(kahan(stiff)),
    "exponential-kahan-4": lambda stiff: extrapolated(kahan(stiff)),
    "exact-flow": lambda stiff: second_order(flow),
    "exact-flow-4": lambda stiff: extrapolated(flow),
}


def exact_step(m: ExactModel, method: str, step_s: Any, state: Vector, held: dict[str, Vector], stiff: bool,
               panels: Sequence[Any] = WHOLE) -> Vector:
    """(ν, x, y, θ, χ) after a step. `stiff`, `panels`: as the core decides them for the given vehicle."""
    z, (x, y, heading), angles = m.zeta(state[:3]), state[3:6], state[6:]
    b = forcing_of(m, held, heading)
    varies = any(held["world_force_N"]) or any(m.slope_force)
    if method == "taylor-8":
        by, (along, across, yaw) = taylor_8(m, step_s, z, b, varies)
    elif method == "exponential-gauss-8":
        by, (along, across, yaw) = gauss_8(m, step_s, z, b, panels)
    else:
        by = METHODS[method](stiff)(m, step_s, z, b, varies)
        along, across, yaw = chord(m, step_s, by)
    moved = mp.mpc(along, across) * mp.expj(heading + yaw / 2)
    path = [step_s * value for value in by[1]]
    return [*m.nu(added(z, 1, by[0])), x + moved.real, y + moved.imag, heading + yaw,
            *(angle + dot(row, path) for angle, row in zip(angles, m.wheel_rows, strict=True))]
