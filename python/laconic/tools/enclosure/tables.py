"""What users see of an enclosure: a table and verdicts, columns for a CSV file, JSON."""

from __future__ import annotations

from typing import Any

import numpy as np

from laconic.tools.enclosure.study import KINDS, Enclosed, Kind, Study
from laconic.tools.verify.enclosed_result import bound_text

WORDS = {"nu": "ν", "pose": "pose", "wheel": "wheel angles"}


def verdict(kind: Kind) -> str:
    """Where the core's result is."""
    return "inside" if kind.inside else f"distance ≤ {bound_text(kind.error or 0.0)}"


def rows_of(study: Study) -> list[tuple[str, str, str, str]]:
    """A row of words for each kind: name, width, verdict, distance to the motion by the core's own constants."""
    return [(WORDS[of_file.name], bound_text(of_file.width), verdict(of_file), verdict(of_core))
            for of_file, of_core in zip(study.of_file.kinds(), study.of_core.kinds(), strict=True)
            if of_file.name != "wheel" or study.run.scene.wheel_count]


def lines_of(study: Study) -> list[str]:
    """For people, each line whole."""
    enclosed = study.of_file
    head = (f"enclosure: {len(enclosed.widths)} rows, {enclosed.steps} steps of {enclosed.bits} bits; relative to "
            "max(1, largest value):")
    table = [("", "width at most", "core, by the file's numbers", "core, by its own constants"), *rows_of(study)]
    return [head, *("  " + f"{name:13} {width:>14}  {by_file:28} {by_core}" for name, width, by_file, by_core in table)]


def columns_of(study: Study) -> dict[str, np.ndarray]:
    """Two columns for each state: a bound of the core's error and of the enclosure's width, in the state's unit."""
    assert study.of_file.errors is not None
    found = {}
    for k, name in enumerate(study.states):
        found[f"{name}_error"] = study.of_file.errors[:, k]
        found[f"{name}_width"] = study.of_file.widths[:, k]
    return found


def as_json(study: Study) -> dict[str, Any]:
    """The enclosure of a run, with the digits of its end."""
    shown = (*zip(study.states, study.of_file.end_digits, strict=True),
             *zip(("heading_cosine", "heading_sine"), study.of_file.end_direction, strict=True))
    end = {name: {"middle": digits, "radius": radius} for name, (digits, radius) in shown}
    return {"rows": len(study.of_file.widths), "steps": study.of_file.steps, "bits": study.of_file.bits,
            "seconds": study.of_file.seconds + study.of_core.seconds, **kinds_json(study.of_file),
            "own_constants": kinds_json(study.of_core), "final": end}


def kinds_json(enclosed: Enclosed) -> dict[str, Any]:
    """Errors, widths and verdicts by kind."""
    kinds = dict(zip(KINDS, enclosed.kinds(), strict=True))
    return {**{f"error_{name}": kind.error for name, kind in kinds.items()},
            **{f"width_{name}": kind.width for name, kind in kinds.items()},
            "inside": all(kind.inside for kind in kinds.values())}
