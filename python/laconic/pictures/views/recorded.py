"""Where a run goes besides tables and pictures: a recording of topics, a file for Foxglove, the viewer of Rerun. One
list of viewers takes the instants of a run, whether it is over or still runs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from laconic.base.progress import progress_bar
from laconic.pictures.views.robot_view import Area, Viewer
from laconic.scene import Scene

if TYPE_CHECKING:
    from laconic.simulation import Trajectory


@dataclass(frozen=True)
class Recorded:
    """The options that say so; None: not wanted."""

    bag: Path | None = None
    storage: str | None = None
    foxglove: Path | None = None
    rerun: Path | None = None

    def __bool__(self) -> bool:
        return any(path is not None for path in (self.bag, self.foxglove, self.rerun))

    @property
    def first(self) -> str:
        """The first option as the user gave it, for messages."""
        given = (("--bag", self.bag), ("--foxglove", self.foxglove), ("--rerun", self.rerun))
        return next(f"{name} {path}" if path.name else name for name, path in given if path is not None)

    @property
    def files(self) -> list[Path]:
        """What is written."""
        found = [path for path in (self.bag, self.foxglove) if path is not None]
        if self.foxglove is not None:
            from laconic.pictures.views.foxglove import layout_of

            found.append(layout_of(self.foxglove))
        return [*found, *([self.rerun] if self.rerun is not None and self.rerun.name else [])]


def signals_of(recorded: Recorded, scene: Scene) -> tuple[str, ...]:
    """The signals of a run that the options need."""
    found: list[str] = []
    if recorded.bag is not None:
        from laconic.robot.bags.run_topics import needed_signals as of_bag

        found += of_bag(scene)
    if recorded.foxglove is not None or recorded.rerun is not None:
        from laconic.pictures.views.robot_view import needed_signals

        found += needed_signals(scene)
    return tuple(dict.fromkeys(found))


@contextmanager
def open_viewers(recorded: Recorded, scene: Scene, area: Area | None = None) -> Iterator[list[Viewer]]:
    """All that is wanted, completed at the end. Each loads its library where it is wanted, and only there."""
    with ExitStack() as opened:
        found: list[Viewer] = []
        if recorded.bag is not None:
            from laconic.robot.bags.run_topics import RunTopics, open_bag

            found.append(RunTopics(scene, opened.enter_context(open_bag(recorded.bag, recorded.storage))))
        if recorded.foxglove is not None:
            from laconic.pictures.views.foxglove import open_foxglove

            found.append(opened.enter_context(open_foxglove(recorded.foxglove, scene, area)))
        if recorded.rerun is not None:
            from laconic.pictures.views.rerun_stream import open_rerun

            found.append(opened.enter_context(open_rerun(recorded.rerun, scene, area)))
        yield found


def area_of(run: Trajectory) -> Area | None:
    """Middle and half width of what a run drives over."""
    if "x_m" not in run.columns:
        return None
    x, y = run.columns["x_m"], run.columns["y_m"]
    low, high = (float(x.min()), float(y.min())), (float(x.max()), float(y.max()))
    return Area(0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * max(high[0] - low[0], high[1] - low[1]))


def write_run(run: Trajectory, recorded: Recorded) -> list[str]:
    """All rows of a simulated run; returns what the recordings lack."""
    names = [name for name in signals_of(recorded, run.scene) if name in run.columns]
    with open_viewers(recorded, run.scene, area_of(run)) as viewers, \
            progress_bar("writing the run", len(run.time_s)) as advance:
        columns: Sequence[list[float]] = [run.columns[name].tolist() for name in names]
        for time_s, *row in zip(run.time_s.tolist(), *columns, strict=True):
            signals = dict(zip(names, row, strict=True))
            for viewer in viewers:
                viewer.take(time_s, signals)
            advance(1)
        return [remark for viewer in viewers for remark in viewer.remarks]
