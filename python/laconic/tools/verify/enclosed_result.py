"""Results of `laconic verify --enclose`: errors that are proved bounds, with the enclosure's width beside them."""

from __future__ import annotations

from dataclasses import dataclass

from laconic.tools.verify.trajectories import CaseResult

ROUNDED_UP = 1.05  # so that the second digit is one higher


@dataclass(frozen=True)
class EnclosedResult(CaseResult):
    """One case; all numbers are bounds, relative to max(1, largest proved size of the kind).

    `inside`: the core's numbers lie inside the enclosure at all rows; `own_constants`: the same errors to the motion by
    the constants that the core prepared, where it was enclosed.
    """

    width_nu: float = 0.0
    width_pose: float = 0.0
    width_wheel: float = 0.0
    inside: bool = False
    own_constants: dict[str, float | bool | None] | None = None

    @property
    def width(self) -> float:
        """The largest of the three widths."""
        return max(self.width_nu, self.width_pose, self.width_wheel)


def bound_text(number: float) -> str:
    """A bound in two digits, not below what it is."""
    text = f"{number:.1e}"
    return text if float(text) >= number else f"{number * ROUNDED_UP:.1e}"
