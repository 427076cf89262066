"""The fuzz targets of the C sources, as firmware_stub/fuzz/targets.txt lists them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from laconic.errors import BadInput
from laconic.paths import FROM_CHECKOUT, SOURCE_DIR


@dataclass(frozen=True)
class Target:
    """A row of the list: the most bytes of an input, the executions a second of processor time that are wanted, and
    where its corpus is kept."""

    name: str
    most_bytes: int
    wanted_per_s: int
    corpus: Path


def targets_by_name() -> dict[str, Target]:
    """All of them, in the order of the list."""
    path = SOURCE_DIR / "firmware_stub/fuzz/targets.txt"
    if not path.exists():
        raise BadInput(f"{path}: is not in an installed package; {FROM_CHECKOUT}")
    rows = [line.split() for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return {name: Target(name, int(most), int(wanted), SOURCE_DIR / corpus) for name, most, _, wanted, corpus in rows}
