"""The page and the picture of an audit."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from laconic.robot.identify.audit import LEFT, Audit
from laconic.robot.identify.report import as_numbers as numbers_of_study
from laconic.robot.logs.log import counted, remarks_of
from laconic.robot.replay.rolled_paths import roll

SPREADS = ("ahead_m_per_m", "left_m_per_m", "turn_rad_per_m")
COLOURS = {"true": "black", "nominal": "tab:red", "fitted": "tab:blue"}


def as_text(found: Audit, picture: str | None = None) -> str:
    """A page in Markdown."""
    lines = [f"# Audit of {found.scene.name}, from {counted(len(found.logs), 'run')}", "",
             f"The wheels' odometry is off by **{100 * found.nominal:.3f} %** of the way with the scene's numbers, and "
             f"by **{100 * found.found:.3f} %** with those found.", ""]
    if picture is not None:
        lines += [f"![{picture}]({picture})", ""]
    lines += ["| cause | share of the squared error [%] | path error that it makes alone [%] | found |",
              "| --- " * 4 + "|"]
    lines += [f"| {cause.name} | {100 * cause.share:.1f} | {100 * cause.alone:.3f} | {cause.words} |"
              for cause in found.causes]
    lines += [f"| {LEFT} | {100 * found.left:.1f} | – | – |", "", "## What is left", ""]
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
    return {"nominal": found.nominal, "found": found.found, "left": found.left,
            "causes": [asdict(cause) for cause in found.causes],
            "lag_s": found.lag_s, "gains": found.gains,
            "spread": dict(zip(SPREADS, found.spread.tolist(), strict=True)),
            "fit": numbers_of_study(found.study)}


def draw(found: Audit, path: Path) -> None:
    """True, nominal and fitted path of the longest run; the share of each cause; the error along the run."""
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
    rows = [*((cause.name, cause.share, "tab:blue") for cause in found.causes), ("left", found.left, "tab:gray")]
    for row, (_, share, colour) in enumerate(rows):
        how_much.barh(row, 100.0 * share, color=colour)
        how_much.text(max(0.0, 100.0 * share), row, f" {100.0 * share:.1f} %", va="center", fontsize=8)
    how_much.set_yticks(range(len(rows)), [name.replace(" of ", "\nof ", 1) for name, _, _ in rows], fontsize=8)
    how_much.invert_yaxis()
    how_much.margins(x=0.2)
    how_much.set(xlabel="share of the squared error [%]", title=f"{100 * found.nominal:.2f} % → "
                 f"{100 * found.found:.2f} % of the way")
    save(picture, path)
