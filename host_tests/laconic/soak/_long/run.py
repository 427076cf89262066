"""All cases side by side in the lanes of a batch, with the bits that each would have alone, and kept on the way."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from laconic.batch import Batch
from laconic.core import Vehicle
from laconic.errors import BadInput, Refused, reason_of
from laconic.population.store import core_digest
from laconic.soak._long.cases import CASES, HEADING_RAD, PLACE, Prepared, digits, prepared
from laconic.soak._long.measure import Row, row_of

STEP_S = 1e-3
PIECE = 5_000_000  # steps between two states that are kept


def as_double(number: float) -> float:
    return number


def as_single(number: float) -> float:
    return float(np.float32(number))


NUMBERS: dict[str, Callable[[float], float]] = {"double": as_double, "single": as_single}


class LongRun:
    """One method in one scalar type; `done` steps so far, `rows` at the checkpoints passed."""

    def __init__(self, method: str, real: str, folder: Path, step_s: float = STEP_S):
        self.method, self.real, self.step_s = method, real, NUMBERS[real](step_s)
        self.digest = core_digest(real)
        self.path = folder / f"{method}-{real}.json"
        with digits():
            self.cases = [prepared(case, NUMBERS[real]) for case in CASES]
        vehicles = [Vehicle(each.table, real) for each in self.cases]
        takes = [steppable(vehicle, method, self.step_s) for vehicle in vehicles]
        self.cases = [each for each, taken in zip(self.cases, takes, strict=True) if taken]
        self.batch = Batch([each for each, taken in zip(vehicles, takes, strict=True) if taken], None, method,
                           self.step_s)
        self.done, self.rows = 0, list[Row]()
        for lane, each in enumerate(self.cases):
            self._start(lane, each)
        self._go_on()

    def _start(self, lane: int, each: Prepared) -> None:
        self.batch.start(lane, nu_rad_per_s=each.nu, x_m=PLACE.real, y_m=PLACE.imag, heading_rad=HEADING_RAD)
        volts = each.held["voltage_V"]
        self.batch.voltage_V[: len(volts), lane] = volts

    def _about(self) -> dict[str, Any]:
        return {"core": self.digest, "step_s": self.step_s, "cases": [each.case.name for each in self.cases]}

    def _go_on(self) -> None:
        """From what is kept, if anything is."""
        try:
            kept = json.loads(self.path.read_bytes())
            states = [bytes.fromhex(text) for text in kept["states"]]
            about, done, rows = kept["about"], int(kept["done"]), list(kept["rows"])
        except FileNotFoundError:
            return
        except OSError as error:
            raise BadInput(f"{self.path}: cannot be read ({reason_of(error)}); give another --out") from None
        except (ValueError, KeyError, TypeError):
            raise BadInput(f"{self.path}: is no file of a long run; give another --out") from None
        if about != self._about() or len(states) != len(self.cases):
            raise BadInput(f"{self.path}: was begun with another core or other cases; give another --out, or remove it")
        for lane, content in enumerate(states):
            state = self.batch.state(lane)
            self.batch.core.ffi.memmove(state, content, len(content))
            self.batch.load(lane, state)
        self.done, self.rows = done, rows

    def keep(self) -> None:
        """The states with all their bits, and the rows."""
        ffi = self.batch.core.ffi
        states = [bytes(ffi.buffer(self.batch.state(lane))).hex() for lane in range(len(self.cases))]
        text = json.dumps({"about": self._about(), "done": self.done, "rows": self.rows, "states": states}) + "\n"
        fresh = self.path.with_suffix(".fresh")
        try:
            fresh.write_text(text, encoding="utf-8")
            fresh.replace(self.path)
        except OSError as error:
            raise BadInput(f"{self.path}: cannot be written ({reason_of(error)}); make room, or give another "
                           "--out") from None

    def run(self, steps: int, advance: Callable[[float], None]) -> None:
        """Up to so many steps in all, with a row of each case at the powers of ten and at the end."""
        if self.done >= steps:
            return
        checks = sorted({10**k for k in range(3, 19) if 10**k < steps} | {steps})
        for check in checks:
            while self.done < check:
                piece = min(PIECE, check - self.done)
                self.batch.run(piece)
                self.done += piece
                if self.done == check:
                    self._measure()
                self.keep()
                advance(piece)

    def _measure(self) -> None:
        with digits():
            for lane, each in enumerate(self.cases):
                row = row_of(each, self.batch.state(lane), self.real, self.done, self.step_s)
                self.rows.append(row | {"method": self.method, "real": self.real,
                                        "status": int(self.batch.status[lane])})


def steppable(vehicle: Vehicle, method: str, step_s: float) -> bool:
    """Whether the method takes this step at all: explicit ones end where damping is fast."""
    try:
        vehicle.plant(method, step_s)
    except Refused:
        return False
    return True
