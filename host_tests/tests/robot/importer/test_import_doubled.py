"""What a robot's file says twice, leaves out, or cannot mean is told by link or joint, never taken in silence."""

from __future__ import annotations

from pathlib import Path

import pytest

from laconic.errors import BadInput
from laconic.robot.importer import Answers, Imported, import_robot
from made_up_robots import BOX, inertial, joint, link, robot, wheel

BASE = inertial(5.0, (0.1, 0.1, 0.08))
WHEELS = (wheel("left", "base", "0 0.2 -0.05"), wheel("right", "base", "0 -0.2 -0.05"))
SDF = """<sdf version="1.7"><model name="m"><link name="base"><inertial><mass>4</mass>{}</inertial></link>
</model></sdf>"""


def imported(folder: Path, text: str, name: str = "robot.urdf", **answers: object) -> Imported:
    (folder / name).write_text(text, encoding="utf-8")
    return import_robot(folder / name, Answers(**answers))  # type: ignore[arg-type]


@pytest.mark.parametrize(("old", "new", "words"), [
    ("<mass", '<mass value="50"/><mass', "link base: <inertial> has 2 <mass>; keep the one that holds"),
    ("<inertial>", '<inertial><mass value="7"/></inertial><inertial>', "link base: <link> has 2 <inertial>"),
    ("<geometry>", '<geometry><sphere radius="1"/>', "link base: one <geometry> has <sphere> and <box>"),
    ('<parent link="base"/>', '<parent link="base"/><parent link="left_wheel"/>', "<joint> has 2 <parent>"),
    ('<mass value="5.0"/>', "<mass/>", "link base: <mass> value: is missing; give a number"),
    ('<mass value="5.0"/>', '<mass vaule="5.0"/>', "link base: <mass> value: is missing; give a number")])
def test_a_part_that_is_there_twice_or_without_its_number_is_named(tmp_path: Path, old: str, new: str,
                                                                   words: str) -> None:
    text = robot(link("base", BASE, BOX), *WHEELS)
    assert old in text
    with pytest.raises(BadInput) as refused:
        imported(tmp_path, text.replace(old, new, 1))
    assert words in str(refused.value)


def test_a_mass_that_sdf_has_twice_is_named(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="link base: <inertial> has 2 <mass>"):
        imported(tmp_path, SDF.format("<mass>40</mass>"), "robot.sdf")


def test_what_a_simulator_alone_reads_may_stand_twice(tmp_path: Path) -> None:
    twice = "<gazebo><axis/><axis/></gazebo>"
    assert imported(tmp_path, robot(link("base", BASE, BOX, twice), *WHEELS)).text


def test_a_push_that_would_lead_aside_is_left_out(tmp_path: Path) -> None:
    one_ahead = (wheel("left", "base", "0 0.2 -0.05"), wheel("right", "base", "0.1 -0.2 -0.05", axis="0.7 0.7 0"))
    found = imported(tmp_path, robot(link("base", BASE, BOX), *one_ahead), rollers={"": "omni"})
    assert "push" not in "".join(found.assumptions)
    assert any("no inputs are given" in remark for remark in found.remarks)
    assert "[[input]]" not in found.text


def test_a_centre_of_mass_below_the_wheels_is_told_as_such(tmp_path: Path) -> None:
    high = (wheel("left", "base", "0 0.2 0.5"), wheel("right", "base", "0 -0.2 0.5"))
    with pytest.raises(BadInput, match="centre of mass lies .* below the lowest point of the wheels; see"):
        imported(tmp_path, robot(link("base", BASE, BOX), *high))


def test_an_inertia_that_no_body_has_is_remarked(tmp_path: Path) -> None:
    found = imported(tmp_path, robot(link("base", inertial(5.0, (0.1, 0.1, 10.0)), BOX), *WHEELS))
    assert any("link base has a principal moment of 10 kg·m², more than its" in each for each in found.remarks)


def test_a_wheel_that_is_named_twice_is_told_so(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="--wheel left: is given twice; name each wheel once"):
        imported(tmp_path, robot(link("base", BASE, BOX), *WHEELS), wheels=("left", "left"))


def test_a_joint_on_a_tilted_axle_is_said_to_be_no_wheel(tmp_path: Path) -> None:
    tilted = wheel("third", "base", "-0.2 0 -0.05", axis="0 1 0.3")
    found = imported(tmp_path, robot(link("base", BASE, BOX), *WHEELS, tilted))
    assert any("joint third turns round on an axle 16.7° from level, and is no wheel" in each for each in found.remarks)


def test_joints_of_one_kind_that_are_no_wheels_share_a_line(tmp_path: Path) -> None:
    others = [wheel("third", "base", "-0.2 0 -0.05", axis="0 1 0.3"),
              wheel("fourth", "base", "0.2 0 -0.05", axis="1 0 0.3"), wheel("up", "base", "0.1 0 0.3"),
              wheel("higher", "base", "0.1 0 0.5")]
    found = imported(tmp_path, robot(link("base", BASE, BOX), *WHEELS, *others))
    assert ("joints turn round on axles that are not level, and are no wheels: third (16.7°), fourth (16.7°); a "
            "wheel's axle is level") in found.remarks
    assert ("joints turn on level axles above the ground, and are no wheels: up (350 mm), higher (550 mm); --wheel "
            "JOINT for each wheel would say otherwise") in found.remarks


def test_hinges_within_limits_are_named_where_there_is_no_wheel(tmp_path: Path) -> None:
    hinge = joint("jl", "revolute", "base", "flap", "0 0.2 0", "0 0 0", "0 1 0",
                  '<limit lower="-1" upper="1" effort="1" velocity="1"/>')
    with pytest.raises(BadInput, match=r"turns round on a level axle .* \(jl: within limits\)"):
        imported(tmp_path, robot(link("base", BASE, BOX), link("flap", inertial(0.1, (1e-3,) * 3)), hinge))


def test_wheels_that_are_fixed_or_turn_upright_are_named_where_there_is_no_wheel(tmp_path: Path) -> None:
    still = [each.replace('type="continuous"', 'type="fixed"').replace("_link", "_wheel") for each in WHEELS]
    mast = link("top") + joint("mast", "continuous", "base", "top", axis="0 0 1")
    with pytest.raises(BadInput, match=r"z up\) \(left, right: fixed; mast: on an upright axle\), so there is no"):
        imported(tmp_path, robot(link("base", BASE, BOX), *still, mast))
