"""Paths of the runs of an identification: true, by the nominal values, by the values found."""

from __future__ import annotations

from pathlib import Path

from laconic.errors import BadInput
from laconic.robot.identify.study import Study, fitted_scene
from laconic.robot.replay.rolled_paths import roll

LEAST_PANELS, MOST_PANELS = 3, 9
STYLES = {"nominal": ("tab:orange", "--"), "identified": ("tab:blue", "-")}


def draw(study: Study, path: Path) -> None:
    """The first run of each session, then further ones; BadInput where no log has a true pose."""
    from laconic.pictures.plotting import figure, save

    if all(log.pose is None for log in study.logs):
        raise BadInput("--plot: draws paths, and no log has a true pose; leave it out, or name the pose in the map")
    scenes = {"nominal": study.scene, "identified": fitted_scene(study.scene, study.found)}
    paths = {name: roll(scene, study.logs) for name, scene in scenes.items()}
    shown = _shown(study)
    columns = min(3, len(shown))
    rows = -(-len(shown) // columns)
    picture = figure(4.0 * columns, 3.7 * rows + 0.6)
    panels = picture.subplots(rows, columns, squeeze=False).ravel()
    for axes, index in zip(panels, shown, strict=False):
        pose = study.logs[index].pose
        assert pose is not None
        axes.plot(pose[:, 0], pose[:, 1], color="k", lw=2.6, alpha=0.35, label="true")
        errors = []
        for name, found in paths.items():
            colour, line = STYLES[name]
            axes.plot(*found.paths[index][:, :2].T, color=colour, ls=line, lw=1.0, label=name)
            errors.append(f"{100.0 * (found.errors[index].path_error or 0.0):.2f} %")
        axes.set_aspect("equal", "datalim")
        axes.set_title(f"{study.logs[index].session}\n{study.logs[index].stem}: {' → '.join(errors)}", fontsize=7)
    for axes in panels[len(shown):]:
        axes.remove()
    panels[0].set(xlabel="x [m]", ylabel="y [m]")
    picture.legend(handles=panels[0].get_legend_handles_labels()[0], loc="outside lower center", ncols=3, fontsize=9)
    save(picture, path)


def _shown(study: Study) -> list[int]:
    """Indices of runs: one of each session; where those are few, others beside them."""
    with_pose = [index for index, log in enumerate(study.logs) if log.pose is not None]
    firsts = {study.logs[index].path.resolve().parent: index for index in reversed(with_pose)}
    first = sorted(firsts.values())
    others = [index for index in with_pose if index not in first]
    return sorted([*first, *others[:max(LEAST_PANELS - len(first), 0)]])[:MOST_PANELS]
