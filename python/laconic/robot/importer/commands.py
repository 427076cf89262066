"""What moves the joints of a URDF or SDF file: transmissions, ros2_control, plugins of a simulator."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping

from laconic.robot.importer.checked import read_number
from laconic.robot.importer.robot_tree import Command
from laconic.robot.importer.xml_file import Element

STATE_ALONE = "JointState"  # of a hardware interface that commands nothing
GEARS = ("mechanicalReduction", "mechanical_reduction")
WATCHES = ("state", "sensor", "imu", "camera", "laser", "ray")  # in the names of plugins that command nothing
BY_ORDER = "mimics"


def commands_of(root: Element, joints: Collection[str]) -> dict[str, list[Command]]:
    """The commands of each joint that has some."""
    found: dict[str, list[Command]] = {}
    for element in root.iter("transmission"):
        for joint, command in _of_transmission(element):
            found.setdefault(joint, []).append(command)
    for element in root.iter("ros2_control"):
        for joint, command in _of_ros2_control(element):
            found.setdefault(joint, []).append(command)
    for element in root.iter("plugin"):
        for joint, command in _of_plugin(element, joints):
            found.setdefault(joint, []).append(command)
    return {joint: _each_once(commands) for joint, commands in found.items() if joint in joints}


def with_mimics(found: dict[str, list[Command]], masters: Mapping[str, str]) -> dict[str, list[Command]]:
    """The same, with joints that mimic a commanded one."""
    for joint in masters:
        above, seen = masters[joint], {joint}
        while above in masters and above not in seen:
            seen.add(above)
            above = masters[above]
        if found.get(above) and joint not in found:
            found[joint] = [Command(f"{BY_ORDER} {masters[joint]}")]
    return found


def _of_transmission(element: Element) -> Iterable[tuple[str, Command]]:
    """Of the older formats, too, whose parts differ."""
    name = element.get("name", "")
    for joint in element.findall("joint"):
        interfaces = [(each.text or "").strip().rpartition("/")[2] for each in joint.iter("hardwareInterface")]
        if interfaces and all(STATE_ALONE in each for each in interfaces):
            continue
        kind = f" ({', '.join(interfaces)})" if any(interfaces) else ""
        gear = _gear(joint)
        yield joint.get("name", ""), Command(f"transmission {name}{kind}".strip(), gear or _gear(element))


def _of_ros2_control(element: Element) -> Iterable[tuple[str, Command]]:
    for joint in element.findall("joint"):
        kinds = [each.get("name", "") for each in joint.findall("command_interface")]
        if kinds:
            yield joint.get("name", ""), Command(f"{' and '.join(kinds)} interface of ros2_control")


def _of_plugin(element: Element, joints: Collection[str]) -> Iterable[tuple[str, Command]]:
    """A plugin that names joints in the texts of its parts, such as a differential drive."""
    what = element.get("name") or element.get("filename") or ""
    called = f"{what} {element.get('filename', '')}".lower()
    if any(word in called for word in WATCHES):
        return
    for part in element.iter():
        for word in (part.text or "").replace(",", " ").split():
            if word in joints:
                yield word, Command(f"plugin {what}".strip())


def _gear(element: Element) -> float | None:
    """The reduction, where it is a number other than 1."""
    for each in element.iter():
        if each.tag in GEARS and (value := read_number(each.text)) not in (None, 0.0, 1.0):
            return value
    return None


def _each_once(commands: Iterable[Command]) -> list[Command]:
    return list(dict.fromkeys(commands))
