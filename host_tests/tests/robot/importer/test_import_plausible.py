"""Numbers that no robot has are counted as they are given, and told in output and comment."""

from __future__ import annotations

from pathlib import Path

import pytest

from laconic.robot.importer import Answers, Imported, import_robot
from made_up_robots import BOX, TWO_WHEELS, inertial, link, robot, wheel

SOUND = (0.1, 0.1, 0.08)
IN_MM = '<collision><geometry><box size="400 300 100"/></geometry></collision>'
MILLIMETRES = "if the file is in millimetres, give it in metres"


def imported(folder: Path, text: str) -> Imported:
    (folder / "robot.urdf").write_text(text, encoding="utf-8")
    return import_robot(folder / "robot.urdf", Answers())


def doubts(found: Imported) -> list[str]:
    words = ("no body has", "air;", "as of their mass at")
    return [remark for remark in found.remarks if any(each in remark for each in words)]


def cart(moments: tuple[float, float, float] = SOUND, mass: float = 5.0, scale: float = 1.0, shape: str = BOX) -> str:
    wheels = (wheel(name, "base", f"0 {side * scale} {-0.05 * scale}", radius=0.05 * scale)
              for name, side in (("left", 0.2), ("right", -0.2)))
    return robot(link("base", inertial(mass, moments), shape), *wheels)


def test_a_sound_robot_raises_no_doubt(tmp_path: Path) -> None:
    assert doubts(imported(tmp_path, robot(*TWO_WHEELS))) == []


@pytest.mark.parametrize(("text", "words"), [
    (cart(scale=1000.0, shape=IN_MM), "a wheel's radius is 50 m, and the whole robot has 6 kg, less than so much air"),
    (cart(scale=100.0), "a wheel's radius is 5 m, and the whole robot has 6 kg"),
    (cart((1e5, 1e5, 1e5)), "the yaw inertia of all links is 1e+05 kg·m², as of their mass at 129 m, and the wheels"),
    (cart((0.1, 0.1, 10.0)), "link base has a principal moment of 10 kg·m², more than its other two together"),
    (cart((0.1, -0.1, 0.1)), "link base has a principal moment of -0.1 kg·m², which no body has; it is counted as")])
def test_what_no_robot_has_is_told_in_output_and_comment(tmp_path: Path, text: str, words: str) -> None:
    found = imported(tmp_path, text)
    assert [words in remark for remark in doubts(found)].count(True) == 1
    assert words in found.text.replace("\n#   ", " ")


@pytest.mark.parametrize(("radius_m", "mass_kg", "is_told"), [(1.0, 1.5, False), (1.0, 0.1, True), (0.5, 0.2, False)])
def test_the_bound_is_the_air_in_a_cube_as_wide_as_a_wheels_radius(tmp_path: Path, radius_m: float, mass_kg: float,
                                                                 is_told: bool) -> None:
    text = cart((0.1 * mass_kg,) * 3, mass_kg, radius_m / 0.05).replace('<mass value="0.5"/>', '<mass value="0.0001"/>')
    assert any(MILLIMETRES in each for each in imported(tmp_path, text).remarks) is is_told


@pytest.mark.parametrize(("metres", "is_told"), [(1.0, False), (3.0, True)])
def test_the_bound_is_ten_times_the_way_to_the_farthest_rim(tmp_path: Path, metres: float, is_told: bool) -> None:
    told = any("as of their mass at" in each for each in imported(tmp_path, cart((5.0 * metres**2,) * 3)).remarks)
    assert told is is_told


@pytest.mark.parametrize(("moments", "words"), [
    ((0.1, 0.1, 0.0), "link base has a principal moment of 0 kg·m² next to 0.1 kg·m², as only a line has (izz = 0)"),
    ((0.0, 0.1, 0.1), "as only a line has (ixx = 0)")])
def test_a_moment_that_was_left_zero_is_told(tmp_path: Path, moments: tuple[float, float, float], words: str) -> None:
    assert sum(words in remark for remark in imported(tmp_path, cart(moments)).remarks) == 1
    assert not any("only a line" in remark for remark in imported(tmp_path, cart()).remarks)


@pytest.mark.parametrize(("right_m", "is_told"), [(0.05, False), (0.0501, False), (0.06, True)])
def test_wheels_of_two_sizes_on_one_axle_are_told(tmp_path: Path, right_m: float, is_told: bool) -> None:
    text = robot(link("base", inertial(5.0, SOUND), BOX), wheel("left", "base", "0 0.2 -0.05"),
                 wheel("right", "base", f"0 -0.2 {right_m - 0.1}", radius=right_m))
    told = [remark for remark in imported(tmp_path, text).remarks if "are on one axle, and their radii" in remark]
    assert len(told) == is_told
    assert not told or "radii are 0.05 m and 0.06 m; if they are equal, --radius right=METRES" in told[0]
    answered = import_robot(tmp_path / "robot.urdf", Answers(radius_m={"left": 0.05, "right": right_m}))
    assert not any("are on one axle" in remark for remark in answered.remarks)
