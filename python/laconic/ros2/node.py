"""One robot on the wire: what it hears, what it publishes, what its services answer."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from laconic.core.articulated import CARRIAGE
from laconic.ros2.base import Base
from laconic.ros2.messages import dds_name, new
from laconic.ros2.motion import GRAVITY_M_PER_S2, Seen
from laconic.ros2.names import (
    LATCHED,
    NANO,
    OTHER_FIELDS,
    SURE,
    TRANSFORMS,
    USUAL,
    Middleware,
    OdometryOut,
    Out,
    Quality,
    RosNode,
    between,
    polled,
    ros_type,
    topic_name,
    transform,
    upright,
)

DRIVE_TOPICS = ("ackermann_cmd", "drive")  # of cars: those of VESC's stack and of f1tenth_gym_ros
ACKERMANN = "ackermann_msgs/msg/AckermannDriveStamped"
TWIST, TWIST_STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"
POSE_STAMPED = "geometry_msgs/msg/PoseWithCovarianceStamped"
NODE_NAME = "laconic"
OK, WARN, ERROR, STALE = range(4)   # levels of diagnostics
KEPT_S = 0.25                       # of each topic, for peers that have lost a packet
FURTHEST = 1e6                      # m of a pose
LARGEST = 1e4                       # m/s or rad/s of a command

# rcl_interfaces/msg/ParameterType
NOT_SET, BOOL, INTEGER, DOUBLE, STRING = range(5)


@dataclass
class Told:
    """Lines for the user: each kind of event at most once in a while, all of them counted."""

    say: Callable[[str], None]
    every_s: float = 10.0
    counts: dict[str, int] = field(default_factory=dict)
    _last_s: dict[str, float] = field(default_factory=dict)

    def tell(self, now_s: float, event: str, text: str) -> None:
        """Counts an event, and prints its line unless the same event had one lately."""
        self.counts[event] = self.counts.get(event, 0) + 1
        if now_s - self._last_s.get(event, -math.inf) >= self.every_s:
            self._last_s[event] = now_s
            self.say(text)


@dataclass
class Command:
    """The last velocity that was heard, and from which publisher."""

    heard_s: float = -math.inf
    publisher: int = 0
    count: int = 0
    topic: str = "cmd_vel"
    has_stopped: bool = True        # by the watchdog


class RobotNode:
    """One robot of a base as a node."""

    def __init__(self, participant: Middleware, base: Base, robot: int, *, namespace: str, frames: dict[str, str],
                 is_sim_time: bool, is_stamped: bool | None, has_map: bool, shares_tf: bool, told: Told, rate_Hz: float,
                 description: str | None = None,
                 has_services: bool = True):
        self.base, self.robot, self.told = base, robot, told
        self.node: RosNode = participant.node(NODE_NAME, namespace)
        prefix = f"{namespace.strip('/')}/" if shares_tf and namespace != "/" else ""
        self.frames = {name: frame if name == "map" else prefix + frame for name, frame in frames.items()}
        self.command, self.watchdog_s, self.heading_rad = Command(), base.table.watchdog_s, 0.0
        self.has_map, self.is_sim_time, self.rate_Hz, self.messages = has_map, is_sim_time, rate_Hz, 0
        kinds = {None: [TWIST, TWIST_STAMPED], True: [TWIST_STAMPED], False: [TWIST]}[is_stamped]
        self.command_topic = topic_name("rt", namespace, "cmd_vel")
        self._commands = [self.node.subscription("cmd_vel", kind) for kind in kinds]
        self._command_types = kinds
        self._drives = {topic: self.node.subscription(topic, ACKERMANN) for topic in DRIVE_TOPICS if base.is_car}
        self._heard_types = {self.command_topic: kinds} | {
            topic_name("rt", namespace, topic): [ACKERMANN] if base.is_car else [] for topic in DRIVE_TOPICS}
        self._poses = self.node.subscription("initialpose", POSE_STAMPED) if has_map else None
        if has_map:
            self._heard_types[topic_name("rt", namespace, "initialpose")] = [POSE_STAMPED]
        self._stream = Quality(max(USUAL.depth, math.ceil(KEPT_S * rate_Hz)))
        tf = ("/tf", "/tf_static") if shares_tf else ("tf", "tf_static")
        slope_rad = base.scene.vehicle.get("ground", {}).get("slope_rad", 0.0)
        self._upward = GRAVITY_M_PER_S2 * math.cos(slope_rad)  # what the ground's support shows, across it
        self._left_out = 0
        self.had_publisher = False
        self._publish_all(tf, description, prefix)
        if has_services:
            self._serve()

    # ---- publishers

    def _publish_all(self, tf: tuple[str, str], description: str | None, prefix: str) -> None:
        node, frames = self.node, self.frames
        stream = self._stream
        self._odom = OdometryOut(node, "odom", frames["odom"], frames["base"], SURE, stream)
        self._truth = OdometryOut(node, "ground_truth/odom", frames["map"], frames["base"], 0.0, stream)
        self.joint_names = names = self.base.joint_names
        zeros = [0.0] * len(names)
        joints = new("sensor_msgs/msg/JointState", name=names, position=zeros, velocity=zeros)
        self._joints = Out(node, "joint_states", "sensor_msgs/msg/JointState", joints, stream)
        self._angles, self._speeds = (self._joints.packed.slot(name, f"{len(names)}d")
                                      for name in ("position", "velocity"))
        imu = new("sensor_msgs/msg/Imu")
        imu.header.frame_id = frames["imu"]
        self._imu = Out(node, "imu", "sensor_msgs/msg/Imu", imu, stream)
        self._turned = self._imu.packed.slot("orientation.z", "2d")
        self._rate = self._imu.packed.slot("angular_velocity.z", "d")
        self._acceleration = self._imu.packed.slot("linear_acceleration", "3d")
        links = [transform(frames["odom"], frames["base"])]
        if self.has_map:
            links.append(transform(frames["map"], frames["odom"]))
        self._bodies = self._hung(description or "", prefix)
        links += [transform(parent, child, x_m, y_m) for _, parent, child, x_m, y_m in self._bodies]
        self._tf = Out(node, tf[0], "tf2_msgs/msg/TFMessage", new("tf2_msgs/msg/TFMessage", transforms=links),
                       max(stream, TRANSFORMS, key=lambda each: each.depth),
                       stamps=[f"transforms[{number}].header.stamp" for number in range(len(links))])
        self._links = [(self._tf.packed.slot(f"transforms[{number}].transform.translation", "2d"),
                        self._tf.packed.slot(f"transforms[{number}].transform.rotation.z", "2d"))
                       for number in range(len(links))]
        self._battery = self._supply() if self.base.scene.vehicle.get("drive", {}).get("supply_V") else None
        self._drawn = [self._battery.packed.slot(name, "f") for name in ("voltage", "current")] if self._battery else []
        imu_table = self.base.scene.sensors.imu or {}
        fixed = [transform(frames["base"], frames["imu"], imu_table.get("x_m", 0.0), imu_table.get("y_m", 0.0),
                           imu_table.get("heading_rad", 0.0))]
        if self.has_map:
            fixed.append(transform(frames["base"], frames["scan"]))
        static = node.publisher(tf[1], "tf2_msgs/msg/TFMessage", LATCHED)
        static.write(new("tf2_msgs/msg/TFMessage", transforms=fixed))
        if description is not None:
            node.publisher("robot_description", "std_msgs/msg/String", LATCHED).write(
                new("std_msgs/msg/String", data=description))

    def _hung(self, description: str, prefix: str) -> list[tuple[int, str, str, float, float]]:
        """Trailers and other bodies that tf shows: hinge, parent's frame, own frame, place. Those of joints that the
        description has are left to robot_state_publisher."""
        scene, found = self.base.scene, []
        frames = {CARRIAGE: self.frames["base"], **{hinge.name: prefix + hinge.name for hinge in scene.hinges}}
        joints = self.joint_names[len(self.joint_names) - len(scene.hinges) :]
        for at, hinge in enumerate(scene.hinges):
            if hinge.form in ("trailer", "body") and f'"{joints[at]}"' not in description:
                body = scene.vehicle["body"][at]
                found.append((at, frames[body["parent"]], frames[hinge.name], body["hinge_x_m"], body["hinge_y_m"]))
        return found

    def _supply(self) -> Out:
        nothing = float("nan")
        message = new("sensor_msgs/msg/BatteryState", temperature=nothing, charge=nothing, capacity=nothing,
                      design_capacity=nothing, percentage=nothing, present=True)
        return Out(self.node, "battery_state", "sensor_msgs/msg/BatteryState", message)

    def publish(self, seen: Seen, stamp_ns: int, period_s: float) -> None:
        """All of one cycle."""
        stamp, odometry = divmod(stamp_ns, NANO), self.base.odometry[self.robot]
        here = (odometry.x_m, odometry.y_m, odometry.heading_rad)
        truth = (seen.x_m, seen.y_m, seen.heading_rad)
        self._odom.write(stamp, here, odometry.velocity)
        self._truth.write(stamp, truth, seen.velocity)
        self._link(0, here)
        if self.has_map:
            self._link(1, between(truth, here))
        for number, body in enumerate(self._bodies, len(self._links) - len(self._bodies)):
            self._links[number][1].put(*upright(seen.hinge_rad[body[0]]))
        self._tf.write(stamp)
        self._angles.put(*seen.angle_rad, *seen.hinge_rad)
        self._speeds.put(*seen.speed_rad_per_s, *seen.hinge_rate_rad_per_s)
        self._joints.write(stamp)
        ahead, left, rate = seen.imu
        self.heading_rad += rate * period_s
        self._turned.put(*upright(self.heading_rad))
        self._rate.put(rate)
        self._acceleration.put(ahead, left, self._upward)
        self._imu.write(stamp)
        self.messages += 5
        if self._battery is not None and seen.supply is not None:
            voltage, current = self._drawn
            voltage.put(seen.supply[0])
            current.put(-seen.supply[1])  # below 0: it discharges
            self._battery.write(stamp)
            self.messages += 1

    def _link(self, number: int, pose: tuple[float, float, float]) -> None:
        place, turn = self._links[number]
        place.put(pose[0], pose[1])
        turn.put(*upright(pose[2]))

    # ---- commands

    def hear(self, now_s: float) -> None:
        """Takes commands and poses that have come, and stops the robot after a silence."""
        for reader, kind in zip(self._commands, self._command_types, strict=True):
            for message in polled(reader, lambda: self._tell(now_s, "unreadable", "a message on cmd_vel cannot be read "
                                                             "as its type and is ignored")):
                self._obey(message.twist if kind == TWIST_STAMPED else message, message, now_s)
        for topic, drives in self._drives.items():
            text = f"a message on {topic} cannot be read as its type and is ignored"
            for message in polled(drives, partial(self._tell, now_s, "unreadable", text)):
                self._obey_drive(message, topic, now_s)
        if self._poses is not None:
            text = "a message on initialpose cannot be read as its type and is ignored"
            for message in polled(self._poses, partial(self._tell, now_s, "unreadable", text)):
                self._start_at(message, now_s)
        command = self.command
        if not command.has_stopped and now_s - command.heard_s > self.watchdog_s:
            command.has_stopped = True
            if self.base.is_commanded(self.robot):
                self._tell(now_s, "watchdog", f"{command.topic} was silent for {self.watchdog_s:g} s, so the robot "
                           "stops")
            self.base.command(self.robot, 0.0, 0.0, 0.0)

    def look_for_publishers(self) -> None:
        """Notes whether a publisher of commands was ever found; readers of Zenoh do not show them."""
        readers = (*self._commands, *self._drives.values())
        self.had_publisher = self.had_publisher or any(
            reader.get_matched_publications() for reader in readers if hasattr(reader, "get_matched_publications"))

    def _obey(self, twist: Any, message: Any, now_s: float) -> None:
        wanted = (twist.linear.x, twist.linear.y, twist.angular.z)
        others = (twist.linear.z, twist.angular.x, twist.angular.y)
        if not all(abs(each) <= LARGEST for each in (*wanted, *others)):  # NaN is not, either
            self._tell(now_s, "not finite", "a command on cmd_vel has a number that is infinite, NaN or beyond "
                       f"{LARGEST:g}, and is ignored; the last one holds until the watchdog")
            return
        if any(others):
            self._tell(now_s, "out of plane", "a command on cmd_vel has linear.z, angular.x or angular.y, which a "
                       "robot on the ground leaves out")
        self._heard(message, "cmd_vel", now_s)
        for remark in self.base.command(self.robot, *wanted):
            self._tell(now_s, f"limited: {remark.partition(' of')[0]}", f"cmd_vel: {remark}")

    def _obey_drive(self, message: Any, topic: str, now_s: float) -> None:
        drive = message.drive
        numbers = (drive.speed, drive.steering_angle, drive.acceleration, drive.steering_angle_velocity, drive.jerk)
        if not all(abs(each) <= LARGEST for each in numbers) or abs(drive.steering_angle) >= math.pi / 2:
            self._tell(now_s, "not finite", f"a command on {topic} has a number that is infinite, NaN or beyond "
                       f"{LARGEST:g}, or an angle of a right angle or more, and is ignored; the last one holds "
                       "until the watchdog")
            return
        below = [f"{name} = {value:g}" for name, value in (
            ("acceleration", drive.acceleration), ("steering_angle_velocity", drive.steering_angle_velocity),
            ("jerk", drive.jerk)) if value < 0.0]
        if below:
            self._tell(now_s, "limit below 0", f"a command on {topic} has {' and '.join(below)}, and is ignored; give "
                       "limits above 0, for both ways, or 0 for those of the scene")
            return
        if drive.jerk:
            self._tell(now_s, "jerk", f"a command on {topic} limits the jerk, which the base leaves out")
        self._heard(message, topic, now_s)
        for remark in self.base.ackermann(self.robot, drive.speed, drive.steering_angle,
                                          acceleration_m_per_s2=drive.acceleration,
                                          steering_rad_per_s=drive.steering_angle_velocity):
            self._tell(now_s, f"limited: {remark.partition(' of')[0]}", f"{topic}: {remark}")

    def _heard(self, message: Any, topic: str, now_s: float) -> None:
        """Notes a command that counts."""
        command, publisher = self.command, int(message.sample_info.publication_handle)
        if command.publisher not in (0, publisher) and now_s - command.heard_s <= self.watchdog_s:
            where = f"command {topic}" if topic == command.topic else \
                f"command the robot, on {' and '.join(sorted((topic, command.topic)))},"
            self._tell(now_s, "two commanders", f"two publishers {where} at once; the last command counts, so stop one "
                       "of them")
        command.heard_s, command.publisher, command.has_stopped, command.topic = now_s, publisher, False, topic
        command.count += 1

    def _start_at(self, message: Any, now_s: float) -> None:
        """Obeys initialpose in the map's frame."""
        frame, wanted = message.header.frame_id.lstrip("/"), self.frames["map"]
        if frame not in ("", wanted):
            self._tell(now_s, "other frame", f"initialpose is in the frame {frame} and is ignored; give it in "
                       f"{wanted}, or name that frame with --frame map=")
        elif self._move(message.pose.pose, "initialpose", now_s) and not frame:
            self._tell(now_s, "no frame", f"initialpose names no frame, and is taken as one in {wanted}")

    def _move(self, pose: Any, who: str, now_s: float) -> bool:
        turn = pose.orientation
        numbers = (pose.position.x, pose.position.y, turn.x, turn.y, turn.z, turn.w)
        if not all(abs(each) <= FURTHEST for each in numbers) or turn.z**2 + turn.w**2 < 1e-12:  # NaN is not, either
            self._tell(now_s, "bad pose", f"{who} has a pose that is infinite, NaN, beyond {FURTHEST:g} or without a "
                       "yaw, and is ignored")
            return False
        yaw = math.atan2(2.0 * (turn.w * turn.z + turn.x * turn.y), 1.0 - 2.0 * (turn.y**2 + turn.z**2))
        self.base.place(self.robot, pose.position.x, pose.position.y, yaw)
        self.command = Command(publisher=self.command.publisher, count=self.command.count)
        self._tell(now_s, "placed", f"{who} puts the robot at x = {pose.position.x:g} m, y = {pose.position.y:g} m, "
                   f"yaw = {yaw:.4g} rad")
        return True

    def wrong_type(self, topic: str, kind: str, why: str, now_s: float) -> None:
        """A publisher has come; tells the user if its messages cannot be commands of this robot. `why`: as in
        Middleware.new_writers."""
        types, own = self._heard_types.get(topic), topic.rpartition("/")[2]
        if types is None or kind in map(dds_name, types):
            if types is not None and why == OTHER_FIELDS:
                self._tell(now_s, f"type {kind}: fields", f"a publisher on {own} sends {ros_type(kind)} with other "
                           "fields than ROS has, which is not heard; build it of the definition of ROS")
            elif types is not None and why:
                self._tell(now_s, f"type {kind}: quality", f"a publisher on {own} offers best effort, which is not "
                           "heard; make it reliable")
            return
        names = " or ".join(each.rpartition("/")[2] for each in types)
        if types:
            self._tell(now_s, f"type {kind}", f"a publisher on {own} sends {ros_type(kind)}, which is not heard; "
                       f"send {names}")
        elif kind == dds_name(ACKERMANN):
            self._tell(now_s, f"type {kind}", f"a publisher on {own} sends {ros_type(kind)}, which is for cars with a "
                       "fixed axle and steered wheels; send Twist on cmd_vel")

    def unreadable(self, topic: str, kind: str, now_s: float) -> bool:
        """The library has dropped a message on a topic; tells the user, and returns whether it was for this robot."""
        if kind not in map(dds_name, self._heard_types.get(f"rt{topic}", ())):
            return False
        self._tell(now_s, "unreadable", f"a message on {topic.rpartition('/')[2]} cannot be read as its type and is "
                   "ignored")
        return True

    def _tell(self, now_s: float, event: str, text: str) -> None:
        self.told.tell(now_s, f"{self.node.full_name}: {event}", f"{self.node.full_name}: {text}")

    # ---- services

    def _serve(self) -> None:
        own = f"{self.node.name}/"
        for name, answer in (("get_parameters", self._get), ("get_parameter_types", self._types),
                             ("describe_parameters", self._describe), ("list_parameters", self._list),
                             ("set_parameters", self._set), ("set_parameters_atomically", self._set_all)):
            kind = "".join(word.title() for word in name.split("_"))
            self.node.service(own + name, f"rcl_interfaces/srv/{kind}", answer)
        self.node.service(f"{own}reset", "std_srvs/srv/Empty", self._reset)
        self.node.service(f"{own}set_pose", "robot_localization/srv/SetPose", self._set_pose)

    def answer(self, now_s: float) -> None:
        """Answers the requests that have come."""
        self._now_s = now_s
        for service in self.node.services:
            service.poll(lambda text: self._tell(now_s, "unreadable request", text))

    def _reset(self, _: Any) -> dict[str, Any]:
        self.base.reset(self.robot)
        self.command, self.heading_rad = Command(count=self.command.count), 0.0
        self._tell(self._now_s, "reset", "reset puts the robot back to the scene's start")
        return {}

    def _set_pose(self, request: Any) -> dict[str, Any]:
        self._move(request.pose.pose.pose, "set_pose", self._now_s)
        return {}

    def parameters(self) -> dict[str, bool | float | str]:
        """What `ros2 param` lists."""
        run = self.base.scene.run
        return {"method": run.method, "rate_hz": self.rate_Hz, "scene": self.base.scene.name, "step_s": run.step_s,
                "use_sim_time": self.is_sim_time, "watchdog_s": self.watchdog_s}

    def _get(self, request: Any) -> dict[str, Any]:
        known = self.parameters()
        return {"values": [value_of(known.get(name)) for name in request.names]}

    def _types(self, request: Any) -> dict[str, Any]:
        known = self.parameters()
        return {"types": [value_of(known.get(name)).type for name in request.names]}

    def _describe(self, request: Any) -> dict[str, Any]:
        known = self.parameters()
        return {"descriptors": [new("rcl_interfaces/msg/ParameterDescriptor", name=name,
                                    type=value_of(known.get(name)).type, read_only=name != "watchdog_s")
                                for name in request.names]}

    def _list(self, request: Any) -> dict[str, Any]:
        prefixes = list(request.prefixes)
        names = [name for name in self.parameters() if not prefixes or name in prefixes]
        return {"result": new("rcl_interfaces/msg/ListParametersResult", names=names)}

    def _set(self, request: Any) -> dict[str, Any]:
        return {"results": [result(self._refusal(each), self._accept, each) for each in request.parameters]}

    def _set_all(self, request: Any) -> dict[str, Any]:
        refusals = [refusal for each in request.parameters if (refusal := self._refusal(each))]
        for each in request.parameters if not refusals else []:
            self._accept(each)
        return {"result": result("; ".join(refusals))}

    def _refusal(self, parameter: Any) -> str:
        """Why a parameter cannot be set; empty where it can."""
        name, value = parameter.name, parameter.value
        known = self.parameters()
        if name not in known:
            return f"there is no parameter {name}"
        if name == "use_sim_time" and value.type == BOOL and value.bool_value == self.is_sim_time:
            return ""
        if name != "watchdog_s":
            return f"{name} is set when laconic ros2 starts"
        if value.type != DOUBLE or not 0.0 < value.double_value < math.inf:
            return f"{name} takes a double above 0"
        return ""

    def _accept(self, parameter: Any) -> None:
        if parameter.name == "watchdog_s":
            self.watchdog_s = parameter.value.double_value

    # ---- diagnostics

    def left_out(self) -> int:
        """Messages that could not be sent because a peer does not keep up."""
        outs = (self._odom.out, self._truth.out, self._tf, self._joints, self._imu, self._battery)
        return sum(each.left_out for each in outs if each is not None)

    def report(self, now_s: float, slipping: str) -> None:
        """Tells the user what happened since the last report: messages left out, limits of the wheels, and slip."""
        if limit := self.base.words_of_limit(self.robot):
            self._tell(now_s, "a wheel at its limit", limit)
        if slipping:
            self._tell(now_s, "slip", f"{slipping}; command less, or give base.acceleration_limit_m_per_s2")
        count = self.left_out()
        if count > self._left_out:
            self._tell(now_s, "left out", f"a peer does not keep up, so {count - self._left_out} messages were left "
                       "out")
        self._left_out = count

    def status(self, refusal: str, slipping: str, late: int) -> Any:
        """The robot's diagnostic_msgs/DiagnosticStatus."""
        is_limited, counts = bool(self.base.limited[:, self.robot].any()), self.told.counts
        limit = self.base.words_of_limit(self.robot)
        self.base.limited[:, self.robot] = False
        level, message = OK, "drives" if self.base.is_commanded(self.robot) else "waits for cmd_vel"
        for is_so, how, text in ((is_limited, WARN, limit), (bool(slipping), WARN, slipping),
                                 (bool(refusal), ERROR, refusal)):
            if is_so:
                level, message = max(level, how), text
        own = f"{self.node.full_name}: "
        values = {"commands": self.command.count, "late cycles": late,
                  **{event.removeprefix(own): count for event, count in counts.items() if event.startswith(own)}}
        values["messages left out"] = self.left_out()
        pairs = [new("diagnostic_msgs/msg/KeyValue", key=key, value=str(value)) for key, value in values.items()]
        return new("diagnostic_msgs/msg/DiagnosticStatus", level=level, name=f"{self.node.full_name}: base",
                   message=message, hardware_id=self.base.scene.name, values=pairs)


def value_of(value: bool | float | str | None) -> Any:
    """A rcl_interfaces/msg/ParameterValue."""
    given: dict[str, Any] = {"type": NOT_SET}
    if isinstance(value, bool):
        given = {"type": BOOL, "bool_value": value}
    elif isinstance(value, float):
        given = {"type": DOUBLE, "double_value": value}
    elif isinstance(value, str):
        given = {"type": STRING, "string_value": value}
    return new("rcl_interfaces/msg/ParameterValue", **given)


def result(refusal: str, accept: Callable[[Any], None] = lambda _: None, parameter: Any = None) -> Any:
    """A rcl_interfaces/msg/SetParametersResult; what is not refused is accepted."""
    if not refusal:
        accept(parameter)
    return new("rcl_interfaces/msg/SetParametersResult", successful=not refusal, reason=refusal)
