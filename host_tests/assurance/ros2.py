"""`laconic ros2` among broken bytes: fuzzed CDR on every topic and service that it hears, and fuzzed RTPS on its ports.

Robots run in this process in virtual time, so that a minute has many of their minutes. It fails where an exception
leaves a cycle, a robot goes where no command can send it, memory grows, or a robot does not obey at the end."""

from __future__ import annotations

import argparse
import math
import random
import resource
import socket
import sys
import time
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "support"))

SCENES = ("turtlebot3_burger", "f1tenth")
TOPICS = {"cmd_vel": "geometry_msgs/msg/Twist", "/cmd_vel": "geometry_msgs/msg/TwistStamped",
          "initialpose": "geometry_msgs/msg/PoseWithCovarianceStamped",
          "ackermann_cmd": "ackermann_msgs/msg/AckermannDriveStamped",
          "drive": "ackermann_msgs/msg/AckermannDriveStamped"}
SERVICES = {"set_parameters": "rcl_interfaces/srv/SetParameters", "get_parameters": "rcl_interfaces/srv/GetParameters",
            "describe_parameters": "rcl_interfaces/srv/DescribeParameters", "reset": "std_srvs/srv/Empty",
            "set_pose": "robot_localization/srv/SetPose"}
TURN = 2000                # cycles of one robot before the other
LARGEST_SPEED = 2e4        # of a command is 1e4, in m/s and rad/s
GROWTH_MB = 50.0           # after the first turns


def arguments(parser: argparse.ArgumentParser) -> None:
    """Of this part."""
    parser.add_argument("--minutes", type=float, default=1.0)
    parser.add_argument("--seed", type=int, default=39)
    parser.add_argument("--domain", type=int, default=90)


def run(options: argparse.Namespace) -> bool:
    """Whether nothing was found."""
    rng, end = random.Random(options.seed), time.monotonic() + 60.0 * options.minutes
    cycles = sent = turns = 0
    first_mb = 0.0
    while time.monotonic() < end:
        more, failure = turn(SCENES[turns % len(SCENES)], rng, options.domain, end)
        cycles, sent, turns = cycles + more[0], sent + more[1], turns + 1
        if failure:
            print(f"after {cycles} cycles and {sent} messages with seed {options.seed}: {failure}")
            return False
        used_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
        first_mb = used_mb if turns <= 2 * len(SCENES) else first_mb
        if used_mb > first_mb + GROWTH_MB:
            print(f"memory grew from {first_mb:.0f} to {used_mb:.0f} MB in {turns} turns")
            return False
    print(f"{cycles} cycles among {sent} broken messages in {options.minutes:g} minutes: no failure; memory from "
          f"{first_mb:.0f} to {used_mb:.0f} MB")
    return True


def turn(scene: str, rng: random.Random, domain: int, end_s: float) -> tuple[tuple[int, int], str]:
    """One robot among noise, and whether it obeys at the end: cycles and messages, and what was found."""
    from ros2_support import rig_of

    kinds = ("cyclonedds",) if rng.random() < 0.5 else ("cyclonedds", "fastrtps")
    with rig_of(scene, domain=domain, is_loopback=True, services_for=kinds) as rig:
        noise = Noise(rig, rng)
        for cycle in range(TURN):
            noise.send()
            rig.turn()
            seen = rig.session.base.look()[0]
            if not all(map(math.isfinite, (seen.x_m, seen.y_m, *seen.velocity))) or \
                    max(map(abs, seen.velocity)) > LARGEST_SPEED:
                return (cycle, noise.sent), f"{scene} moves with {seen.velocity}"
            if time.monotonic() > end_s:
                break
        noise.close()
        rig.turn(40)  # until everything is taken and the watchdog has stopped it
        rig.call("/laconic/reset", "std_srvs/srv/Empty")
        rig.drive(80, 0.1)
        ahead = rig.session.base.look()[0].velocity[0]
        return (cycle + 1, noise.sent), "" if abs(ahead - 0.1) < 5e-3 else f"{scene} does not obey: {ahead} m/s"


class Noise:
    """Broken messages of every kind, for one rig."""

    def __init__(self, rig: Any, rng: random.Random):
        from cyclonedds.pub import DataWriter

        from laconic.ros2.messages import message_class
        from laconic.ros2.names import USUAL
        from laconic.ros2.packets import SPDP, data, heartbeat, packet

        self.rng, self.sent = rng, 0
        self._writers = [(rig.node.publisher(topic, kind), bytes(message_class(kind)().serialize(use_version_2=False)))
                         for topic, kind in TOPICS.items()]
        for name, kind in SERVICES.items():
            writer = rig.peer._endpoint(DataWriter, f"rq/laconic/{name}Request", f"{kind}_Request", USUAL,
                                        of_service="clientid=1;")
            whole = message_class(f"{kind}_Request", 16, True)().serialize(use_version_2=False)
            self._writers.append((writer, bytes(whole)))
        others = rig.session.participant.others
        self._port = others._meta_port if others else 7400
        self._packets = [packet(b"\1\x0f" + bytes(range(10)), b"", [
            data(bytes(4), SPDP, 1, b"\0\3\0\0\1\0\0\0"), heartbeat(bytes(4), SPDP, 1, 2, 1)])]
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def send(self) -> None:
        """One message to each reader, and one packet."""
        from cyclonedds._clayer import ddspy_write

        for writer, whole in self._writers:
            data = self.broken(whole[4:])
            ddspy_write(writer._ref, whole[:4] + data + bytes(-len(data) % 4))
        self._socket.sendto(self.broken(self._packets[0]), ("127.0.0.1", self._port))
        self.sent += len(self._writers) + 1

    def broken(self, good: bytes) -> bytes:
        """Random bytes, or a good message with some of it changed, cut or longer."""
        rng = self.rng
        if rng.random() < 0.2:
            return rng.randbytes(rng.randint(0, 300))
        made = bytearray(good)
        for _ in range(rng.randint(0, 8)):
            if made:
                made[rng.randrange(len(made))] = rng.choice((0, 1, 0x7F, 0x80, 0xF0, 0xFF, rng.randrange(256)))
        how = rng.random()
        if how < 0.2:
            return bytes(made[: rng.randint(0, len(made))])
        return bytes(made + rng.randbytes(64) if how < 0.3 else made)

    def close(self) -> None:
        """No more packets."""
        self._socket.close()
