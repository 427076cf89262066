"""`--vary`: which key takes which values. A grid `KEY=a:b:n`, a list `KEY=a,b,c`, a distribution `KEY~normal(m,s)`."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any, NoReturn

import numpy as np

from laconic.errors import BadInput, nearest_of, shown
from laconic.scene.key_path import KeyPath, key_path

MOST_GRID = 10**9
USES = "give KEY=a:b:n, KEY=a,b,c or KEY~normal(m,s)"
DISTRIBUTIONS = {
    "normal": ("mean", "standard deviation"), "uniform": ("least", "greatest"),
    "lognormal": ("median", "standard deviation of the logarithm"), "triangular": ("least", "mode", "greatest")}
TABLES = ("vehicle", "ground", "initial", "input", "run")  # whose keys change a run
EDGE = 2.0**-53


@dataclass(frozen=True)
class Varied:
    """One `--vary`. Of a grid or list `levels` are its values; of a distribution `parameters`."""

    text: str
    key: KeyPath
    levels: tuple[Any, ...] = ()
    distribution: str = ""
    parameters: tuple[float, ...] = ()

    @property
    def is_random(self) -> bool:
        """Whether it is drawn from a distribution."""
        return bool(self.distribution)

    def drawn(self, unit: np.ndarray) -> np.ndarray:
        """Values of a distribution for points of [0, 1)."""
        from scipy.special import ndtri
        u, p = np.clip(unit, EDGE, 1.0 - EDGE), self.parameters
        if self.distribution == "normal":
            return np.asarray(p[0] + p[1] * ndtri(u))
        if self.distribution == "lognormal":
            return np.asarray(p[0] * np.exp(p[1] * ndtri(u)))
        if self.distribution == "uniform":
            return p[0] + (p[1] - p[0]) * u
        width, rise = p[2] - p[0], (p[1] - p[0]) / (p[2] - p[0])
        return np.where(u < rise, p[0] + width * np.sqrt(u * rise),
                        p[2] - width * np.sqrt((1.0 - u) * (1.0 - rise)))


def read_varied(text: str) -> Varied:
    """One `--vary`; BadInput says what is wrong with it."""
    found = re.fullmatch(r"\s*([^=~]+?)\s*([=~])\s*(.*?)\s*", text)
    if not found or not found[3]:
        _fail(text, f"does not say which values; {USES}")
    key = key_path(found[1])
    if (key.tables[0][0] if key.tables else "") not in TABLES:
        _fail(text, f"{key.text} changes no run; vary a key of {', '.join(TABLES)}")
    if found[2] == "~":
        return _distribution(text, key, found[3])
    return Varied(text, key, _levels(text, key, found[3]))


def _fail(text: str, message: str) -> NoReturn:
    raise BadInput(f"--vary {text}: {message}")


def _number(text: str, given: str) -> float:
    try:
        value = float(given)
    except ValueError:
        _fail(text, f"{shown(given.strip())} is no number; {USES}")
    if not math.isfinite(value):
        _fail(text, f"{given.strip()} is not finite; give a finite number")
    return value


def _levels(text: str, key: KeyPath, given: str) -> tuple[Any, ...]:
    if ":" not in given:
        levels = tuple(_level(text, key, each.strip()) for each in given.split(","))
        if len(set(levels)) < len(levels):
            _fail(text, "names a value twice; keep one of them")
        return levels
    parts = given.split(":")
    if len(parts) != 3 or key.known.kind != "number":
        _fail(text, "is no range; give KEY=a:b:n, n values from a to b, or a list KEY=a,b,c")
    first, last = (_number(text, each) for each in parts[:2])
    if not re.fullmatch(r"\s*\d{1,9}\s*", parts[2]) or not 1 <= int(parts[2]) <= MOST_GRID:
        _fail(text, f"{shown(parts[2].strip())} is no number of values; give a whole number from 1 to {MOST_GRID}, "
                    f"such as {parts[0]}:{parts[1]}:11")
    count = int(parts[2])
    if (count == 1) is not (first == last):
        _fail(text, "needs two values or more from one number to another; give a larger n, or KEY=a for one")
    return tuple(np.linspace(first, last, count).tolist())


def _level(text: str, key: KeyPath, given: str) -> Any:
    if key.known.kind == "number":
        return _number(text, given)
    if key.known.kind == "true or false":
        if given not in ("true", "false"):
            _fail(text, f"{shown(given)} is neither true nor false; give one of them")
        return given == "true"
    if key.known.kind == "whole number":
        if not re.fullmatch(r"-?\d{1,18}", given):
            _fail(text, f"{shown(given)} is no whole number; give one")
        return int(given)
    if not given:
        _fail(text, f"has an empty word in its list; {USES}")
    return given


def _distribution(text: str, key: KeyPath, given: str) -> Varied:
    found = re.fullmatch(r"(\w+)\s*\(([^()]*)\)", given)
    if not found:
        _fail(text, "is no distribution; give KEY~normal(mean, standard deviation)")
    name, parts = found[1], [each for each in found[2].split(",") if each.strip()]
    if name not in DISTRIBUTIONS:
        _fail(text, f"there is no distribution {shown(name)}; {nearest_of(name, DISTRIBUTIONS)}")
    if key.known.kind != "number":
        _fail(text, f"{key.text} is {key.known.kind}, not a number; give a list KEY=a,b")
    wanted = DISTRIBUTIONS[name]
    if len(parts) != len(wanted):
        _fail(text, f"has {len(parts)} numbers; give {name}({', '.join(wanted)})")
    p = tuple(_number(text, each) for each in parts)
    if name in ("normal", "lognormal") and not p[1] > 0.0:
        _fail(text, f"a standard deviation of {p[1]:g} is not positive; give one above 0")
    if name == "lognormal" and not p[0] > 0.0:
        _fail(text, f"a median of {p[0]:g} is not positive; give one above 0")
    if name in ("uniform", "triangular") and not (p[0] < p[-1] and p[0] <= p[1] <= p[-1]):
        _fail(text, f"its numbers do not ascend; give {name}({', '.join(wanted)})")
    return Varied(text, key, distribution=name, parameters=p)
