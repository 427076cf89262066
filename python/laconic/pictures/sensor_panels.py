"""Panels of a run's picture with what its sensors show."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes

from laconic.pictures.curves import MOST_CURVES, head, keep_scale, plot_beside_yaw_rate, plot_curves, plot_rows

if TYPE_CHECKING:
    from laconic.simulation import Trajectory

IMU, ENCODERS = "imu", "encoders"


def sensor_panels(run: Trajectory) -> list[str]:
    """The panels that a run has, one for each kind of sensor."""
    sensors = run.scene.sensors
    return [name for name, there in ((IMU, sensors.imu), (ENCODERS, sensors.encoder)) if there is not None]


def plot_sensors(panel: str, axes: Axes, run: Trajectory) -> None:
    """One of those panels."""
    (plot_imu if panel == IMU else plot_encoders)(axes, run)


def plot_imu(axes: Axes, run: Trajectory) -> None:
    """Accelerations (left scale) and yaw rate (right scale) as the IMU shows them, with a common zero."""
    accelerations = run.columns_of("imu_acceleration_m_per_s2")
    handles = plot_beside_yaw_rate(axes, run.time_s, accelerations, ("along its x [m/s²]", "along its y [m/s²]"),
                                   run.columns["imu_yaw_rate_rad_per_s"])
    axes.set_ylabel("acceleration [m/s²]")
    head(axes, "What the IMU shows", handles)


def plot_encoders(axes: Axes, run: Trajectory) -> None:
    """The count of every encoder; for too many curves a row of colour each."""
    names = [name for name in run.columns if name.startswith("encoder_count[")]
    counts = np.column_stack([run.columns[name] for name in names])
    wheels = [name.partition("[")[2].removesuffix("]") for name in names]
    if len(names) > MOST_CURVES:
        plot_rows(axes, run.time_s, counts, "count")
        axes.set(xlabel="time [s]", ylabel="encoder")
        axes.set_title("Encoders", loc="left")
        return
    handles = plot_curves(axes, run.time_s, counts, [f"wheel {wheel}" for wheel in wheels])
    axes.set(xlabel="time [s]", ylabel="count")
    axes.margins(x=0.01)
    keep_scale(axes)
    head(axes, "Encoders", handles)
