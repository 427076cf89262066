"""What an analysis finds, part by part, and the options that it was given."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from laconic.tools.analyse import PARTS, confirm
from laconic.tools.analyse.continuation import Diagram
from laconic.tools.analyse.cycle import HopfPoint, LimitCycle
from laconic.tools.analyse.free_motion import FreeMotion
from laconic.tools.analyse.from_core import Subject
from laconic.tools.analyse.geometry import Geometry
from laconic.tools.analyse.motions import Parameter
from laconic.tools.analyse.portrait import Portrait
from laconic.tools.analyse.steady import Family, PushedHeading, SteadyMotion
from laconic.tools.analyse.traction import Traction


@dataclass
class FreePart:
    """The free motion that starts where the scene does (or where its motors are switched off)."""

    motion: FreeMotion
    since_s: float
    energy_J: float
    integral: float | None
    core_gap: float                  # largest difference of ν between closed form and core
    energy_drift: float
    integral_drift: float | None
    portrait: Portrait | None
    path_time_s: np.ndarray
    path_m: np.ndarray
    core_path_m: np.ndarray


@dataclass
class SteadyPart:
    """Steady motions under the held inputs."""

    motions: list[SteadyMotion]
    confirmations: list[confirm.Confirmation]
    families: list[Family]
    pushed: list[PushedHeading] | None = None
    inputs: dict[str, Any] = field(default_factory=dict)


@dataclass
class CyclePart:
    """A limit cycle and the steady motion inside."""

    cycle: LimitCycle
    centre_nu: np.ndarray
    hopf: HopfPoint
    confirmation: confirm.Confirmation


@dataclass
class BifurcationPart:
    """The diagram over one parameter."""

    parameter: Parameter
    low: float
    high: float
    diagram: Diagram
    thresholds: list[float]
    cycles: list[CyclePart]


@dataclass
class Study:
    """Everything that was found; a part that does not apply to the scene is None, with the reason in `words`."""

    subject: Subject
    geometry: Geometry | None = None
    free: FreePart | None = None
    steady: SteadyPart | None = None
    bifurcation: BifurcationPart | None = None
    traction: Traction | None = None
    words: dict[str, list[str]] = field(default_factory=dict)
    failures: list[str] = field(default_factory=list)

    def add(self, part: str, sentence: str) -> None:
        """Adds a sentence to a part of the report."""
        self.words.setdefault(part, []).append(sentence)


@dataclass(frozen=True)
class StudyOptions:
    """The parts to study, and what the command was given for them; None: the study chooses."""

    parts: tuple[str, ...] = PARTS
    parameter: str | None = None
    low: float | None = None
    high: float | None = None
    straight: tuple[float, float] | None = None
    start: tuple[float, float, float] | None = None
