"""Columns that begin again: counters of so many values, angles within one turn. By `wrap` of the map they become
continuous; without it a jump of half the range is one line, as it would be read as a backward turn."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from laconic.errors import BadInput
from laconic.robot.logs.units import TICK

TURNS = {"rad": 2.0 * np.pi, "deg": 360.0, "turn": 1.0}
COUNTERS = tuple(float(1 << bits) for bits in (*range(8, 25), 32))
TOLERANCE = 2e-3        # of a turn: angles are written with few decimals
UNCERTAIN = 0.45        # of the wrap, from one sample to the next: the direction may be the other one
MANY = 20.0             # times the usual step: a jump, in a column whose unit is not known
SEVERAL = 4.0           # times the usual step: a jump there, too, where it comes again by the same size
REMEDY = "record more often, or count with a larger wrap"
LONG = 2.5              # times the usual time between values: there are blank rows between them
SMALL = 4.0             # steps around a jump that a counter's size may be off by

Place = Callable[[int], str]
"""Names a sample by its index."""


def modulus_of(wrap: float | bool | None, turn: float, scale: float) -> float | None:
    """Where a column begins again, in its own numbers; None: never, or not said. `turn`: one turn in them."""
    if wrap is True:
        return turn / abs(scale)
    return None if wrap is None or wrap is False else float(wrap)


def said_of(wrap: float | bool | None, modulus: float) -> str:
    """The wrap as the map has it, with its number."""
    return f"wrap = true ({modulus:.9g})" if wrap is True else f"wrap = {modulus:.9g}"


def continuous(path: Path, name: str, values: np.ndarray, modulus: float, unit: str, place: Place,
               said: str) -> tuple[np.ndarray, str | None]:
    """(a column without its jumps, a remark where its direction is uncertain); BadInput beyond the modulus."""
    least, most = int(np.argmin(values)), int(np.argmax(values))
    span = float(values[most] - values[least])
    if span > modulus * (1.0 + TOLERANCE) or (unit == TICK and span >= modulus):
        raise BadInput(f"{path}: {name} goes from {values[least]:.9g} ({place(least)}) to {values[most]:.9g} "
                       f"({place(most)}), more than {said} lets it; correct wrap in the map")
    steps = folded(np.diff(values), modulus)
    return values[:1] + np.concatenate([[0.0], np.cumsum(steps)]), doubt_of(name, steps, modulus, place, said)


def folded(steps: np.ndarray, modulus: float) -> np.ndarray:
    """The shorter way around for each step."""
    found: np.ndarray = np.remainder(steps + 0.5 * modulus, modulus) - 0.5 * modulus
    return found


def doubt_of(name: str, steps: np.ndarray, modulus: float, place: Place, said: str) -> str | None:
    """A remark on steps of about half the range, and on neighbours that differ by more than it: they may be turns the
    other way around. `steps`: folded, from each sample to the next."""
    size, change = np.abs(steps), np.abs(np.diff(steps))
    if len(size) and size.max() >= UNCERTAIN * modulus:
        worst = int(np.argmax(size))
        return (f"{name} changes by {100.0 * size[worst] / modulus:.0f} % of {said} until {place(worst + 1)}, so its "
                f"direction is uncertain; {REMEDY}")
    if len(change) and change.max() > 0.5 * modulus:
        worst = int(np.argmax(change))
        before, after = (100.0 * each / modulus for each in steps[worst:worst + 2])
        return (f"{name} changes by {before:.0f} % of {said} until {place(worst + 1)} and by {after:.0f} % until "
                f"{place(worst + 2)}, which may be {after + np.copysign(100.0, before):.0f} %, so its direction is "
                f"uncertain; {REMEDY}")
    return None


def hidden_wraps(name: str, values: np.ndarray, unwrapped: np.ndarray, time_s: np.ndarray, place: Place,
                 wrap: tuple[float, str]) -> str | None:
    """A remark where a column begins again between two values that are far apart in time, with nothing between: how far
    it turned there is taken as the shorter way. `wrap`: its modulus, and as the map has it."""
    modulus, said = wrap
    apart_s = np.diff(time_s)
    hidden = np.flatnonzero((np.abs(np.diff(values)) > 0.5 * modulus) & (apart_s > LONG * np.median(apart_s))) if len(
        apart_s) else np.zeros(0, int)
    if not len(hidden):
        return None
    first, more = int(hidden[0]), f", and so {len(hidden) - 1} times more" if len(hidden) > 1 else ""
    speed = (unwrapped[first] - unwrapped[first - 1]) / apart_s[first - 1] if first else 0.0
    share = abs(float(speed * apart_s[first])) / modulus
    doubt = (f"; at its speed before it would turn by {100.0 * share:.0f} % of that, so whole ranges may be missing"
             if share > UNCERTAIN else "")
    return (f"{name} begins again ({said}) where nothing is recorded, between {place(first)} and {place(first + 1)}"
            f"{more}; the rows between are interpolated along the shorter way{doubt}")


def refuse_jumps(path: Path, name: str, values: np.ndarray, turn: float, place: Place) -> None:
    """BadInput for a column that jumps back by half of its range or more; `turn`: one turn in its own numbers."""
    steps = np.diff(values)
    jump = _jump(steps, float(np.ptp(values)) if len(values) else 0.0, turn)
    if jump is None:
        return
    guess = _size(steps, jump, values, turn)
    remedy = f"wrap = {guess:.9g}" if guess else "wrap, the number at which it begins again,"
    raise BadInput(f"{path}: {place(jump + 1)}: {name} jumps from {values[jump]:.9g} to {values[jump + 1]:.9g}, half "
                   f"of its range or more; give {remedy} under [wheel_angle] in the map if it begins again there, else "
                   "wrap = false")


def wrap_of(values: np.ndarray, unit: str) -> float | None:
    """Where a column probably begins again; None where it never jumps, or by no usual size."""
    turn = TURNS.get(unit, np.inf)
    steps = np.diff(values)
    jump = _jump(steps, float(np.ptp(values)) if len(values) else 0.0, turn)
    return None if jump is None else _size(steps, jump, values, turn)


def _jump(steps: np.ndarray, span: float, turn: float) -> int | None:
    """The first step that no wheel takes: half the range or more, against the steps around it."""
    moving = np.flatnonzero(steps)
    if len(moving) < 2 or not span > 0.0:
        return None
    usual = float(np.median(np.abs(steps[moving])))
    least, found = min(0.5 * turn, SEVERAL * usual), list[int]()
    for number, index in enumerate(moving):
        if abs(steps[index]) < max(0.5 * span, least):
            continue
        around = [steps[moving[other]] for other in (number - 1, number + 1) if 0 <= other < len(moving)]
        if all(np.sign(each) == -np.sign(steps[index]) for each in around):
            found.append(int(index))
    sizes = np.abs(steps[found])
    if len(found) and (sizes[0] >= min(0.5 * turn, MANY * usual) or (len(found) > 1 and np.ptp(sizes) <= 2.0 * usual)):
        return found[0]
    return None


def _size(steps: np.ndarray, jump: int, values: np.ndarray, turn: float) -> float | None:
    """The usual size of a counter or angle that explains a jump; None where none does."""
    others = np.delete(np.abs(steps), jump)
    near = SMALL * float(np.median(others[others > 0.0])) if (others > 0.0).any() else 0.0
    span, size = float(np.ptp(values)), abs(float(steps[jump]))
    for each in sorted({*TURNS.values(), *COUNTERS} | ({turn} if np.isfinite(turn) else set())):
        if span <= each * (1.0 + TOLERANCE) and abs(each - size) <= max(near, TOLERANCE * each):
            return each
    return None
