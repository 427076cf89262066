"""Robots as URDF text, put together from parts, and what MuJoCo says of their masses."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from laconic.robot.importer import Answers, Imported, import_robot
from laconic.scene import Scene, read_scene

BOX = '<collision><geometry><box size="0.4 0.3 0.1"/></geometry></collision>'


def inertial(mass: float, moments: tuple[float, float, float], xyz: str = "0 0 0", rpy: str = "0 0 0",
             ixy: float = 0.0) -> str:
    ixx, iyy, izz = moments
    return (f'<inertial><origin xyz="{xyz}" rpy="{rpy}"/><mass value="{mass}"/>'
            f'<inertia ixx="{ixx}" iyy="{iyy}" izz="{izz}" ixy="{ixy}" ixz="0" iyz="0"/></inertial>')


def link(name: str, *parts: str) -> str:
    return f'<link name="{name}">{"".join(parts)}</link>'


def joint(name: str, kind: str, parent: str, child: str, xyz: str = "0 0 0", rpy: str = "0 0 0", axis: str = "0 1 0",
          more: str = "") -> str:
    return (f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/>{more}</joint>')


def wheel(name: str, parent: str, xyz: str, rpy: str = "0 0 0", axis: str = "0 1 0", radius: float = 0.05) -> str:
    """A cylinder whose axis is y of the joint, where `axis` does not say otherwise."""
    along = next(k for k, part in enumerate(axis.split()) if part != "0")
    lie = ("0 1.5707963267948966 0", "1.5707963267948966 0 0", "0 0 0")[along]
    moments = [4e-4, 4e-4, 4e-4]
    moments[along] = 7e-4
    shape = (f'<collision><origin rpy="{lie}"/><geometry><cylinder radius="{radius}" length="0.02"/></geometry>'
             "</collision>")
    return (link(f"{name}_link", inertial(0.5, (moments[0], moments[1], moments[2])), shape)
            + joint(name, "continuous", parent, f"{name}_link", xyz, rpy, axis))


def robot(*parts: str, name: str = "made_up") -> str:
    return f'<robot name="{name}">{"".join(parts)}</robot>'


TWO_WHEELS = (link("base", inertial(5.0, (0.1, 0.1, 0.08), "0.02 0.01 0.03"), BOX)
              + wheel("left", "base", "0 0.2 -0.05") + wheel("right", "base", "0 -0.2 -0.05"))
FOUR_WHEELS = (link("base", inertial(9.0, (0.2, 0.2, 0.3)), BOX)
               + wheel("front_left", "base", "0.2 0.2 -0.05") + wheel("front_right", "base", "0.2 -0.2 -0.05")
               + wheel("rear_left", "base", "-0.2 0.2 -0.05") + wheel("rear_right", "base", "-0.2 -0.2 -0.05"))

THREE_AROUND = link("base", inertial(3.0, (0.02, 0.02, 0.03)), BOX) + "".join(
    wheel(f"wheel_{k}", "base", f"{0.2 * np.cos(a)} {0.2 * np.sin(a)} -0.05", f"0 0 {a - np.pi / 2}")
    for k, a in enumerate(np.radians((60, 180, 300))))

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


def sums_by_mujoco(path: Path) -> tuple[float, np.ndarray, float]:
    """Mass, centre of mass in the frame of the root link, and yaw inertia about it, by MuJoCo's reading of a URDF."""
    import mujoco

    spec: Any = mujoco.MjSpec.from_file(str(path))
    spec.compiler.fusestatic = False
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mass = model.body_mass
    com = mass @ data.xipos / mass.sum()
    yaw = 0.0
    for body in range(model.nbody):
        turn = data.ximat[body].reshape(3, 3)
        off = data.xipos[body] - com
        yaw += (turn @ np.diag(model.body_inertia[body]) @ turn.T)[2, 2] + mass[body] * (off[0] ** 2 + off[1] ** 2)
    return float(mass.sum()), com, float(yaw)


def imported(folder: Path, text: str, name: str = "robot.urdf", **answers: Any) -> tuple[Imported, Scene]:
    """A robot's file and the scene that the import makes of it."""
    (folder / name).write_text(text, encoding="utf-8")
    found = import_robot(folder / name, Answers(**answers))
    (folder / "robot.toml").write_text(found.text, encoding="utf-8")
    return found, read_scene(folder / "robot.toml")
