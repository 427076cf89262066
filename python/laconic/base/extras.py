"""What `pip install "laconic[EXTRA]"` brings, and which of it a command lacks; the extras stand in pyproject.toml."""

from __future__ import annotations

import re

from laconic.base.paths import IS_WHEEL
from laconic.errors import BadInput

DISTRIBUTIONS = {"can": "python-can", "e2e": "autosar-e2e", "flint": "python-flint", "rerun": "rerun-sdk",
                 "serial": "pyserial", "wpilib": "robotpy", "wpimath": "robotpy", "zenoh": "eclipse-zenoh"}
"""Modules whose distribution has another name."""


def missing_module(error: ModuleNotFoundError) -> BadInput:
    """A module that is not installed, as one line with what to install."""
    module = (error.name or "").partition(".")[0]
    wanted = DISTRIBUTIONS.get(module, module.replace("_", "-"))
    if extra := extra_of(wanted):
        return BadInput(f'this needs {wanted}, which is not installed; pip install "laconic[{extra}]"')
    remedy = "install laconic again, with what it needs" if IS_WHEEL else "build again, which brings it up to date"
    return BadInput(f"the Python environment has no {error.name}; {remedy}")


def extra_of(distribution: str) -> str:
    """The first extra that brings a distribution; empty where none does."""
    from importlib.metadata import PackageNotFoundError, requires  # slow to load, and seldom needed

    try:
        lines = requires("laconic") or []
    except PackageNotFoundError:
        return ""
    found = (re.fullmatch(r"""([\w.-]+).*\bextra == ["']([\w-]+)["']""", line) for line in lines)
    wanted = distribution.lower()
    return next((each[2] for each in found if each and re.sub("[-_.]+", "-", each[1]).lower() == wanted), "")
