"""What the ground must deliver, over time."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from laconic.analysis.findings import Study
from laconic.analysis.traction import Traction
from laconic.plotting import figure

STYLES = ("-", "--", "-.", (0, (3, 1, 1, 1, 1, 1)))  # so that wheels differ in black and white too


def traction_picture(study: Study) -> Figure | None:
    """Normal loads, reactions, and use of the friction cone."""
    found = study.traction
    if found is None or study.subject.wheel_count == 0:
        return None
    judged = np.isfinite(found.use).any()
    picture = figure(8.0, 7.2 if judged else 5.2)
    rows = picture.subplots(3 if judged else 2, 1, sharex=True)
    n, t = study.subject.wheel_count, found.time_s
    for i in range(found.normal_N.shape[1]):
        label = f"wheel {i + 1}" if i < n else f"support {i - n + 1}"
        rows[0].plot(t, found.normal_N[:, i], label=label, ls=STYLES[i % 4] if i < n else ":")
    for i in range(n):
        rows[1].plot(t, np.hypot(found.along_N[:, i], found.lateral_N[:, i]), ls=STYLES[i % 4])
    rows[0].set(ylabel="normal load [N]", title=f"{study.subject.scene.name}\nwhat the ground must deliver")
    rows[1].set(ylabel="reaction [N]")
    if judged:
        _use(rows[2], found, n)
    if found.first_slip_s is not None:
        for axes in rows:
            axes.axvline(found.first_slip_s, color="k", lw=1.2, ls="--")
    rows[-1].set_xlabel("time [s]")
    handles, labels = rows[0].get_legend_handles_labels()
    if found.first_slip_s is not None:
        handles += rows[0].plot([], [], "k--", lw=1.2)
        labels.append(f"first slip: {found.first_slip_s:.4g} s")
    picture.legend(handles, labels, loc="outside lower center", ncols=4, fontsize=9)
    return picture


def _use(axes: Axes, found: Traction, count: int) -> None:
    top = min(3.0, max(1.15, 1.08 * float(np.nanmax(np.where(np.isfinite(found.use), found.use, 0.0)))))
    for i in range(count):
        axes.plot(found.time_s, np.minimum(found.use[:, i], 1.2 * top), ls=STYLES[i % 4])
    axes.axhspan(1.0, top, color="tab:red", alpha=0.10, lw=0)
    axes.axhline(1.0, color="tab:red", lw=1.0)
    axes.set_ylim(0.0, top)
    cut = " (cut at 3)" if top == 3.0 else ""
    axes.set(ylabel=f"use of the\nfriction cone [–]{cut}")
