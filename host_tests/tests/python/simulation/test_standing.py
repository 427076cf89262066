"""Normal loads of wheels and supports: as outputs, at rest, and where nothing keeps a robot from tipping."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from laconic.cli.main import run
from laconic.errors import BadInput
from laconic.scene import read_scene
from laconic.scene.standing import standing_of
from laconic.simulation import simulate
from scene_text import table, wheel

G = 9.80665
BODY = {"mass_kg": 10.0, "yaw_inertia_kgm2": 0.4, "wheel_radius_m": 0.1, "wheel_inertia_kgm2": 0.01, "com_z_m": 0.2}
WHEELS = wheel("fixed", 0.0, 0.25, axle_deg=90.0) + wheel("fixed", 0.0, -0.25, axle_deg=90.0)
BALL = table("[[vehicle.support]]", x_m=-0.3, y_m=0.0)
RUN = table("[run]", duration_s=0.1, step_s=0.01)


def written(folder: Path, *parts: str, **vehicle: float) -> Path:
    (folder / "robot.toml").write_text(table("[vehicle]", **(BODY | vehicle)) + WHEELS + "".join(parts) + RUN,
                                       encoding="utf-8")
    return folder / "robot.toml"


def test_loads_are_outputs_and_balance_weight_and_push(tmp_path: Path) -> None:
    push = table("[[input]]", signal="body_force_N[1]", kind="steps", t_s=[0.0], value=[10.0])
    outputs = table("[outputs]", signals=["wheel_load_N", "support_load_N", "acceleration_body_m_per_s2[1]"])
    found = simulate(read_scene(written(tmp_path, BALL, push, outputs, com_x_m=-0.1))).columns
    assert list(found)[:3] == ["wheel_load_N[1]", "wheel_load_N[2]", "support_load_N[1]"]
    ahead = found["acceleration_body_m_per_s2[1]"][0]
    inertia_N = 2.0 * 0.01 * ahead / 0.1**2  # of the turning wheels, which the ground gives
    on_ball = 10.0 * G / 3.0 - inertia_N * 0.2 / 0.3
    assert found["support_load_N[1]"][0] == pytest.approx(on_ball, rel=1e-9)
    assert found["wheel_load_N[1]"][0] == pytest.approx((10.0 * G - on_ball) / 2.0, rel=1e-9)


def test_loads_of_supports_need_supports(tmp_path: Path) -> None:
    outputs = table("[outputs]", signals=["support_load_N"])
    with pytest.raises(BadInput, match="support_load_N is a support's, and the scene has none"):
        read_scene(written(tmp_path, outputs))


def test_a_run_prints_the_loads_at_rest(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(written(tmp_path, BALL, com_x_m=-0.1))
    assert run(["simulate", path]) == 0
    printed = capsys.readouterr()
    assert ("normal loads at rest: wheel 1 32.7 N (33.3 %), wheel 2 32.7 N (33.3 %), support 1 32.7 N (33.3 %)"
            in printed.out)
    assert printed.err == ""
    assert run(["simulate", path, "--json"]) == 0
    standing = json.loads(capsys.readouterr().out)["standing"]
    assert standing["wheel_load_N"] == pytest.approx([10.0 * G / 3.0] * 2)
    assert standing["stands"] is True and standing["tips"] is None


def test_a_run_without_data_of_the_ground_prints_none(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(written(tmp_path, com_z_m=0.0))
    assert run(["simulate", path]) == 0
    printed = capsys.readouterr()
    assert "normal loads" not in printed.out and printed.err == ""
    assert run(["simulate", path, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["standing"] is None


@pytest.mark.parametrize(("parts", "vehicle", "words"), [
    ((), {},
     "nothing keeps it from tipping: it stands in one line (wheel 1 and wheel 2), and its centre of mass is above it"),
    ((), {"com_x_m": 0.055}, "it stands in one line (wheel 1 and wheel 2), and its centre of mass is 55 mm off"),
    ((table("[[vehicle.support]]", x_m=0.0005, y_m=0.0),), {},
     "it stands in one line (wheel 1, wheel 2 and support 1)"),
    ((BALL,), {"com_x_m": 0.02},
     "it tips: its centre of mass lies 20 mm outside what it stands on, beyond the line from"),
    ((BALL, table("[vehicle.payload]", mass_kg=5.0, x_m=0.3, y_m=0.0, yaw_inertia_kgm2=0.0)), {"com_x_m": -0.1},
     "it tips: its centre of mass lies 33.3 mm outside")])
def test_a_robot_that_tips_is_one_warning(tmp_path: Path, capsys: pytest.CaptureFixture[str], parts: tuple[str, ...],
                                          vehicle: dict[str, float], words: str) -> None:
    assert run(["simulate", str(written(tmp_path, *parts, **vehicle))]) == 0
    warnings = [line for line in capsys.readouterr().err.splitlines() if "the robot: " in line]
    assert len(warnings) == 1 and words in warnings[0]


def test_a_point_that_cannot_pull_carries_nothing(tmp_path: Path) -> None:
    ahead = table("[[vehicle.support]]", x_m=0.3, y_m=0.0)
    standing = standing_of(read_scene(written(tmp_path, BALL, ahead, com_x_m=-0.25)))
    assert not standing.tips
    assert min((*standing.wheel_N, *standing.support_N)) >= 0.0
    assert sum((*standing.wheel_N, *standing.support_N)) == pytest.approx(10.0 * G)


def test_a_centre_of_mass_on_the_edge_of_what_the_robot_stands_on_is_a_warning(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["simulate", str(written(tmp_path, BALL))]) == 0
    printed = capsys.readouterr()
    assert "support 1 0 N (0 %)" in printed.out
    assert "the robot: it may tip: its centre of mass is above the line from wheel" in printed.err
    assert standing_of(read_scene(written(tmp_path, BALL))).as_json()["stands"] is True  # it does, as long as it rests
    assert standing_of(read_scene(written(tmp_path, BALL, com_x_m=-1e-4))).tips == ""


@pytest.mark.parametrize(("height_m", "ground"), [(0.0, ""), (0.2, ""), (0.0, "[ground]")])
def test_a_run_that_judges_grip_states_that_no_height_shifts_no_load(
        tmp_path: Path, capsys: pytest.CaptureFixture[str], height_m: float, ground: str) -> None:
    friction = (table("[ground]", friction_coefficient=0.5),) if ground else ()
    own = {} if ground else {"friction_coefficient": 0.5}
    path = str(written(tmp_path, BALL, *friction, com_x_m=-0.1, com_z_m=height_m, **own))
    line = "com_z_m is 0 or not given: accelerations shift no load"
    assert run(["simulate", path]) == 0
    assert (line in capsys.readouterr().out.splitlines()) is (height_m == 0.0)
    assert run(["simulate", path, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["standing"]["assumed"] == ([line] if height_m == 0.0 else [])
