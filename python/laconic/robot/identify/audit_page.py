"""The page and the picture of an audit."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from laconic.robot.identify.audit import Audit
from laconic.robot.identify.report import as_numbers as numbers_of_study
from laconic.robot.logs.log import counted, remarks_of
from laconic.robot.replay.rolled_paths import roll

SPREADS = ("ahead_m_per_m", "left_m_per_m", "turn_rad_per_m")
COLOURS = {"true": "black", "nominal": "tab:red", "fitted": "tab:blue"}


def as_text(found: Audit, picture: str | None = None) -> str:
    """A page in Markdown."""
    first, last = found.stages[0].error, found.stages[-1].error
    lines = [f"# Audit of {found.scene.name}, from {counted(len(found.logs), 'run')}", "",
             f"The wheels' odometry is off by **{100 * first:.3f} %** of the way with the scene's numbers, and by "
             f"**{100 * last:.3f} %** with those found.", ""]
    if picture is not None:
        lines += [f"![{picture}]({picture})", ""]
    lines += ["| free, one after another | path error [%] | share of the squared error [%] | found |",
              "| --- " * 4 + "|",
              f"| nothing: nominal | {100 * first:.3f} | – | – |"]
    for stage, (_, share) in zip(found.stages[1:], found.shares(), strict=False):
        lines.append(f"| {stage.name} | {100 * stage.error:.3f} | {100 * share:.1f} | {stage.words} |")
    name, share = found.shares()[-1]
    lines += [f"| {name} | – | {100 * share:.1f} | – |", "", "## What is left", ""]
    lines += [f"* {word}" for word in words_of_rest(found)]
    if remarks := remarks_of(found.logs):
        lines += ["", "## The logs", "", *(f"* {each}" for each in remarks)]
    lines += ["", "## What the fit states", "", *(f"* {word}" for word in found.study.words if word not in remarks), ""]
    return "\n".join(lines)


def words_of_rest(found: Audit) -> list[str]:
    """Spread of single stretches, and gains of the motion against the fitted wheels."""
    ahead, left, turn = found.spread
    words = [f"for each metre of way the robot is off by {1e3 * ahead:.1f} mm ahead, {1e3 * left:.1f} mm to the left "
             f"and {np.degrees(turn):.2f}° (root mean square over stretches)"]
    for name, gain in found.gains.items():
        kind = "turns" if name == "turn" else f"moves {name}" if name != "turn" else name
        words.append(f"the robot {kind} {gain:.4f} of what the fitted wheels tell" + (
            ": rollers slip or drag there" if abs(gain - 1.0) > 0.02 else ""))
    words.append("no time lag was found between wheels and pose" if found.lag_s is None else
                 f"the pose is {abs(1e3 * found.lag_s):.0f} ms {'behind' if found.lag_s > 0 else 'ahead of'} the "
                 f"wheels; lag_s = {found.lag_s:g} under [pose] in the map takes it out")
    return words


def as_numbers(found: Audit) -> dict[str, Any]:
    """For JSON."""
    return {"stages": [{"name": stage.name, "path_error": stage.error, "found": stage.words} for stage in found.stages],
            "shares": dict(found.shares()), "lag_s": found.lag_s, "gains": found.gains,
            "spread": dict(zip(SPREADS, found.spread.tolist(), strict=True)),
            "fit": numbers_of_study(found.study)}


def draw(found: Audit, path: Path) -> None:
    """True, nominal and fitted path of the longest run; the error that is left after each kind; what is left of it."""
    from laconic.pictures.plotting import figure, save

    index = int(np.argmax([len(log.time_s) for log in found.logs]))
    log = found.logs[index]
    assert log.pose is not None
    paths = {name: roll(scene, [log]).paths[0] for name, scene in (("nominal", found.scene), ("fitted", found.fitted))}
    picture = figure(11.0, 4.6)
    where, how_much, along = picture.subplots(1, 3)
    where.plot(log.pose[log.seen, 0], log.pose[log.seen, 1], color="k", lw=2.6, alpha=0.35, label="true")
    for name, rolled in paths.items():
        where.plot(rolled[:, 0], rolled[:, 1], color=COLOURS[name], lw=1.1, label=name)
        off = np.hypot(*(rolled - log.pose)[log.seen, :2].T)
        along.plot(log.time_s[log.seen], 1e3 * off, color=COLOURS[name], lw=1.1, label=name)
    where.set_aspect("equal", "datalim")
    where.set(xlabel="x [m]", ylabel="y [m]", title=f"path of {log.stem}")
    where.legend(fontsize=8)
    along.set(xlabel="time [s]", ylabel="distance from the true path [mm]", title="along the run")
    names = [stage.name for stage in found.stages]
    how_much.barh(range(len(names)), [100.0 * stage.error for stage in found.stages], color="tab:gray")
    for row, stage in enumerate(found.stages):
        how_much.text(100.0 * stage.error, row, f" {100.0 * stage.error:.2f} %", va="center", fontsize=8)
    how_much.set_yticks(range(len(names)), [name.replace(" of ", "\nof ", 1) for name in names], fontsize=8)
    how_much.invert_yaxis()
    how_much.margins(x=0.2)
    how_much.set(xlabel="path error [%]", title="left once this is found, too")
    save(picture, path)
