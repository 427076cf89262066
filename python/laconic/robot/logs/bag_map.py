"""The short form of a bag's map: topics of usual messages, whose fields need no name."""

from __future__ import annotations

from laconic.robot.logs.quantity import Quantity
from laconic.scene.table import Table

JOINTS = "/joint_states"


def shorthand(table: Table) -> dict[str, Quantity]:
    """The quantities of `joints` with `wheels`, `pose` as a text and `imu`."""
    found: dict[str, Quantity] = {}
    if table.has("joints"):
        topic = table.text("joints")
        names = table.texts("wheels", ()) if table.has("wheels") else ()
        if not topic:
            table.fail("joints", f"is empty; give a topic such as {JOINTS}")
        if not names:
            table.fail("wheels", "is missing; give the names of the wheels' joints, in the order of the scene's wheels")
        if len(set(names)) < len(names):
            table.fail("wheels", "names a joint twice; give each wheel's joint once")
        found |= joints_of(topic, tuple(names), is_ordered=True)
    elif table.has("wheels"):
        table.fail("wheels", 'needs joints, the topic with their angles, such as joints = "/joint_states"')
    if isinstance(table.peek("pose"), str):
        topic = table.text("pose")
        if not topic:
            table.fail("pose", "is empty; give a topic such as /odom")
        found["pose"] = pose_of(topic)
    if table.has("imu"):
        topic = table.text("imu")
        if not topic:
            table.fail("imu", "is empty; give a topic such as /imu")
        found["yaw_rate"] = yaw_rate_of(topic)
    return found


def joints_of(topic: str, names: tuple[str, ...], *, is_ordered: bool) -> dict[str, Quantity]:
    """Angles and speeds of wheels, of messages of the type JointState; either may be absent in them."""
    wheels = tuple(range(1, len(names) + 1)) if is_ordered else ()
    return {name: Quantity(name, tuple(f"{topic}.{field}[{joint}]" for joint in names), (unit,), wheels=wheels,
                           is_optional=True)
            for name, field, unit in (("wheel_angle", "position", "rad"), ("wheel_speed", "velocity", "rad/s"))}


def pose_of(topic: str, *, is_optional: bool = False) -> Quantity:
    """Of messages whose type says where the pose is."""
    return Quantity("pose", (), ("m", "m", "rad"), topic=topic, is_optional=is_optional)


def yaw_rate_of(topic: str, *, is_optional: bool = False) -> Quantity:
    """Of an Imu."""
    return Quantity("yaw_rate", (f"{topic}.angular_velocity.z",), ("rad/s",), is_optional=is_optional)
