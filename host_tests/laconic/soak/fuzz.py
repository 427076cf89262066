"""What reads frames, bytes and calls, vehicles and steps under libFuzzer; readers of scenes and maps."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from laconic.errors import BadInput, nearest_of
from laconic.soak._fuzzing import fuzz_in_turn
from laconic.soak._fuzzing.file_readers import FILE_TARGETS
from laconic.soak._fuzzing.kept import minimised
from laconic.soak._fuzzing.targets import targets_by_name

OPTIONS = ("only", "minimise")


def soak(minutes: float, seed: int, advance: Callable[[float], None], only: str | None = None, minimise: bool = False
         ) -> dict[str, Any]:
    """Runs each target so many minutes, or one of them alone."""
    known = (*targets_by_name(), *FILE_TARGETS)
    if only is not None and only not in known:
        raise BadInput(f"--only {only}: is no fuzz target; {nearest_of(only, known)}")
    names = known if only is None else (only,)
    result = fuzz_in_turn(names, minutes, seed, advance)
    return {**result, **(minimised(names) if minimise else {})}
