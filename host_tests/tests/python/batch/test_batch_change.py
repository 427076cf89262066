"""A lane becomes another vehicle while the batch lives: with that vehicle's bits, and refused where it cannot."""

from __future__ import annotations

import pytest

import laconic
from laconic.scene.methods import EXPLICIT


def robot(mass_kg: float = 8.0, real: str = "double", **more) -> laconic.Vehicle:
    table = dict(laconic.read_scene("robotino2").vehicle)
    return laconic.Vehicle({**table, "mass_kg": mass_kg, **more}, real)


def test_a_changed_lane_has_the_bits_of_its_new_vehicle_and_the_others_keep_theirs():
    batch = laconic.Batch([robot(5.0 + lane) for lane in range(9)], step_s=0.01)
    heavy = robot(40.0)
    batch.voltage_V[:] = [[4.0], [-1.0], [2.0]]
    batch.change(3, batch.prepared(heavy))
    batch.run(5)
    for lane in range(9):
        plant = (heavy if lane == 3 else robot(5.0 + lane)).plant("auto", 0.01)
        plant.run({"voltage_V": [4.0, -1.0, 2.0]}, steps=5)
        assert (plant.pose.x_m, plant.pose.y_m) == (batch.x_m[lane], batch.y_m[lane])
        assert plant.wheel_speeds().tobytes() == of_lane(batch, lane, plant)


def of_lane(batch: laconic.Batch, lane: int, plant: laconic.Plant) -> bytes:
    plant.restore(batch.state(lane), 0)
    return plant.wheel_speeds().tobytes()


def test_what_a_lane_cannot_become_is_refused_and_the_lane_stays():
    batch, shared = laconic.Batch([robot(), robot(9.0)], step_s=0.01), laconic.Batch(robot(), 2)
    with pytest.raises(laconic.BadInput, match="lane: 1 shares its kind"):
        shared.change(1, shared.prepared(robot(9.0)))
    crossed = laconic.Batch([robot(), robot(9.0)], step_s=0.01, kind_of=[1, 1])
    with pytest.raises(laconic.BadInput, match="lane: 0 shares its kind"):
        crossed.change(0, crossed.prepared(robot(7.0)))
    with pytest.raises(laconic.BadInput, match="another way"):
        batch.change(1, batch.prepared(robot(9.0), EXPLICIT))
    with pytest.raises(laconic.BadInput, match="no laconic_batch_kind of this core; make it with batch.prepared"):
        batch.change(1, robot())
    with pytest.raises(laconic.BadInput, match="vehicle: is of single precision"):
        batch.prepared(robot(real="single"))
    with pytest.raises(laconic.BadInput, match="vehicle: has ground friction"):
        batch.prepared(robot(friction_coefficient=0.0, ground={"friction_coefficient": 0.4}))
    batch.voltage_V[:] = 2.0
    batch.run(3)
    plant = robot(9.0).plant("auto", 0.01)
    plant.run({"voltage_V": [2.0] * 3}, steps=3)
    assert plant.pose.heading_rad == batch.heading_rad[1]
