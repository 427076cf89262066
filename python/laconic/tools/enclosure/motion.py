"""The motion step by step: exact middles, and radii that hold the true motion.

The middle of ζ after a step is the polynomial's end, rounded; the radius in the energy norm grows by e^∫μ and takes in
defect and rounding. ∫ζ dt carries heading and wheel angles, which are linear in it; the place is an integral beside.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from flint import arb, arb_poly

from laconic.errors import ResultFails
from laconic.tools.enclosure.balls import (
    Vector,
    ball,
    combined,
    dot,
    larger,
    largest,
    length,
    radius_of,
    smaller,
    thin,
    times,
    upper,
    widened,
)
from laconic.tools.enclosure.defect import Defects, Growth, Step, defects_of, growth_of
from laconic.tools.enclosure.equation import Equation, Forcing, Stretch, forcing_of
from laconic.tools.enclosure.flow import Frame, carried, flow_of
from laconic.tools.enclosure.series import Rates, Series, Start, serves, slow_motion, step_for, taylor
from laconic.tools.enclosure.state import Beginning, Radii, Sample, State, Taken, radii_of

FADED = 0.75       # of the precision's bits, in powers of e, after which a damped part counts as died away
PAUSE_STEPS = 6    # between two tries of the slow motion
UNITS = 12         # of time that are tried for the slow motion, each a quarter of the last
LOST_BITS = 8
STIFF = 8.0        # decay times step, from which on a step is not followed direction by direction
MOST_STEPS = 10**6


@dataclass
class Motion:
    """A motion being enclosed; `goal_bits` is the precision of the middles, relative to the largest ζ so far.

    Once the radius of ζ has grown by LOST_BITS, `by_direction` is set: each further step also follows the error along
    axes of its own (laconic.tools.enclosure.flow), at twice the cost.
    """

    equation: Equation
    beginning: Beginning
    goal_bits: int
    by_direction: bool = False
    scale: arb = field(default_factory=lambda: arb(0))
    steps_taken: int = 0

    @property
    def order(self) -> int:
        """Of the polynomials: about the cheapest for this precision."""
        return 10 + int(0.35 * self.goal_bits)

    @property
    def tolerance(self) -> arb:
        """Of a step's last terms."""
        return arb(2) ** -self.goal_bits

    def start(self) -> State:
        """The state at time 0: the middles of the balls that it begins with."""
        zeta, place = self.beginning.zeta, self.beginning.place_m
        self.scale = length(zeta)
        return State(Fraction(0), thin(zeta), [arb(0)] * 3, thin(place), radius_of(zeta), arb(0), radius_of(place))

    def heading(self, travelled: Vector, radius: arb) -> arb:
        """θ = θ0 + (g/Λ)·∫ζ dt."""
        middle = self.beginning.heading_rad + dot(self.equation.yaw_rate_of_zeta, travelled)
        return widened(middle, radius * length(self.equation.yaw_rate_of_zeta))

    def sample(self, time_s: Fraction, zeta: Vector, travelled: Vector, place: Vector,
               radii: tuple[arb, arb, arb]) -> Sample:
        """The balls that users see, of middles and radii."""
        of_zeta, of_travelled, of_place = radii
        nu = [widened(x, of_zeta * length(row)) for x, row in
              zip(times(self.equation.nu_of_zeta, zeta), self.equation.nu_of_zeta, strict=True)]
        wheels = [widened(dot(row, travelled), of_travelled * length(row)) for row in self.equation.wheel_of_zeta]
        return Sample(time_s, [widened(x, of_zeta) for x in zeta], nu, [widened(x, of_place) for x in place],
                      self.heading(travelled, of_travelled), wheels)

    def samples(self, stretches: Sequence[Stretch], instants_s: Sequence[Fraction],
                moved: Callable[[float], None] = lambda _: None) -> Iterator[Sample]:
        """The enclosure at some instants, ascending, from 0 to the last stretch's end; `moved` hears of seconds."""
        state, left = self.start(), list(reversed(instants_s))
        if left and left[-1] == 0:
            left.pop()
            yield self.sample_of(state)
        for stretch in stretches:
            for taken in self.stretch_steps(state, stretch):
                state = taken.end
                while left and left[-1] <= state.time_s:
                    yield self.sample_within(taken, left.pop())
                moved(float(state.time_s - taken.begin.time_s))

    def sample_of(self, state: State) -> Sample:
        return self.sample(state.time_s, state.zeta, state.travelled, state.place_m,
                           (state.zeta_radius, state.travelled_radius, state.place_radius))

    def sample_within(self, taken: Taken, time_s: Fraction) -> Sample:
        """At an instant of a step; at its end by the end's own, smaller radii."""
        if time_s == taken.end.time_s:
            return self.sample_of(taken.end)
        part = ball((time_s - taken.begin.time_s) / (taken.end.time_s - taken.begin.time_s))
        return self.sample(time_s, [p(part) for p in taken.step.zeta], [p(part) for p in taken.travelled],
                           [p(part) for p in taken.place],
                           (taken.zeta_radius, taken.travelled_radius, taken.place_radius))

    def stretch_steps(self, state: State, stretch: Stretch) -> Iterator[Taken]:
        """Steps through a stretch of held inputs, as long as the precision allows."""
        forcing = forcing_of(self.equation, stretch.values)
        rates, is_slow, resting = Rates.of(self.equation, forcing), False, 0
        while state.time_s < stretch.end_s:
            left_s = stretch.end_s - state.time_s
            begin = self.step_start(state)
            self.scale = larger(self.scale, length(rates.forcing.constant) * min(1.0, float(left_s)))
            faded = self.faded(rates, float(state.time_s - stretch.begin_s), float(left_s))
            slow, slow_s = self.slow(rates, begin, faded, float(left_s)) if is_slow else (None, 0.0)
            if slow is None:
                series = taylor(rates, begin, self.order)
                length_s = step_for(series, self.scale, self.tolerance, float(left_s))
                if resting == 0 and self.limits(rates, faded, length_s):
                    slow, slow_s = self.slow(rates, begin, faded, float(left_s))
                    resting = 0 if slow else PAUSE_STEPS
            is_slow = slow is not None and (is_slow or slow_s > 2.0 * length_s)
            if slow is not None and is_slow:
                series, length_s = slow, slow_s
            resting = max(0, resting - 1)
            taken = self.take(state, series, forcing, rounded(length_s, left_s))
            state = taken.end
            yield taken

    def step_start(self, state: State) -> Start:
        """Middles of ζ and of the heading's direction."""
        sine, cosine = self.heading(state.travelled, arb(0)).sin_cos()
        return Start(state.zeta, cosine.mid(), sine.mid())

    def faded(self, rates: Rates, since_s: float, left_s: float) -> tuple[int, ...]:
        """Components whose fast decay is over, the fastest first."""
        decays = [float(x) for x in rates.decay]
        found = (j for j, r in enumerate(decays) if r * since_s > FADED * self.goal_bits and r * left_s > self.order)
        return tuple(sorted(found, key=lambda j: -decays[j]))

    def limits(self, rates: Rates, faded: tuple[int, ...], length_s: float) -> bool:
        """Whether Taylor's step is as short as it is because of what has faded."""
        return bool(faded) and float(rates.decay[faded[0]]) * length_s > 1.0

    def slow(self, rates: Rates, begin: Start, faded: tuple[int, ...], left_s: float) -> tuple[Series | None, float]:
        """The slow motion's series if the motion is on it to the precision, and the time that it serves; with as many
        of the faded components as are fast beside that time."""
        for count in range(len(faded), 0, -1):
            fast = frozenset(faded[:count])
            series, length_s = self.slow_of(rates, begin, fast, left_s)
            if series is not None and float(rates.decay[faded[count - 1]]) * length_s > self.order / 2.0:
                return series, length_s
        return None, 0.0

    def slow_of(self, rates: Rates, begin: Start, fast: frozenset[int], left_s: float) -> tuple[Series | None, float]:
        """The same for one choice of components."""
        unit_s = left_s
        for _ in range(UNITS):
            series = slow_motion(rates, begin, self.order, fast, arb(unit_s), self.scale)
            if series is not None:
                off = length([series.zeta[j][0] - begin.zeta[j] for j in fast])
                near = off <= self.scale * self.tolerance * 1024
                serves_s = serves(series, unit_s, left_s)
                return (series if near else None), step_for(series, self.scale, self.tolerance, serves_s)
            unit_s /= 4.0
        return None, 0.0

    def take(self, state: State, series: Series, forcing: Forcing, step_s: Fraction) -> Taken:
        """One step with its proof."""
        step = Step.of(series, ball(step_s))
        defects, growth = defects_of(step, self.equation, forcing), growth_of(step, self.equation)
        jump = length([p(arb(0)) - x for p, x in zip(step.zeta, state.zeta, strict=True)])
        direction = self.direction_error(state, step, defects)
        bounds = radii_of(state, step, growth, defects, jump, direction, self.equation, forcing)
        travelled = [p.integral() * step.length_s + x for p, x in zip(step.zeta, state.travelled, strict=True)]
        place, place_radius = self.place(state, step, bounds, direction)
        ends = [[p(arb(1)) for p in each] for each in (step.zeta, travelled, place)]
        radii = [upper(radius + radius_of(each)) for radius, each in
                 zip((bounds.zeta_at_end, bounds.travelled, place_radius), ends, strict=True)]
        frame = None
        if self.by_direction:
            frame = self.frame(state, step, growth, bounds, radius_of(ends[0]) + bounds.pushed)
            radii[0] = smaller(radii[0], frame.radius())
        end = State(state.time_s + step_s, thin(ends[0]), thin(ends[1]), thin(ends[2]), radii[0], radii[1], radii[2],
                    frame)
        self.scale = larger(self.scale, length([largest(p) for p in step.zeta]))
        self.steps_taken += 1
        self.by_direction |= bool(end.zeta_radius > self.scale * self.tolerance * 2**LOST_BITS)
        if not (end.zeta_radius.is_finite() and end.place_radius.is_finite()) or self.steps_taken > MOST_STEPS:
            raise ResultFails(f"the enclosure ends at t = {float(state.time_s):g} s: it is no longer finite there, or "
                              "needs too many steps; run it over a shorter time")
        return Taken(state, step, travelled, place, bounds.zeta, bounds.travelled, place_radius, end)

    def frame(self, state: State, step: Step, growth: Growth, bounds: Radii, added: arb) -> Frame:
        """The box of the error at the step's end; that around the ball where the step is too stiff to follow it."""
        stiffest = max(float(self.equation.damping[j][j].mid()) for j in range(3)) * float(step.length_s)
        before = state.frame or Frame.around(state.zeta_radius, self.equation.freedoms)
        square = step.length_s * length(self.equation.spin) * length(self.equation.gyro) * bounds.zeta**2
        found = None
        if stiffest < STIFF:
            flow = flow_of(step, self.equation, growth)
            found = carried(before, flow, state.zeta_radius, upper(added + growth.at_most * square))
        return found or Frame.around(upper(bounds.zeta_at_end + added), self.equation.freedoms)

    def direction_error(self, state: State, step: Step, defects: Defects) -> arb:
        """How far (cos, sin) of the polynomials is from that of the middle heading, all along the step."""
        sine, cosine = self.heading(state.travelled, arb(0)).sin_cos()
        return upper(length([step.cosine(arb(0)) - cosine, step.sine(arb(0)) - sine]) + defects.direction)

    def place(self, state: State, step: Step, bounds: Radii, direction: arb) -> tuple[list[arb_poly], arb]:
        """x and y along the step, and the radius of both together."""
        along, across = (combined(row, step.zeta) for row in self.equation.velocity_of_zeta)
        rates = (along * step.cosine - across * step.sine, along * step.sine + across * step.cosine)
        place = [p.integral() * step.length_s + x for p, x in zip(rates, state.place_m, strict=True)]
        speed = length([largest(along), largest(across)])
        rows = length([length(row) for row in self.equation.velocity_of_zeta])
        turned = direction + bounds.travelled * length(self.equation.yaw_rate_of_zeta)
        return place, upper(state.place_radius + step.length_s * (rows * bounds.zeta + speed * turned))


def rounded(length_s: float, left_s: Fraction) -> Fraction:
    """The step's length with few bits, or all that is left."""
    if length_s >= float(left_s):
        return left_s
    mantissa, exponent = math.frexp(length_s)
    return min(left_s, Fraction(int(mantissa * 2**20)) * Fraction(2) ** (exponent - 20))
