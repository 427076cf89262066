"""The analysis as plain text and as numbers for machines."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from laconic.tools.analyse import TITLES
from laconic.tools.analyse.findings import BifurcationPart, FreePart, SteadyPart, Study
from laconic.tools.analyse.from_core import Subject
from laconic.tools.analyse.speeds import of_driver, wheel_radius_m
from laconic.tools.analyse.traction import Traction

# ---- What an earlier analysis left in the folder of this one: pictures that would stand beside a page they are not
# of.

def pictures_of_older_page(folder: Path, drawn: Sequence[Path]) -> list[Path]:
    """Pictures in the folder that the report.json there lists and this run has not drawn.

    A file is the tool's own only when it has one of its pictures' names and that page lists it; all else
    in the folder is the user's.
    """
    from laconic.tools.analyse.pictures import PICTURES

    try:
        listed = json.loads((folder / "report.json").read_text(encoding="utf-8"))["pictures"]
        written = {Path(name).name for name in listed}
    except (OSError, ValueError, KeyError, TypeError):
        return []
    ours = written & {f"{name}.png" for name in PICTURES} - {path.name for path in drawn}
    return sorted(path for path in (folder / name for name in ours) if path.is_file())


def as_text(study: Study, pictures: list[Path]) -> str:
    """A short report for people."""
    lines = [f"# {study.subject.scene.name}", ""]
    for part, title in TITLES.items():
        if part in study.words:
            lines += [f"## {title}", "", *(f"* {sentence}" for sentence in study.words[part]), ""]
    if study.failures:
        lines += ["## Not confirmed", "", *(f"* {failure}" for failure in study.failures), ""]
    if pictures:
        lines += ["## Pictures", "", *(f"![{path.stem}]({path.name})" for path in pictures), ""]
    return "\n".join(lines)


def as_numbers(study: Study, pictures: list[Path]) -> dict[str, Any]:
    """The same for machines; complex numbers as [real, imaginary], what is infinite as null."""
    writers: dict[str, Callable[[Any, Subject], Any]] = {
        "geometry": lambda found, _: asdict(found), "free": _free, "steady": _steady,
        "bifurcation": _bifurcation, "traction": _traction}
    numbers: dict[str, Any] = {"scene": str(study.subject.scene.path), "name": study.subject.scene.name}
    for part, write in writers.items():
        found = getattr(study, part)
        numbers[part] = None if found is None else write(found, study.subject)
    numbers |= {"words": study.words, "failures": study.failures, "pictures": [str(path) for path in pictures]}
    return plain(numbers)


def _free(free: FreePart, subject: Subject) -> dict[str, Any]:
    motion = free.motion
    return {
        "since_s": free.since_s, "start_nu_rad_per_s": motion.start_nu, **of_driver(subject, motion.start_nu),
        "kind": motion.kind,
        "period_s": motion.period_s, "energy_J": free.energy_J, "K_rad_per_s": free.integral,
        "limit_nu_rad_per_s": motion.limit_nu(), "difference_to_exact_flow": free.core_gap,
        "energy_drift": free.energy_drift, "K_drift": free.integral_drift,
        "ellipse_centre_rad_per_s": None if free.portrait is None else free.portrait.centre}


def _motion(motion: Any, subject: Subject) -> dict[str, Any]:
    return {"nu_rad_per_s": motion.nu, **of_driver(subject, motion.nu), "stability": motion.stability,
            "turns": motion.is_turning, "eigenvalues_per_s": motion.eigenvalues}


def _steady(steady: SteadyPart, subject: Subject) -> dict[str, Any]:
    motions = [_motion(m, subject) | {"confirmed": c.holds, "simulated": c.simulated}
               for m, c in zip(steady.motions, steady.confirmations, strict=True)]
    families = [asdict(family) for family in steady.families]
    out: dict[str, Any] = {"inputs": steady.inputs, "motions": motions, "families": families}
    if steady.pushed is not None:
        out["headings"] = [asdict(heading) for heading in steady.pushed]
    return out


def _bifurcation(part: BifurcationPart, subject: Subject) -> dict[str, Any]:
    branches = [{"parameter": b.parameter, "nu_rad_per_s": b.nu(), "stable": b.stable()} for b in part.diagram.branches]
    cycles = [{"parameter": c.cycle.parameter, "period_s": c.cycle.period_s, "multipliers": c.cycle.multipliers,
               "stable": c.cycle.stable, "size_rad_per_s": c.cycle.size, "confirmed": c.confirmation.holds,
               "simulated": c.confirmation.simulated}
              for c in part.cycles]
    hopf = [{"parameter": h.parameter, "nu_rad_per_s": h.nu, "frequency_rad_per_s": h.frequency_rad_per_s,
             "first_lyapunov_coefficient": h.lyapunov, "kind": h.kind} for h in part.diagram.hopf]
    commanded = part.parameter.name in ("nu1", "nu2")
    metres = {"from_m_per_s": wheel_radius_m(subject) * part.low, "to_m_per_s": wheel_radius_m(subject) * part.high,
              "reach_rad_per_s": part.parameter.reach} if commanded else {}
    return {"parameter": part.parameter.name, "from": part.low, "to": part.high, **metres,
            "straight_thresholds": part.thresholds, "specials": [asdict(s) for s in part.diagram.specials],
            "hopf": hopf, "cycles": cycles, "branches": branches}


def _traction(found: Traction, _: Subject) -> dict[str, Any]:
    finite = found.use[np.isfinite(found.use)]
    return {
        "first_slip_s": found.first_slip_s, "slipping_wheels": found.slipping_wheels, "lifting": found.lifting,
        "largest_use_of_friction": float(finite.max()) if finite.size else None,
        "static_normal_N": found.static_normal_N,
        "largest_reaction_N": np.hypot(found.along_N, found.lateral_N).max(axis=0),
        "largest_brake_Nm": np.abs(found.brake_Nm).max(axis=0),
        "force_balance_N": found.balance_N, "moment_balance_Nm": found.balance_Nm, "statics_hold": found.statics_hold}


def plain(value: Any) -> Any:
    """Something json can write."""
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(v) for v in value]
    if isinstance(value, (complex, np.complexfloating)):
        return [float(value.real), float(value.imag)]
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, (int, np.integer)):
        return int(value)
    if isinstance(value, (float, np.floating)):
        return float(value) if np.isfinite(value) else None
    return value
