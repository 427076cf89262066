"""Energy that the processor took, where the system lets it be read: Linux's powercap counters (RAPL)."""

from __future__ import annotations

from pathlib import Path

COUNTERS = Path("/sys/class/powercap")
UNREADABLE = ("energy: no counter of /sys/class/powercap can be read here; on Linux with RAPL, as root or with read "
              "permission on energy_uj, the table has a column of it")


class EnergyCounter:
    """The packages' counters together; `joules` between two readings, across one wrap of each."""

    def __init__(self, folder: Path = COUNTERS):
        self._counters = [path for path in sorted(folder.glob("*:*")) if path.name.count(":") == 1 and _read(path)]

    @property
    def is_readable(self) -> bool:
        """Whether there is one."""
        return bool(self._counters)

    def reading(self) -> list[tuple[int, int]]:
        """(µJ, range) of each."""
        return [found for path in self._counters if (found := _read(path))]

    @staticmethod
    def joules(before: list[tuple[int, int]], after: list[tuple[int, int]]) -> float:
        """Between two readings."""
        return sum((b - a) % size for (a, _), (b, size) in zip(before, after, strict=True)) * 1e-6


def _read(path: Path) -> tuple[int, int] | None:
    try:
        return int((path / "energy_uj").read_text()), int((path / "max_energy_range_uj").read_text()) + 1
    except (OSError, ValueError):
        return None
