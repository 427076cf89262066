"""Whether a compiler makes the same bytes of a fault as of the source, or of what a row of the list makes of the same
lines: `> -1` for a listed `>= 0`, whatever laws of C that takes. It asks every target that the file is in."""

from __future__ import annotations

from pathlib import Path

from laconic.mutation.compiled import Compiled
from laconic.mutation.listed import Listed
from laconic.mutation.operators import Change
from laconic.mutation.programs import Unit

SAME = "The compiler makes the same bytes of it as without it."
SAME_AS_A_ROW = "The compiler makes the same bytes of it as of a row"


class SameCode:
    """The list, by what compilers make of it."""

    def __init__(self, listed: Listed, compiled: Compiled):
        self._listed, self._compiled, self._tree = listed, compiled, compiled.tree(0)

    def reason(self, file: str, change: Change) -> str | None:
        """Why no test can notice a change of a file; None where it does not compile, or to other bytes."""
        units = self._compiled.units_of(file)
        if not units:
            return None
        own, changed, of_rows = self._listed.beside(file, change)
        left = {own: SAME} | {text: f"{SAME_AS_A_ROW}: {reason}" for text, reason in of_rows.items()}
        path = self._tree / file
        before = path.read_bytes()
        try:
            for unit in units:
                now = self._bytes(unit, path, changed)
                left = {text: reason for text, reason in left.items()
                        if now is not None and self._bytes(unit, path, text) == now}
                if not left:
                    return None
        finally:
            path.write_bytes(before)
        return next(iter(left.values()))

    def _bytes(self, unit: Unit, path: Path, text: str) -> bytes | None:
        path.write_text(text, encoding="utf-8")
        out = self._tree / "same_code.o"
        return out.read_bytes() if unit.compile(self._tree, out).returncode == 0 else None
