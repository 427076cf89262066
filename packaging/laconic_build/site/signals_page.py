"""docs/signals.md: what acts on a vehicle and what it shows, from where the program itself knows them.

`python -m laconic_build.site.signals_page` writes the page anew.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from laconic.scene.reference import Signal, inputs, outputs
from laconic_build.site.scene_reference import descriptions

SOURCE = Path(__file__).resolve().parents[3]
ITEMS = {"": "1", "[1|2]": "2: x, y", "[1|2|3]": "3", "[i]": "one for each wheel", "[j]": "one for each support",
         "[name]": "one for each hinge"}

TEXT = """# Signals

Names of numbers over time: columns of `laconic simulate --out`, of `Trajectory.columns` [in Python](python.md), keys
of `[[input]]` and `[outputs]` in [a scene](scenes.md), variables of [an FMU](fmu.md). An index counts from 1:
`voltage_V[2]`, `nu_rad_per_s[3]`. A hinge has its body's name: `hinge_angle_rad[front]`. Letters and axes are in the
[glossary](glossary.md). Made by `build/venv/bin/python -m laconic_build.site.signals_page` from the lists by which
scenes are read and from `modelDescription.xml`; edit those.

## Inputs

What an `[[input]]` may set, and `Plant.run` in Python; 0 where nothing is given.

{inputs}

## Outputs

What `[outputs]` may list. The ground's reaction is the force on the wheel: `wheel_reaction_N` in the direction
`axle_rad` + `roller_rad` from the body's x axis, of a fixed wheel in the direction `axle_rad` + 90°;
`wheel_lateral_N` a quarter turn to the right of that. A signal that a scene lacks is refused with what it needs;
without its index a signal stands for all of its numbers.

{outputs}
"""


def page() -> str:
    """The whole text."""
    words, _ = descriptions(SOURCE)
    return TEXT.format(inputs=_table(inputs(words)), outputs=_table(outputs(words)))


def _table(signals: Iterable[Signal]) -> str:
    lines = ["| signal | numbers | unit | meaning | only with |", "| --- | --- | --- | --- | --- |"]
    for each in signals:
        cells = (f"`{each.name}`", ITEMS[each.items], each.unit, each.meaning, each.needs)
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines)


if __name__ == "__main__":
    (SOURCE / "docs" / "signals.md").write_text(page(), encoding="utf-8")
