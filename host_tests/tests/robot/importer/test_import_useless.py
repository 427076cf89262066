"""Parts that a robot does not need cannot stop its import, and what is wrong is what the words say."""

from __future__ import annotations

import math
import os
import re
import time
from pathlib import Path
from typing import Any

import pytest

from laconic.errors import BadInput
from laconic.robot.importer.robot_tree import MOST_LINKS
from made_up_robots import (
    BOX,
    MJCF,
    SDF,
    THREE_AROUND,
    TWO_WHEELS,
    WHEEL,
    imported,
    inertial,
    joint,
    link,
    robot,
    wheel,
)

CYLINDER = '<geometry><cylinder radius="0.05" length="0.02"/></geometry>'
NAMESPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


def vehicle(folder: Path, text: str, name: str = "robot.urdf") -> dict[str, Any]:
    return imported(folder, text, name)[1].vehicle


USELESS = {
    "axis of a fixed joint without xyz": link("top") + joint("top_joint", "fixed", "base", "top").replace(
        '<axis xyz="0 1 0"/>', '<axis xzy="0 0 1"/>'),
    "axis of a fixed joint that is none": link("top") + joint("top_joint", "fixed", "base", "top", axis="up"),
    "old transmission": '<transmission type="x/Simple" name="t"><actuator name="m"/><joint name="left"/>'
                        "<motorTorqueConstant>1</motorTorqueConstant><pulsesPerRevolution>9e4</pulsesPerRevolution>"
                        "</transmission>",
    "transmission without a name": "<transmission><type/><joint/><actuator/></transmission>",
    "transmission of words": '<transmission name="t"><joint name="left"/><mechanicalReduction>fast'
                             "</mechanicalReduction></transmission>",
    "gazebo": '<gazebo/><gazebo reference="lost"><mu1>much</mu1></gazebo><gazebo><plugin/><static>true</static>'
              "</gazebo>",
    "undeclared prefixes": '<gazebo reference="left_link"><gz:x ignition:y="1"/></gazebo><sensor:camera/>',
    "material": '<material name="red"><color rgba="none"/></material><material/>',
    "limits of words": link("top") + joint("top_joint", "fixed", "base", "top",
                                           more='<limit effort="big"/><safety_controller k="x"/><calibration/>'),
    "drawing that is twice": link("top", "<visual><origin/><origin/><geometry><box/><sphere/></geometry></visual>")
                             + joint("top_joint", "fixed", "base", "top"),
    "ros2_control": '<ros2_control><joint/><joint name="lost"><command_interface/></joint></ros2_control>',
    "loop_joint": '<loop_joint name="l" type="x"><link1/><link2/></loop_joint><group name="g"/><disable_collisions/>'}


@pytest.mark.parametrize("name", USELESS)
def test_a_part_that_a_robot_does_not_need_does_not_stop_its_import(tmp_path: Path, name: str) -> None:
    whole, plain = (vehicle(tmp_path, text) for text in (robot(TWO_WHEELS, USELESS[name]), robot(TWO_WHEELS)))
    for wheels in (whole.pop("wheel"), plain.pop("wheel")):  # a transmission tells which are driven
        assert [(each["x_m"], each["y_m"], each["kind"]) for each in wheels] == [(0.0, 0.2, "fixed"),
                                                                                (0.0, -0.2, "fixed")]
    assert whole == plain


def test_an_axis_that_a_joint_needs_is_asked_for(tmp_path: Path) -> None:
    text = robot(TWO_WHEELS).replace('<axis xyz="0 1 0"/>', '<axis xzy="0 1 0"/>', 1)
    with pytest.raises(BadInput, match='joint left: <axis> has no xyz; give one such as xyz="0 1 0"'):
        imported(tmp_path, text)


GROUND = ('<model name="ground"><static>{}</static><link name="l"><collision name="c"><geometry><plane/></geometry>'
          "</collision></link></model>")


@pytest.mark.parametrize("static", ["true", "1", " true "])
def test_a_static_model_is_no_robot(tmp_path: Path, static: str) -> None:
    found, scene = imported(tmp_path, SDF.replace('<model name="made_up">', GROUND.format(static)
                                                  + '<model name="made_up">'), "world.sdf")
    assert scene.vehicle == vehicle(tmp_path, SDF, "robot.sdf")
    assert "of the models in the file made_up is the robot; left out are ground" in found.remarks


def test_a_world_of_static_models_says_so(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=r"all models are static \(ground\), as ground and walls are; name the robot"):
        imported(tmp_path, f'<sdf version="1.9"><world name="w">{GROUND.format("true")}</world></sdf>', "world.sdf")
    with pytest.raises(BadInput, match="no links but those of <include> model://cart"):
        imported(tmp_path, f'<sdf version="1.9"><world name="w">{GROUND.format("true")}<include><uri>model://cart'
                           "</uri></include></world></sdf>", "world.sdf")


def test_an_included_sensor_does_not_stop_a_model_and_is_named(tmp_path: Path) -> None:
    more = ('<include><name>laser</name><uri>model://laser</uri></include><joint name="hold" type="fixed">'
            "<parent>base</parent><child>laser::link</child></joint></model>")
    found, scene = imported(tmp_path, SDF.replace("</model>", more), "robot.sdf")
    assert len(scene.vehicle["wheel"]) == 2
    assert "<include> laser is not read; its mass is not counted" in found.remarks


NESTED = """<sdf version="1.9"><world name="w"><model name="made_up"><pose>1 2 3 0 0 1</pose>
<link name="base"><pose>0 0 0.3 0 0 0</pose><inertial><pose>0.02 0.01 0.03 0 0 0</pose><mass>5</mass>
<inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.08</izz></inertia></inertial>
<collision name="c"><geometry><box><size>0.4 0.3 0.1</size></box></geometry></collision></link>
{}</model></world></sdf>"""
UNIT = """<model name="{0}"><pose relative_to="base">0 {1} -0.05 0 0 0.5</pose>
<link name="hub"><inertial><mass>0.0001</mass></inertial></link>
<link name="tyre"><pose>0 0 0 0 0 -0.5</pose><inertial><mass>0.5</mass>
<inertia><ixx>4e-4</ixx><iyy>7e-4</iyy><izz>4e-4</izz></inertia></inertial>
<collision name="c"><pose degrees="true">0 0 0 90 0 0</pose>
<geometry><cylinder><radius>0.05</radius><length>0.02</length></cylinder></geometry></collision></link>
<joint name="turn" type="revolute"><parent>hub</parent><child>tyre</child><axis><xyz>0 1 0</xyz></axis></joint>
<plugin name="drive" filename="libdrive.so"><joint_name>turn</joint_name></plugin></model>
<joint name="hold_{0}" type="fixed"><parent>base</parent><child>{0}::hub</child></joint>"""


def test_a_model_inside_a_model_is_a_part_of_it(tmp_path: Path) -> None:
    """Each wheel is a model of its own: hub, tyre and the joint between them."""
    units = UNIT.format("left", "0.2") + UNIT.format("right", "-0.2")
    found, scene = imported(tmp_path, NESTED.format(units), "robot.sdf")
    whole = vehicle(tmp_path, SDF, "whole.sdf")
    assert [each.split(",")[0] for each in found.wheels] == ["wheel 1: left::turn", "wheel 2: right::turn"]
    assert scene.vehicle["mass_kg"] == pytest.approx(whole["mass_kg"], rel=1e-3)
    for one, other in zip(scene.vehicle["wheel"], whole["wheel"], strict=True):
        keys = ("x_m", "y_m", "axle_rad")
        assert [one[key] for key in keys] == pytest.approx([other[key] for key in keys])
    assert "driven = false" not in found.text  # the plugin of each unit commands its joint
    bar = '<link name="bar"><pose>0 0 0.3 0 0 0</pose><inertial><mass>0.001</mass></inertial></link>'
    deeper = NESTED.format(f'<model name="axle"><pose>0 0 0 0 0 0</pose>{units.replace("base", "bar")}{bar}</model>'
                           '<joint name="weld" type="fixed"><parent>base</parent><child>axle::bar</child></joint>')
    found, scene = imported(tmp_path, deeper, "robot.sdf")
    assert found.wheels[0].startswith("wheel 1: axle::left::turn, fixed, radius 0.05 m at (0, 0.2) m")


def test_a_model_of_models_alone_is_the_robot(tmp_path: Path) -> None:
    body = NESTED.format("").partition("</pose>")[2].rpartition("</model>")[0]
    units = UNIT.format("left", "0.2") + UNIT.format("right", "-0.2")
    units = units.replace('relative_to="base', 'relative_to="body::base').replace("<parent>base", "<parent>body::base")
    text = f'<sdf version="1.9"><model name="cart"><model name="body">{body}</model>{units}</model></sdf>'
    _, scene = imported(tmp_path, text, "robot.sdf")
    assert len(scene.vehicle["wheel"]) == 2
    assert scene.vehicle["wheel"][0]["y_m"] == pytest.approx(0.2)


def test_models_inside_models_without_an_end_are_refused(tmp_path: Path) -> None:
    text = '<model name="m"><link name="l"/>' * 3000 + "</model>" * 3000
    with pytest.raises(BadInput, match="has models inside models, 21 deep; more than 20 are not read"):
        imported(tmp_path, f'<sdf version="1.9">{text}</sdf>', "robot.sdf")
    placed = NESTED.format('<model name="m" placement_frame="l"><link name="l"/></model>')
    with pytest.raises(BadInput, match="model m has a placement_frame, which is not read; give the pose of its own"):
        imported(tmp_path, placed, "robot.sdf")


def test_joints_that_are_called_as_links_are_read(tmp_path: Path) -> None:
    text = SDF.replace("left_link", "left").replace("right_link", "right").replace(
        '<pose relative_to="left">', '<pose relative_to="base">0 0.2 -0.05 0 0 0</pose><pose>').replace(
        '<pose relative_to="right">', '<pose relative_to="base">0 -0.2 -0.05 0 0 0</pose><pose>')
    text = re.sub(r"</pose><pose>0 0 0 0 0 -0.5</pose>", "</pose>", text)
    assert len(vehicle(tmp_path, text, "robot.sdf")["wheel"]) == 2


def test_a_model_with_a_loop_and_a_loose_link_is_read_as_a_tree_and_says_so(tmp_path: Path) -> None:
    bar = '<link name="bar"/><link name="loose"/>' + "".join(
        f'<joint name="{name}" type="revolute"><parent>{parent}</parent><child>{child}</child></joint>'
        for name, parent, child in (("a", "base", "arm"), ("b", "base", "bar"), ("c", "bar", "arm")))
    found, scene = imported(tmp_path, SDF.replace("</model>", f'<link name="arm"/>{bar}</model>'), "robot.sdf")
    assert len(scene.vehicle["wheel"]) == 2
    assert "joints that close a loop are left out: c" in found.remarks
    assert "links that are not joined to the others are left out, with their mass: loose" in found.remarks


def test_axes_of_old_versions_are_in_the_frame_of_the_model(tmp_path: Path) -> None:
    turned = WHEEL.replace('<xyz expressed_in="base">', "<xyz>").replace("0 0 0.5</pose><parent>",
                                                                         "0 0 1.5</pose><parent>")
    def axles(version: str) -> list[float]:
        text = SDF.split(WHEEL.format("left", "0.2"))[0] + turned.format("left", "0.2") + turned.format(
            "right", "-0.2") + "</model></world></sdf>"
        text = re.sub("<cylinder>.*?</cylinder>", "<sphere><radius>0.05</radius></sphere>", text)
        text = text.replace('version="1.9"', f'version="{version}"').replace('<pose relative_to="mast"/>', "")
        found = imported(tmp_path, text, "robot.sdf", rollers={"": "none"}, friction_coefficient=0.5)[1].vehicle
        return [each["axle_rad"] for each in found["wheel"]]

    assert axles("1.4") == pytest.approx([-math.pi / 2.0] * 2)
    assert axles("1.5") == pytest.approx([1.5 - math.pi / 2.0] * 2)


@pytest.mark.parametrize(("text", "words"), [
    (f'<robot {NAMESPACE}><xacro:macro name="base" params="kg:=1">{link("a")}</xacro:macro></robot>',
     "only defines the macro base; import a file that calls it, such as one with <xacro:base …/>"),
    (f'<robot {NAMESPACE}><xacro:macro name="a"><link name="a"/></xacro:macro><xacro:property name="p" value="${{q}}"/>'
     '<xacro:macro name="b" params="x"/></robot>', "only defines the macros a, b; import a file that calls them"),
    (f'<robot {NAMESPACE}><xacro:lost/></robot>', "no macro lost is defined; include the file that defines it"),
    (f'<robot {NAMESPACE}><link name="${{a}}"/></robot>', "the expression ${a} uses a, which is not defined"),
    (f'<robot {NAMESPACE}><link name="${{1/0}}"/></robot>', "the expression ${1/0} divides by 0"),
    (f'<robot {NAMESPACE}><link name="${{1 +}}"/></robot>', "the expression ${1 +} is not written as one"),
    (f'<robot {NAMESPACE}><link name="${{[][1]}}"/></robot>', "the expression ${[][1]} cannot be evaluated"),
    (f'<robot {NAMESPACE}><link name="$(arg a)"/></robot>', "$(arg a) has no value; give --set a:=VALUE"),
    (f'<robot {NAMESPACE}><xacro:macro name="m" params="x"/><xacro:m/><link name="a"/></robot>',
     "a call of a macro lacks x; give it in macro m"),
    (f'<robot {NAMESPACE}><xacro:macro name="m"/><xacro:m y="1"/><link name="a"/></robot>',
     "a call of a macro gives y, which the macro does not take; take it out in macro m"),
    (f'<robot {NAMESPACE}><xacro:include filename="lost.xacro"/><link name="a"/></robot>', "no such file"),
    (f'<robot {NAMESPACE}><property name="m" value="1"/><link name="${{m}}"/></robot>',
     "writes <property> for <xacro:property>")])
def test_a_xacro_that_cannot_be_expanded_says_what_it_lacks(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(BadInput) as refused:
        imported(tmp_path, text, "robot.xacro")
    assert words in str(refused.value)
    assert "Error" not in str(refused.value) and "'NoneType'" not in str(refused.value)


ARM = (link("turret") + joint("pan", "continuous", "base", "turret", "0 0 0.1", axis="0 0 1")
       + link("upper", inertial(0.1, (1e-4,) * 3), '<collision><origin xyz="0.1 0 0"/><geometry><box size="0.2 0.02 '
              '0.02"/></geometry></collision>') + joint("lift", "continuous", "turret", "upper", "0 0 0.05"))


def hubs(mesh: str) -> str:
    """Wheels whose hub collides as a small cylinder, on which a mesh is fixed."""
    text = THREE_AROUND.replace('radius="0.05"', 'radius="0.02"')
    for k in range(3):
        text += link(f"tyre_{k}", inertial(0.1, (1e-4,) * 3), f'<collision><geometry><mesh filename="{mesh}"/>'
                     "</geometry></collision>") + joint(f"fix_{k}", "fixed", f"wheel_{k}_link", f"tyre_{k}")
    return text


@pytest.mark.parametrize(("mesh", "remedy"), [
    ("meshes/omni.stl", "--package NAME=FOLDER is a folder that has the meshes"),
    ("package://kit/meshes/omni.stl", "--package NAME=FOLDER says where")])
def test_wheels_whose_meshes_are_not_there_are_named_and_no_arm_is(tmp_path: Path, mesh: str, remedy: str) -> None:
    with pytest.raises(BadInput) as refused:
        imported(tmp_path, robot(hubs(mesh).replace("wheel_", "drive_"), ARM), rollers={"": "omni"})
    told = str(refused.value)
    assert f"drive_0, drive_1, drive_2, as their meshes were not read: {mesh} (not found)" in told.replace(
        ": no shape tells the wheel's radius", "")
    assert "--radius METRES" in told and remedy in told
    assert "swivel" not in told and "lift" not in told


def test_casters_that_are_there_do_not_hide_wheels_whose_meshes_are_not(tmp_path: Path) -> None:
    caster = (link("fork", inertial(0.1, (1e-4,) * 3)) + joint("swivel", "continuous", "base", "fork", "-0.2 0 0",
                                                               axis="0 0 1")
              + wheel("caster", "fork", "-0.03 0 -0.07", radius=0.03))
    lost = TWO_WHEELS.replace(CYLINDER, '<geometry><mesh filename="lost.stl"/></geometry>')
    with pytest.raises(BadInput, match="joints left, right: no shape tells the wheel's radius, as their meshes were "
                                       r"not read: lost\.stl \(not found\); give --radius METRES"):
        imported(tmp_path, robot(lost, caster))


def test_a_mesh_is_looked_for_in_the_folders_that_are_given(tmp_path: Path) -> None:
    (tmp_path / "kit").mkdir()
    (tmp_path / "robot").mkdir()
    turn = [k * math.pi / 30.0 for k in range(60)]
    points = "".join(f"v {0.05 * math.cos(a)} {y} {0.05 * math.sin(a)}\n" for a in turn for y in (-0.01, 0.01))
    (tmp_path / "kit" / "w.obj").write_text(points + "".join(f"f {k} {k + 1} {k + 2}\n" for k in range(1, 118)))
    text = robot(TWO_WHEELS).replace(CYLINDER, '<geometry><mesh filename="w.obj"/></geometry>').replace(
        '<origin rpy="1.5707963267948966 0 0"/>', "")
    _, scene = imported(tmp_path / "robot", text, packages={"any": tmp_path / "kit"})
    assert scene.vehicle["wheel_radius_m"] == pytest.approx(0.05)


@pytest.mark.parametrize(("mu", "mu2", "direction", "roller_deg"), [
    ("1", "0", "1 -1 0", [45.0, -45.0]), ("0", "1", "1 1 0", [45.0, -45.0]), ("1e5", "0.01", "1 -1 0", [45.0, -45.0]),
    ("1", "0", "1 -1.002 0", [45.0, -45.0])])
def test_a_direction_without_friction_is_that_of_mecanum_rollers(
        tmp_path: Path, mu: str, mu2: str, direction: str, roller_deg: list[float]) -> None:
    x, y, z = direction.split()
    mirrored = " ".join((x, y[1:] if y.startswith("-") else f"-{y}", z))
    text = SDF
    for side, way in (("left", direction), ("right", mirrored)):
        head, mark, tail = text.partition(f'<link name="{side}_link">')
        surface = (f"<surface><friction><ode><mu>{mu}</mu><mu2>{mu2}</mu2><fdir1 gz:expressed_in=\"base\">{way}</fdir1>"
                   "</ode></friction></surface></collision>")
        text = head + mark + tail.replace("</collision>", surface, 1)
    wheels = vehicle(tmp_path, text, "robot.sdf")["wheel"]
    assert [math.degrees(each["roller_rad"]) for each in wheels] == pytest.approx(roller_deg)


@pytest.mark.parametrize(("friction", "kinds"), [
    ("<mu1>1</mu1><mu2>0</mu2><fdir1>1 0 0</fdir1>", ["roller", "roller"]),   # grips ahead alone: an omni wheel
    ("<mu1>1</mu1><mu2>1</mu2><fdir1>1 1 0</fdir1>", ["fixed", "fixed"]),     # grips both ways
    ("<mu1>1</mu1><mu2>0</mu2>", ["fixed", "fixed"]),                         # which way is not told
    ("<mu1>1</mu1><mu2>0</mu2><fdir1>0 1 0</fdir1>", ["fixed", "fixed"])])    # would push nothing
def test_friction_that_gazebo_gives_a_urdf_tells_rollers(tmp_path: Path, friction: str, kinds: list[str]) -> None:
    surfaces = "".join(f'<gazebo reference="{side}_link">{friction}</gazebo>' for side in ("left", "right"))
    found = vehicle(tmp_path, robot(TWO_WHEELS, surfaces))["wheel"]
    assert ["fixed" if each["kind"] == "fixed" else "roller" for each in found] == kinds
    assert all(abs(each["roller_rad"]) == pytest.approx(math.pi / 2.0) for each in found if each["kind"] != "fixed")


def outside(folder: Path) -> tuple[Path, Path]:
    """A folder for the robot, and a mesh beside it that must not be opened."""
    (folder / "robot").mkdir()
    (folder / "secret.obj").write_text("v 0 0 1\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", encoding="utf-8")
    return folder / "robot", folder / "secret.obj"


@pytest.mark.parametrize("name", ["../secret.obj", "a/../../secret.obj", "{absolute}", "file://{absolute}", "link.obj",
                                  "package://robot/../secret.obj", "package://../secret.obj", "model://robot/link.obj"])
def test_a_mesh_that_lies_outside_the_robots_folder_is_not_opened(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    folder, secret = outside(tmp_path)
    (folder / "a").mkdir()
    (folder / "link.obj").symlink_to(secret)
    opened: list[object] = []
    monkeypatch.setattr("laconic.robot.importer.bounded.Reader.ask", lambda _, __, path: opened.append(path))
    mesh = name.format(absolute=secret)
    text = robot(TWO_WHEELS).replace(CYLINDER, f'<geometry><mesh filename="{mesh}"/></geometry>')
    with pytest.raises(BadInput) as refused:
        imported(folder, text)
    assert not opened
    assert f"{mesh} (lies outside the robot's folder and is not opened" in str(refused.value) or (
        f"{mesh} (not found)" in str(refused.value) and name == "package://../secret.obj")


@pytest.mark.parametrize("name", ["/etc/passwd", "../../../../../../../../etc/passwd", "package://etc/passwd"])
def test_a_file_of_the_system_is_no_mesh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    opened: list[object] = []
    monkeypatch.setattr("laconic.robot.importer.bounded.Reader.ask", lambda _, __, path: opened.append(path))
    with pytest.raises(BadInput):
        imported(tmp_path, robot(TWO_WHEELS).replace(CYLINDER, f'<geometry><mesh filename="{name}"/></geometry>'))
    assert not opened


@pytest.mark.parametrize("layout", ["urdf", "package.xml"])
def test_meshes_beside_the_folder_of_the_urdf_are_the_robots(tmp_path: Path, layout: str) -> None:
    inner = tmp_path / "kit" / ("urdf" if layout == "urdf" else "any") / ("" if layout == "urdf" else "deep")
    (tmp_path / "kit" / "meshes").mkdir(parents=True)
    inner.mkdir(parents=True)
    if layout == "package.xml":
        (tmp_path / "kit" / "package.xml").write_text("<package/>")
    mesh = tmp_path / "kit" / "meshes" / "w.obj"
    mesh.write_text("v 0.05 0 0\nv -0.05 0 0\nv 0 0 0.05\nv 0 0 -0.05\nf 1 2 3\nf 1 2 4\n", encoding="utf-8")
    name = os.path.relpath(mesh, inner)
    text = robot(TWO_WHEELS).replace(CYLINDER, f'<geometry><mesh filename="{name}"/></geometry>').replace(
        '<origin rpy="1.5707963267948966 0 0"/>', "")
    assert imported(inner, text)[1].vehicle["wheel_radius_m"] == pytest.approx(0.05)


@pytest.mark.parametrize(("part", "words"), [
    ('<asset><mesh name="m" file="../secret.obj"/></asset>', "<mesh> ../secret.obj: lies outside the robot's folder"),
    ('<compiler meshdir=".."/><asset><mesh name="m" file="secret.obj"/></asset>', "<mesh> secret.obj: lies outside"),
    ('<include file="../other.xml"/>', "<include> ../other.xml: lies outside the robot's folder and is not opened"),
    ('<asset><texture name="t" type="2d" file="/etc/passwd"/></asset>', "<texture> /etc/passwd: lies outside")])
def test_a_file_of_an_mjcf_that_lies_outside_its_folder_is_not_opened(tmp_path: Path, part: str, words: str) -> None:
    folder, _ = outside(tmp_path)
    with pytest.raises(BadInput) as refused:
        imported(folder, MJCF.replace("<worldbody>", f"{part}<worldbody>"), "robot.xml")
    assert words in str(refused.value)


@pytest.mark.parametrize(("name", "text"), [
    ("robot.urdf", robot(*(link(f"l{k}") for k in range(MOST_LINKS + 1)))),
    ("robot.sdf", SDF.replace("</model>", "".join(f'<link name="x{k}"/>' for k in range(MOST_LINKS)) + "</model>")),
    ("robot.xml", MJCF.replace("</worldbody>", "<body/>" * MOST_LINKS + "</worldbody>"))])
def test_more_links_than_any_robot_has_are_refused_at_once(tmp_path: Path, name: str, text: str) -> None:
    began = time.process_time()
    with pytest.raises(BadInput, match=r"has \d+ links, more than the 5000 that are read; take out those that are not"):
        imported(tmp_path, text, name)
    assert time.process_time() - began < 2.0


def test_more_wheels_than_the_core_has_room_for_are_refused_at_once(tmp_path: Path) -> None:
    body = link("base", inertial(5.0, (0.1, 0.1, 0.08)), BOX)
    with pytest.raises(BadInput, match=r"has 30 wheels, and this build of the core has room for \d+; give --wheel"):
        imported(tmp_path, robot(body, *(wheel(f"w{k}", "base", f"{0.1 * k} 0.2 -0.05") for k in range(30))))
    with pytest.raises(BadInput, match="100 joints have shapes that reach the ground, more than 64 wheels"):
        imported(tmp_path, robot(body, *(wheel(f"w{k}", "base", f"{0.1 * k} 0.2 -0.05") for k in range(100))))


@pytest.mark.parametrize("head", [
    "<!-- a robot -- with two wheels -->", '<!-- a robot -->\n<?xml version="1.0"?>\n',
    '\n<?xml version="1.0" encoding="utf-8"?>', '<!-- one -- two\nthree -->\n<?xml version="1.0"?>'])
def test_what_simulators_read_beyond_xml_is_read(tmp_path: Path, head: str) -> None:
    """Comments with -- in them, and the first line of XML after comments or blank lines."""
    assert len(vehicle(tmp_path, head + SDF, "robot.sdf")["wheel"]) == 2
    assert len(vehicle(tmp_path, head + robot(TWO_WHEELS), "robot.urdf")["wheel"]) == 2
    broken = head + robot(TWO_WHEELS).replace("</link>", "</lnk>", 1)
    with pytest.raises(BadInput, match=f"line {1 + head.count(chr(10))}, column .*: the element that is closed is not"):
        imported(tmp_path, broken)


CAR = f"""<sdf version="1.9"><model name="car"><link name="base"><inertial><mass>5</mass><inertia><ixx>0.1</ixx>
<iyy>0.1</iyy><izz>0.08</izz></inertia></inertial></link>{WHEEL.format("left", "0.2")}{WHEEL.format("right", "-0.2")}
{{}}</model></sdf>"""
LASER = """<sdf version="1.9"><model name="sensor"><link name="body"><inertial><mass>2</mass><inertia><ixx>0.01</ixx>
<iyy>0.01</iyy><izz>0.01</izz></inertia></inertial></link></model></sdf>"""
JOINED = ('<joint name="hold" type="fixed"><parent>base</parent><child>laser::body</child></joint><include><name>laser'
          "</name><uri>{}</uri><pose>0.3 0 0.1 0 0 0</pose></include>")
CONFIG = '<model><name>kit</name><sdf version="1.9">kit.sdf</sdf></model>'


@pytest.mark.parametrize("uri", ["model://kit", "kit/kit.sdf", "kit", "file://{folder}/kit/kit.sdf"])
def test_an_included_model_that_is_near_is_read_with_its_mass_and_its_pose(tmp_path: Path, uri: str) -> None:
    (tmp_path / "kit").mkdir()
    (tmp_path / "kit" / "kit.sdf").write_text(LASER, encoding="utf-8")
    (tmp_path / "kit" / "model.config").write_text(CONFIG, encoding="utf-8")
    found, scene = imported(tmp_path, CAR.format(JOINED.format(uri.format(folder=tmp_path))), "car.sdf")
    assert not any("<include>" in each for each in found.remarks)
    assert scene.vehicle["mass_kg"] == pytest.approx(8.0)  # 5 + 2 + 2 · 0.5 kg
    assert scene.vehicle["com_x_m"] == pytest.approx(2.0 * 0.3 / 8.0)


def test_a_world_of_includes_alone_has_the_robot_of_a_file_that_is_near(tmp_path: Path) -> None:
    (tmp_path / "cart").mkdir()
    (tmp_path / "cart" / "model.sdf").write_text(CAR.format(""), encoding="utf-8")
    world = (f'<sdf version="1.9"><world name="w">{GROUND.format("true")}<include><uri>model://cart</uri>'
             "<name>mine</name></include></world></sdf>")
    found, scene = imported(tmp_path, world, "world.sdf")
    assert found.name == "mine" and len(scene.vehicle["wheel"]) == 2


def test_an_include_outside_the_robots_folder_or_without_end_is_not_opened(tmp_path: Path) -> None:
    inside = tmp_path / "robot"
    inside.mkdir()
    (tmp_path / "laser.sdf").write_text(LASER, encoding="utf-8")
    found, scene = imported(inside, CAR.format(JOINED.format("../laser.sdf")), "car.sdf")
    assert "<include> laser is not read; its mass is not counted" in found.remarks
    assert scene.vehicle["mass_kg"] == pytest.approx(6.0)
    itself = CAR.format("<include><name>again</name><uri>car.sdf</uri></include>")
    with pytest.raises(BadInput, match="includes models that include models"):
        imported(inside, itself, "car.sdf")
