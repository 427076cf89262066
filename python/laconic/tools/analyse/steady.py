"""All steady motions of a vehicle under constant inputs.

For a given n = ν3 a steady motion solves the linear system (diag(r) − n [·×w]) ζ = b; what remains is one scalar
equation, a polynomial of degree 3 in n:  n det(diag(r) − n [·×w]) = g·adj(diag(r) − n [·×w]) b.  So none is missed.
Where a direction has no damping, whole lines of steady motions exist; they are returned as families.

Straight motion under a force that is fixed in the world (the caster of the paper's section 3).

The vehicle speeds up for ever, so ν has no steady motion; but there are headings it can keep. For an undamped vehicle
without gyroscopic term (its axle line runs through the centre of mass) θ'' = g·b(θ)/Λ, with
b(θ) = constant + cosine cos θ + sine sin θ as the core prepares it: headings where g·b = 0, stable where it falls.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import polynomial as poly

from laconic.tools.analyse.field import Field
from laconic.tools.analyse.from_core import Subject

MARGIN = 1e-9  # real parts closer to zero than this fraction of the fastest rate count as neither
TURNS = 1e-7   # a slower yaw, as a share of the fastest rate, is none: a double root at 0 is found no more exactly


@dataclass(frozen=True)
class SteadyMotion:
    """ν is constant: straight on when ν3 = 0, else along a circle."""

    zeta: np.ndarray
    nu: np.ndarray
    eigenvalues: np.ndarray
    stability: str             # "stable", "unstable", "neutral"

    @property
    def is_turning(self) -> bool:
        """Whether the vehicle yaws."""
        return bool(abs(self.nu[2]) > TURNS * max(1.0, float(np.abs(self.nu).max())))


@dataclass(frozen=True)
class Family:
    """A line or plane of steady motions: nu + span(directions)."""

    nu: np.ndarray
    directions: np.ndarray     # one row each
    words: str


def steady_polynomial(field: Field) -> np.ndarray:
    """Coefficients of n det(n) − g·adj(n) b, lowest first.

    With D = diag(r): det = det D + n² w·Dw and adj = adj D − n [Dw ×] + n² w wᵀ. Components of ζ that do not exist
    get r = 1, which leaves both as they are for the others.
    """
    r, w = field.decay_per_s.copy(), field.gyro
    r[field.dof :] = 1.0
    g, b = field.yaw_row, field.forcing
    others = np.array([r[1] * r[2], r[2] * r[0], r[0] * r[1]])
    return np.array([
        -float(g @ (others * b)),
        r[0] * others[0] + float(g @ _crossed(r * w, b)),
        -float((g @ w) * (w @ b)),
        float(w @ (r * w)),
    ])


def _crossed(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Returns the cross product; np.cross spends most of its time on the axes of its arrays."""
    (a, b, c), (x, y, z) = first.tolist(), second.tolist()
    return np.array([b * z - c * y, c * x - a * z, a * y - b * x])


def classify(field: Field, zeta: np.ndarray) -> SteadyMotion:
    """Eigenvalues and stability of one steady motion."""
    eigenvalues = np.linalg.eigvals(field.jacobian(zeta))
    eigenvalues = eigenvalues[np.lexsort((eigenvalues.imag, -eigenvalues.real))]
    edge = MARGIN * max(float(np.abs(eigenvalues).max()), float(field.decay_per_s.max()), 1e-300)
    worst = eigenvalues.real.max()
    stability = "stable" if worst < -edge else "unstable" if worst > edge else "neutral"
    return SteadyMotion(zeta=zeta, nu=field.nu(zeta), eigenvalues=eigenvalues, stability=stability)


def steady_at_yaw(field: Field, n: float) -> np.ndarray | None:
    """ζ of the steady motion with ν3 = n; None where the linear system does not determine it."""
    m = field.dof
    matrix = np.diag(field.decay_per_s[:m]) - n * field.cross_matrix
    if not np.linalg.cond(matrix) < 1e11:
        return None
    return np.linalg.solve(matrix, field.forcing[:m])


def _polished(field: Field, zeta: np.ndarray) -> np.ndarray | None:
    """Newton from a good guess; None when it does not settle."""
    scale = max(1.0, float(np.abs(zeta).max()))
    for _ in range(20):
        try:
            step = np.linalg.solve(field.jacobian(zeta), field.rates(zeta))
        except np.linalg.LinAlgError:
            return zeta if np.abs(field.rates(zeta)).max() < 1e-12 * scale else None
        zeta = zeta - step
        if np.abs(step).max() < 1e-14 * scale:
            break
    size = np.abs(field.forcing).max() + np.abs(field.decay_per_s).max() * scale + np.abs(field.gyro).max() * scale**2
    return zeta if np.abs(field.rates(zeta)).max() <= 1e-10 * max(size, 1e-300) else None


def steady_motions(field: Field) -> list[SteadyMotion]:
    """All isolated steady motions, by ascending ν3."""
    coefficients = steady_polynomial(field)
    largest = np.abs(coefficients).max()
    if largest == 0.0:
        return []
    coefficients = poly.polytrim(coefficients, 1e-14 * largest)
    roots = poly.polyroots(coefficients) if len(coefficients) > 1 else np.zeros(0)
    scale = max(1.0, float(np.abs(roots).max(initial=0.0)))
    found: list[SteadyMotion] = []
    for n in sorted(root.real for root in roots if abs(root.imag) < 1e-6 * scale):
        start = steady_at_yaw(field, n)
        zeta = None if start is None else _polished(field, start)
        near = 1e-7 * max(1.0, 0.0 if zeta is None else float(np.abs(zeta).max()))
        if zeta is not None and all(np.abs(zeta - other.zeta).max() > near for other in found):
            found.append(classify(field, zeta))
    return sorted(found, key=lambda motion: motion.nu[2])


def families(field: Field) -> list[Family]:
    """Whole lines and planes of steady motions, where damping lacks a direction."""
    m = field.dof
    decay, forcing, g = field.decay_per_s[:m], field.forcing[:m], field.yaw_row[:m]
    fastest = decay.max(initial=0.0)
    undamped = decay <= 1e-12 * fastest
    if not undamped.any():
        return []
    out = []
    if np.all(np.abs(forcing[undamped]) <= 1e-12 * max(np.abs(forcing).max(initial=0.0), 1e-300)):
        out += _straight_family(field, undamped, decay, forcing, g)
    if fastest == 0.0 and not forcing.any() and np.abs(field.gyro).max() > 0.0:
        axis = field.gyro[:m] if m == 3 else np.zeros(m)
        if m == 3 and abs(g @ axis) > 0.0:
            words = "turning on the spot, or along a circle, at any rate (the axis of the free motion)"
            out.append(Family(np.zeros(3), field.nu(axis / np.linalg.norm(axis))[None, :], words))
    return out


def _straight_family(field: Field, undamped: np.ndarray, decay: np.ndarray, forcing: np.ndarray,
                     g: np.ndarray) -> list[Family]:
    """Straight motions ν3 = 0: the damped components are fixed by the forcing, the others free but for g·ζ = 0."""
    base = np.where(undamped, 0.0, forcing / np.where(undamped, 1.0, decay))
    free = np.flatnonzero(undamped)
    pull = g[free]
    shift = -(g @ base)
    if np.abs(pull).max() <= 1e-14 * np.abs(g).max(initial=1e-300):
        if abs(shift) > 1e-12 * max(1.0, np.abs(base).max()):
            return []
        directions = np.eye(len(free))
    else:
        base = base.copy()
        base[free] += pull * shift / (pull @ pull)
        directions = np.linalg.svd(pull[None, :])[2][1:]
    if not len(directions):
        return []
    wide = np.zeros((len(directions), field.dof))
    wide[:, free] = directions
    shape = "line" if len(directions) == 1 else "plane"
    words = f"straight motion: a whole {shape} of steady motions, none of which returns to itself when pushed along it"
    return [Family(field.nu(base), field.nu(wide), words)]


@dataclass(frozen=True)
class PushedHeading:
    """A heading that the force lets the vehicle keep."""

    heading_rad: float
    rate_squared_per_s2: float  # s² of the small motions about it
    stable: bool

    @property
    def words(self) -> str:
        """For the report."""
        size = np.sqrt(abs(self.rate_squared_per_s2))
        if self.stable:
            return f"heading {np.degrees(self.heading_rad):.1f}°: stable, swings about it at {size:.4g} rad/s"
        return f"heading {np.degrees(self.heading_rad):.1f}°: unstable, leaves it with {size:.4g} 1/s"


def world_force_acts(subject: Subject) -> bool:
    """Whether the held inputs contain a force fixed in the world."""
    return any(subject.inputs.get(f"world_force_N[{k}]", 0.0) for k in (1, 2))


def headings(subject: Subject) -> list[PushedHeading] | None:
    """The headings that can be kept; None where damping or a gyroscopic term makes the question another one."""
    core, model = subject.core, subject.model
    forcing = core.ffi.new("laconic_forcing *")
    core.lib.laconic_forcing_of(forcing, model, core.input(subject.inputs))
    damped = core.numbers(model.decay_per_s)[: model.dof].any()
    if damped or np.abs(core.numbers(model.gyro)).max() > 1e-12 or not forcing.rotates:
        return None
    yaw = core.numbers(model.nu_of_zeta, 3, 3)[2] / float(model.yaw_scale)
    parts = (forcing.constant, forcing.cosine, forcing.sine)
    constant, cosine, sine = (float(yaw @ core.numbers(part)) for part in parts)
    size = np.hypot(cosine, sine)
    if size <= 1e-300 or abs(constant) > size:
        return []
    phase, open_angle = np.arctan2(sine, cosine), np.arccos(-constant / size)
    found = []
    for heading in (phase - open_angle, phase + open_angle):
        slope = -cosine * np.sin(heading) + sine * np.cos(heading)
        wrapped = float(np.mod(heading + 1e-9, 2.0 * np.pi) - 1e-9)
        found.append(PushedHeading(wrapped, float(slope), bool(slope < 0.0)))
    return sorted(found, key=lambda f: f.heading_rad)
