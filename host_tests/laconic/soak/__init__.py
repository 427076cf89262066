"""Long runs: `laconic soak WHAT` calls the module of that name, with a function `soak(minutes, seed, advance)`."""

from __future__ import annotations

from typing import Any


class StoppedEarly(Exception):
    """A signal, its cause, ended the run; `result` holds what was found until then."""

    def __init__(self, result: dict[str, Any]):
        super().__init__()
        self.result = result
