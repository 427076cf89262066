"""What a file cannot tell is asked for, and a file that is wrong gives one line; never a guess, never a traceback."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from laconic.cli.main import run
from made_up_robots import (
    BOX,
    FOUR_WHEELS,
    MJCF,
    SDF,
    THREE_AROUND,
    TWO_WHEELS,
    inertial,
    joint,
    link,
    robot,
    wheel,
)

GOOD = robot(TWO_WHEELS)
NAMESPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
CYLINDER = '<geometry><cylinder radius="0.05" length="0.02"/></geometry>'
STEERED = robot(link("base", inertial(5.0, (0.1, 0.1, 0.08)), BOX), link("fork"),
                joint("steer", "continuous", "base", "fork", axis="0 0 1"), wheel("front", "fork", "0 0 -0.05"))


def meshed(name: str) -> str:
    """GOOD, with this mesh for its wheels."""
    return GOOD.replace(CYLINDER, f'<geometry><mesh filename="{name}"/></geometry>')


WRONG: list[tuple[str, str, list[str], str]] = [
    ("not XML", "robot", [], "is no URDF that can be read"),
    ("empty", "", [], "is no URDF that can be read"),
    ("cut off", GOOD[:300], [], "is no URDF that can be read"),
    ("another root", "<sdf/>", [], "is no URDF that can be read"),
    ("no links", "<robot name='r'/>", [], "has no <link>"),
    ("two bases", GOOD.replace("</robot>", '<link name="loose"/></robot>'), [], "hang on no joint"),
    ("a loop", GOOD.replace("</robot>", joint("back", "fixed", "left_link", "base") + "</robot>"), [],
     "hang on no joint"),
    ("two parents", GOOD.replace("</robot>", joint("again", "fixed", "base", "left_link") + "</robot>"), [],
     "already hangs"),
    ("link twice", GOOD.replace("</robot>", link("left_link") + "</robot>"), [], "is there twice"),
    ("joint twice", GOOD.replace('name="right" ', 'name="left" '), [], "is there twice"),
    ("joint to nothing", GOOD.replace('<child link="left_link"/>', '<child link="lost"/>'), [], "link"),
    ("unknown type", GOOD.replace("continuous", "bouncing"), [], "bouncing"),
    ("axis 0", GOOD.replace("0 1 0", "0 0 0"), [], "axis is 0"),
    ("axis of two", GOOD.replace("0 1 0", "0 1"), [], "joint left: <axis> xyz: has 2 numbers; give 3"),
    ("nan place", GOOD.replace("0 0.2 -0.05", "0 nan -0.05"), [], "<origin> xyz: must be finite"),
    ("infinite mass", GOOD.replace("5.0", "inf"), [], "mass: must be finite"),
    ("mass below 0", GOOD.replace("5.0", "-5.0"), [], "cannot be below 0"),
    ("mass in words", GOOD.replace("5.0", "heavy"), [], "heavy"),
    ("no mass at all", re.sub("<inertial>.*?</inertial>", "", GOOD), ["--wheel-inertia", "1e-3"],
     "all links are without mass"),
    ("no yaw inertia", re.sub("izz=\"[^\"]*\"", 'izz="-9"', GOOD), [], "yaw inertia of all links is"),
    ("wheel without inertia", GOOD.replace('iyy="0.0007"', 'iyy="0"'), [], "--wheel-inertia left=KGM2"),
    ("no shapes", re.sub("<collision>.*?</collision>", "", GOOD), [], "no shape tells the radius of left, right"),
    ("one wheel without shape", GOOD.replace(CYLINDER, "<geometry><sphere radius='0'/></geometry>", 1).replace(
        'name="left"', 'name="left_wheel"'), [], "its shapes have the radius 0"),
    ("radius 0", GOOD.replace('radius="0.05"', 'radius="0"'), [], "the shapes of left, right have the radius 0; give"),
    ("radius below 0", GOOD.replace('radius="0.05"', 'radius="-0.05"'), [],
     "link left_link: geometry: radius is -0.05 m; it cannot be below 0"),
    ("number of Python", GOOD.replace('radius="0.05"', 'radius="0_05"'), [],
     "link left_link: <cylinder> radius: '0_05' is no number; give one such as 0.5"),
    ("place of Python", GOOD.replace("0 0.2 -0.05", "0 0_2 -0.05"), [], "<origin> xyz: '0_2' is no number"),
    ("radius of Python", GOOD, ["--radius", "0_1"], "--radius 0_1: '0_1' is no number"),
    ("mimics itself", GOOD.replace("<axis", '<mimic joint="left"/><axis', 1), [],
     "joint left: mimics itself; name another joint, or take the mimic out"),
    ("mimic in a circle", re.sub(
        '<joint name="(left|right)" type="continuous">',
        lambda found: found[0] + f'<mimic joint="{"right" if found[1] == "left" else "left"}"/>', GOOD), [],
     "joint left: mimics itself, by way of right"),
    ("one of two without its mesh", GOOD.replace(CYLINDER, '<geometry><mesh filename="lost.stl"/></geometry>', 1), [],
     "joint left: no shape tells the wheel's radius, as their meshes were not read: lost.stl (not found); give "
     "--radius left=METRES"),
    ("meshes of a package that is not there", GOOD.replace(
        CYLINDER, '<geometry><mesh filename="package://kit/lost.stl"/></geometry>'), [],
     "no shape tells the radius of left, right, as their meshes were not read: package://kit/lost.stl (not found), "
     "--package NAME=FOLDER says where; give --radius METRES"),
    ("a model of a URDF", GOOD, ["--model", "q"], "--model: "),
    ("no wheels", GOOD.replace("continuous", "fixed"), [], "no joint turns round on a level axle"),
    ("axles upright", GOOD.replace("0 1 0", "0 0 1"), [], "no joint turns round on a level axle"),
    ("all steered", STEERED, ["--no-hinges"], "all wheels swivel (front)"),
    ("four across", robot(FOUR_WHEELS), [], "--rollers none with --friction"),
    ("three around the middle", robot(THREE_AROUND), [],
     "give --rollers omni, --rollers JOINT=DEGREES, or --rollers none"),
    ("skid without friction", robot(FOUR_WHEELS), ["--rollers", "none"],
     "robot.urdf: plain wheels on parallel axles that are not one line only drive straight, whatever motors do; "
     "give --friction MU, so that wheels may slip, or --rollers"),
    ("a mesh that is a device", meshed("file:///dev/null"), [],
     "as their meshes were not read: file:///dev/null (is no regular file); give --radius METRES"),
    ("a mesh that is a folder", meshed("."), [], "were not read: . (is a directory); give --radius METRES"),
    ("a mesh without a name", meshed(""), [], "were not read: <mesh> (names no file); give --radius METRES"),
    ("a mesh that is none", meshed("robot.urdf"), [], "were not read: robot.urdf (cannot be read ("),
    ("mecanum of two", GOOD, ["--rollers", "mecanum"], "is for four wheels at the corners"),
    ("no such wheel", GOOD, ["--wheel", "lefft"], "did you mean left?"),
    ("a wheel that is none", robot(TWO_WHEELS, link("lid"), joint("hinge", "fixed", "base", "lid")),
     ["--wheel", "hinge"],
     "does not turn on a level axle"),
    ("radius of no wheel", GOOD, ["--radius", "middle=0.1"], "--radius middle=…: is no wheel"),
    ("radius below 0", GOOD, ["--radius", "-1"], "--radius -1: must be above 0"),
    ("radius in words", GOOD, ["--radius", "left=big"], "'big' is no number"),
    ("radius twice", GOOD, ["--radius", "0.1", "--radius", "0.2"], "is given twice"),
    ("unknown rollers", GOOD, ["--rollers", "balls"], "give none, omni, mecanum, or the angle"),
    ("friction below 0", GOOD, ["--friction", "-0.1"], "--friction -0.1: must be above 0"),
    ("arguments of no xacro", GOOD, ["--set", "a:=1"], "is no xacro file"),
    ("argument without sign", GOOD, ["--set", "a=1"], "give NAME:=VALUE"),
    ("damping below 0", GOOD.replace("</joint>", '<dynamics damping="-0.1"/></joint>', 1), [],
     "joint left: damping is -0.1 N·m·s/rad; it cannot be below 0"),
    ("friction below 0", GOOD.replace("</joint>", '<dynamics friction="-2"/></joint>', 1), [],
     "joint left: friction is -2 N·m; it cannot be below 0"),
    ("size beyond all", GOOD.replace("0.4 0.3 0.1", "1e200 0.3 0.1"), [], "<box> size: 1e+200 is beyond 1e+30"),
    ("mimics nothing", GOOD.replace("</joint>", '<mimic joint="rigth"/></joint>', 1), [],
     "joint left: mimics joint rigth, which is not there; did you mean right?"),
    ("wheels in one place", GOOD.replace("0 -0.2 -0.05", "0 0.2 -0.05"), [],
     "joint right: its wheel is in the place of left's, (0, 0.2) m; give it an origin of its own"),
    ("package without folder", GOOD, ["--package", "kit"], "give NAME=VALUE"),
]


@pytest.mark.parametrize(("text", "options", "words"), [each[1:] for each in WRONG], ids=[each[0] for each in WRONG])
def test_what_cannot_be_used_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str,
                                         options: list[str], words: str) -> None:
    (tmp_path / "robot.urdf").write_text(text, encoding="utf-8")
    assert run(["import", str(tmp_path / "robot.urdf"), "-o", str(tmp_path / "robot.toml"), *options]) == 2
    told = capsys.readouterr().err
    assert words in told
    assert told.count("\n") == 1
    assert "unexpected" not in told
    assert not (tmp_path / "robot.toml").exists()


@pytest.mark.parametrize(("name", "text", "words"), [
    ("robot.xacro", f"<robot {NAMESPACE}><xacro:lost/></robot>", "xacro cannot expand it"),
    ("robot.xacro", f'<robot {NAMESPACE}><xacro:include filename="$(find kit)/a"/></robot>',
     "package kit is not beside or above the file; give --package kit=FOLDER"),
    ("robot.sdf", "<sdf version='1.9'/>", "has 0 models with links"),
    ("robot.sdf", SDF.replace('version="1.9"', 'version="99"'),
     "<sdf> version '99' is not known; known are 1.0 to 1.12"),
    ("robot.sdf", SDF.replace("<frame", '<frame name="a"><pose relative_to="b"/></frame>'
                              '<frame name="b"><pose relative_to="a"/></frame><frame', 1),
     "the pose of a is relative to itself; poses may not form a loop"),
    ("robot.sdf", SDF.replace("<limit>", '<mimic joint="left"/><limit>', 1), "joint left: mimics itself"),
    ("robot.sdf", SDF.replace("<radius>0.05", "<radius>-1", 1), "geometry: radius is -1 m; it cannot be below 0"),
    ("robot.sdf", "<robot/>", "SDF begins with <sdf>"),
    ("robot.sdf", "<sdf><world><include><uri>model://turtle</uri></include></world></sdf>",
     "has no links but those of <include> model://turtle, which is not read; give the file of that model"),
    ("robot.sdf", SDF.replace("</limit>", "</limit><dynamics><damping>-3</damping></dynamics>"),
     "damping is -3 N·m·s/rad; it cannot be below 0"),
    ("robot.xml", MJCF.replace('mass="5"', 'mass="-5"'), "MuJoCo cannot read it"),
    ("robot.xml", MJCF.replace('<geom type="box"', '<geom mass="nan" type="box"'),
     '<geom>: mass="nan" is not finite; give a number'),
    ("robot.xml", MJCF.replace('pos="0 0.2 -0.05"', 'pos="0 nan -0.05"'), "body left_link: place: must be finite"),
    ("robot.xml", MJCF.replace("0.2 0.15 0.05", "1e200 0.15 0.05"),
     "body base: size of a geom: 1e+200 is beyond 1e+30; give SI units"),
    ("robot.xml", MJCF.replace('axis="0 1 0"', 'axis="0 1 0" damping="-1"'), "joint left: damping is -1"),
    ("robot.sdf", "<sdf", "is no XML"),
    ("robot.xml", "<mujoco><worldbody/></mujoco>", "has no body"),
    ("robot.xml", "<mujoco><worldbody><body><geom/></body></worldbody></mujoco>", "MuJoCo cannot read it"),
    ("robot.xml", "<html/>", "a robot begins with <robot> (URDF, xacro), <mujoco> or <sdf>"),
    ("robot.txt", "wheels", "is no XML; give a URDF, xacro, MJCF or SDF file")])
def test_other_formats_are_one_line_too(tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, text: str,
                                        words: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / name).write_text(text, encoding="utf-8")
    assert run(["import", str(tmp_path / name), "-o", str(tmp_path / "robot.toml")]) == 2
    told = capsys.readouterr().err
    assert words in told
    assert told.count("\n") == 1
    assert "unexpected" not in told
    assert [each.name for each in tmp_path.iterdir()] == [name]  # no log of a library


def test_a_file_that_is_not_there_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("lost.urdf", "lost.xacro", "lost.sdf", "lost.xml"):
        assert run(["import", str(tmp_path / name), "-o", str(tmp_path / "robot.toml")]) == 2
        assert capsys.readouterr().err.count("\n") == 1


def test_a_line_break_in_a_name_ends_no_comment(tmp_path: Path) -> None:
    named = GOOD.replace('name="left"', 'name="left&#10;locked = true #"').replace("left_link", "left&#13;&#127;link")
    (tmp_path / "robot.urdf").write_text(named, encoding="utf-8")
    assert run(["import", str(tmp_path / "robot.urdf"), "-o", str(tmp_path / "robot.toml")]) == 0
    text = (tmp_path / "robot.toml").read_text(encoding="utf-8")
    assert "left\\nlocked = true #" in text
    assert "\nlocked" not in text
