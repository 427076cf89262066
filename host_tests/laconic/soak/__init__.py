"""Long runs: `laconic soak WHAT` calls the module of that name, with a function `soak(minutes, seed, advance)`.

Options that it has besides stand in its OPTIONS, by the names of its arguments; a module whose end is no time says by
`length(**options)` how far `advance` will have come, or None where it is the time after all."""

from __future__ import annotations

from typing import Any


class StoppedEarly(Exception):
    """A signal, its cause, ended the run; `result` holds what was found until then."""

    def __init__(self, result: dict[str, Any]):
        super().__init__()
        self.result = result
