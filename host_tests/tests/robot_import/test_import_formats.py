"""MJCF and SDF become the scene that the same robot has as URDF."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from made_up_robots import TWO_WHEELS, robot

from laconic.errors import BadInput
from laconic.robot_import import Answers, import_robot
from laconic.scene.table import read_toml

MJCF = """<mujoco><worldbody><body name="base" pos="0 0 0.3" euler="0 0 30"><freejoint/>
<inertial pos="0.02 0.01 0.03" mass="5" diaginertia="0.1 0.1 0.08"/><geom type="box" size="0.2 0.15 0.05"/>
<body name="left_link" pos="0 0.2 -0.05"><joint name="left" axis="0 1 0"/>
<inertial pos="0 0 0" mass="0.5" diaginertia="4e-4 7e-4 4e-4"/>
<geom type="cylinder" size="0.05 0.01" euler="90 0 0"/></body>
<body name="right_link" pos="0 -0.2 -0.05"><joint name="right" axis="0 1 0"/>
<inertial pos="0 0 0" mass="0.5" diaginertia="4e-4 7e-4 4e-4"/>
<geom type="cylinder" size="0.05 0.01" euler="90 0 0"/></body>
</body></worldbody></mujoco>"""

WHEEL = """<link name="{0}_link"><pose relative_to="{0}">0 0 0 0 0 -0.5</pose><inertial><mass>0.5</mass>
<inertia><ixx>4e-4</ixx><iyy>7e-4</iyy><izz>4e-4</izz></inertia></inertial>
<collision name="c"><pose degrees="true">0 0 0 90 0 0</pose>
<geometry><cylinder><radius>0.05</radius><length>0.02</length></cylinder></geometry></collision></link>
<joint name="{0}" type="revolute"><pose relative_to="base">0 {1} -0.05 0 0 0.5</pose><parent>base</parent>
<child>{0}_link</child>
<axis><xyz expressed_in="base">0 1 0</xyz><limit><lower>-1e16</lower><upper>1e16</upper></limit></axis></joint>"""
SDF = f"""<sdf version="1.9"><world name="w"><model name="made_up"><pose>1 2 3 0 0 1</pose>
<frame name="mast"><pose>0 0 0.3 0 0 0.2</pose></frame><link name="base"><pose relative_to="mast"/><inertial>
<pose>0.02 0.01 0.03 0 0 0</pose><mass>5</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.08</izz></inertia></inertial>
<collision name="c"><geometry><box><size>0.4 0.3 0.1</size></box></geometry></collision></link>
{WHEEL.format("left", "0.2")}{WHEEL.format("right", "-0.2")}</model></world></sdf>"""


def vehicle(tmp_path: Path, name: str, text: str, answers: Answers | None = None) -> dict[str, Any]:
    (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "scene.toml").write_text(import_robot(tmp_path / name, answers or Answers()).text, encoding="utf-8")
    found: dict[str, Any] = read_toml(tmp_path / "scene.toml").plain()["vehicle"]
    return found


@pytest.mark.parametrize(("name", "text"), [("robot.xml", MJCF), ("robot.sdf", SDF)])
def test_the_same_robot_gives_the_same_vehicle(tmp_path: Path, name: str, text: str) -> None:
    expected = vehicle(tmp_path, "robot.urdf", robot(TWO_WHEELS))
    found = vehicle(tmp_path, name, text)
    wheels = found.pop("wheel"), expected.pop("wheel")
    assert found == pytest.approx(expected, abs=1e-9)
    for one, other in zip(*wheels, strict=True):
        assert one.pop("kind") == other.pop("kind")
        assert one == pytest.approx(other, abs=1e-6)


def test_one_of_several_models_is_taken_by_name(tmp_path: Path) -> None:
    two = SDF.replace("</model>", "</model><model name='other'><link name='lone'/></model>", 1)
    with pytest.raises(BadInput, match=r"has 2 models with links \(made_up, other\); name one with --model"):
        vehicle(tmp_path, "two.sdf", two)
    assert len(vehicle(tmp_path, "two.sdf", two, Answers(model="made_up"))["wheel"]) == 2


def test_poses_that_form_a_loop_are_one_line(tmp_path: Path) -> None:
    loop = SDF.replace('<frame name="mast"><pose>', '<frame name="mast"><pose relative_to="base">')
    with pytest.raises(BadInput, match=r"the pose of (mast|base) is relative to itself"):
        vehicle(tmp_path, "loop.sdf", loop)
