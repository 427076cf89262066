"""One run of `laconic ros2`: options, the loop against the clock, and what there is to say at its end."""

from __future__ import annotations

import gc
import math
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from laconic.base.outputs import opened
from laconic.base.text_file import text_of_file
from laconic.errors import BadInput, ResultFails
from laconic.robot.importer.xml_file import root_of
from laconic.ros2 import FRAMES, USUAL_DISTRIBUTION
from laconic.ros2.base import Base
from laconic.ros2.hinged import base_of
from laconic.ros2.lines import LibraryLines, kind_of, unreadable_of
from laconic.ros2.maps import Map, Scanner
from laconic.ros2.messages import new
from laconic.ros2.names import NANO, Middleware, Out, check_name, diagnostics, sent
from laconic.ros2.node import RobotNode, Told
from laconic.scene import Scene
from laconic.scene.scene_text import lines_of
from laconic.scene.table import read_toml

HOUSEKEEPING_S = 0.02    # between looks for requests
GRAPH_S = 0.5            # between looks at the graph
DIAGNOSTICS_S = 1.0
LINE_S = 60.0            # between lines of a long run
CATCH_UP_S = 0.2         # a loop that is later gives up what it has missed
JUMP_S = 0.1             # of the system's clock against the monotonic one
MOST_LATENESS = 100_000  # that are kept
MOST_RECORDED = 14 * 2**20  # bytes of a scene that can be read again
MOST_ROBOTS = 1000
MOST_SPEED = 1000.0


@dataclass(frozen=True)
class Ros2Options:
    """What the command line gives."""

    distribution: str = USUAL_DISTRIBUTION
    domain: int = 0
    namespace: str = "/"
    robots: int = 1
    spacing_m: float = 1.0
    rate_Hz: float = 50.0                 # noqa: N815
    is_sim_time: bool = False
    speed: float = 1.0
    is_stamped: bool | None = None        # None: both kinds of command
    announces: bool = True
    services_for: Sequence[str] = ("cyclonedds", "fastrtps")  # clients' middlewares
    is_local: bool = False
    router: str = "tcp/localhost:7447"
    listen: str = ""
    shares_tf: bool = False
    frames: Sequence[str] = ()
    duration_s: float | None = None
    urdf: Path | None = None
    record: Path | None = None
    is_loopback: bool = False
    map_file: Path | None = None


@dataclass
class Clock:
    """The clocks of the machine; tests have another one."""

    now_s: Callable[[], float] = time.monotonic
    wall_ns: Callable[[], int] = time.time_ns
    sleep: Callable[[float], None] = time.sleep


@dataclass
class Lateness:
    """How late cycles began."""

    seconds: deque[float] = field(default_factory=lambda: deque(maxlen=MOST_LATENESS))
    late: int = 0             # by a period or more
    skipped_s: float = 0.0

    def figures(self) -> dict[str, float]:
        """In milliseconds."""
        found = np.array(self.seconds) if self.seconds else np.zeros(1)
        median, high = np.percentile(found, (50, 99))
        return {"late_median_ms": 1e3 * float(median), "late_99_percent_ms": 1e3 * float(high),
                "late_most_ms": 1e3 * float(found.max())}


class Session:
    """Robots on the wire from the first cycle to the last."""

    def __init__(self, scene: Scene, options: Ros2Options, say: Callable[[str], None] = lambda _: None,
                 clock: Clock | None = None, library: LibraryLines | None = None):
        self.options, self.clock, self.say, self.library = options, clock or Clock(), say, library
        self.period_s, self.steps = cycle_of(scene, options)
        check_options(options)
        self.told, self.base = Told(say), base_at_its_start(scene, options.robots)
        self.scene = self.base.scene
        spread(self.base, options)
        self.base.record, self.base.is_recording = ([], True) if options.record else (None, False)
        self.refusals: dict[int, str] = {}
        self.lateness, self.cycles, self.time_ns = Lateness(), 0, 0
        self.map = Map.read(options.map_file) if options.map_file else None
        self._parent, self._frames = check_name("--namespace", options.namespace), frames_of(options.frames)
        self._description = None if options.urdf is None else description_of(options.urdf)
        self.participant = middleware_of(options)
        try:
            self._join()
        except BaseException:
            self.participant.close()
            raise

    def _join(self) -> None:
        """Makes the nodes, and tells the graph of them."""
        options = self.options
        self.robots = [self._robot(number) for number in range(options.robots)]
        shared = self.participant.nodes[0]
        self._diagnostics = shared.publisher("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
        kind = "rosgraph_msgs/msg/Clock"
        self._clock_out = Out(shared, "/clock", kind, new(kind), stamps=("clock",)) if options.is_sim_time else None
        self.scanner = Scanner(self.map, self.robots) if self.map else None
        self.participant.announce()
        self._next_s = dict.fromkeys(("services", "graph", "diagnostics"), -math.inf)
        self._next_s["line"] = LINE_S + (0.0 if options.is_sim_time else self.clock.now_s())
        self._offset_ns = self.clock.wall_ns() - round(self.clock.now_s() * NANO)

    def _robot(self, number: int) -> RobotNode:
        options, parent, text = self.options, self._parent, self._description
        namespace = parent if options.robots == 1 else f"{parent.rstrip('/')}/robot{number + 1}"
        node = RobotNode(self.participant, self.base, number, namespace=namespace, frames=self._frames,
                         is_sim_time=options.is_sim_time, is_stamped=options.is_stamped,
                         has_map=options.is_loopback or self.map is not None, shares_tf=options.shares_tf,
                         told=self.told, rate_Hz=options.rate_Hz, description=text,
                         has_services=bool(options.services_for))
        if text is not None and number == 0:
            lacking = [name for name in node.joint_names if f'"{name}"' not in text]
            if lacking:
                self.say(f"{options.urdf}: has no joint {', '.join(lacking)}; give its wheel joints in the scene, as "
                         "[base] joint_names")
        return node

    def moves_at_start(self) -> bool:
        """Whether the scene's start is a motion, which the base ends by no command of its own."""
        start = self.base.scene.initial
        return any((*start.velocity_body_m_per_s, start.yaw_rate_rad_per_s, *(start.nu_rad_per_s or ())))

    # ---- one cycle

    def cycle(self) -> None:
        """Hears, steps and publishes once."""
        now_s = self.base.motion.steps * self.scene.run.step_s if self.options.is_sim_time else self.clock.now_s()
        for robot in self.robots:
            robot.hear(now_s)
        for number, refused in self.base.advance(self.steps):
            self.refusals[number] = str(refused)
            robot = self.robots[number]
            robot.told.tell(now_s, f"{robot.node.full_name}: refused",
                            f"{robot.node.full_name}: {refused}; the robot stands until reset or set_pose")
        self.time_ns = self._stamp(now_s)
        for robot, seen in zip(self.robots, self.base.look(), strict=True):
            robot.publish(seen, self.time_ns, self.period_s)
            if self.scanner is not None:
                self.scanner.see(robot, seen, self.time_ns)
        if self._clock_out is not None:
            self._clock_out.write(divmod(self.time_ns, NANO))
        self.cycles += 1
        self._housekeeping(now_s)

    def _stamp(self, now_s: float) -> int:
        """Simulated time, or the system's."""
        if self.options.is_sim_time:
            return round(self.base.motion.steps * self.scene.run.step_s * NANO)
        wall_ns = self.clock.wall_ns()
        offset_ns = wall_ns - round(self.clock.now_s() * NANO)
        if abs(offset_ns - self._offset_ns) > JUMP_S * NANO:
            jump_s = (offset_ns - self._offset_ns) / NANO
            self.told.tell(now_s, "clock", f"the system's clock jumped by {jump_s:.3g} s; stamps follow it, and the "
                           "robot runs on without a gap")
        self._offset_ns = offset_ns
        return wall_ns

    def _is_due(self, what: str, now_s: float, every_s: float) -> bool:
        if now_s < self._next_s[what]:
            return False
        self._next_s[what] = now_s + every_s
        return True

    def _housekeeping(self, now_s: float) -> None:
        if self._is_due("services", now_s, HOUSEKEEPING_S):
            for robot in self.robots:
                robot.answer(now_s)
            self.participant.answer()
            for number in [*self.refusals]:
                if not self.base.motion.has_refused(number):  # it was reset or placed
                    del self.refusals[number]
        if self._is_due("graph", now_s, GRAPH_S):
            self._look_at_graph(now_s)
            self._pass_on(now_s)
        if self._is_due("diagnostics", now_s, DIAGNOSTICS_S):
            late, slipping = self.lateness.late, [self.base.motion.grip(number) for number in range(len(self.robots))]
            for number, robot in enumerate(self.robots):
                robot.report(now_s, slipping[number])
                for text in self.base.motion.folded(number):
                    robot.told.tell(now_s, f"{robot.node.full_name}: {text.partition(':')[0]}",
                                    f"{robot.node.full_name}: {text}")
            sent(self._diagnostics, diagnostics(
                (robot.status(self.refusals.get(number, ""), slipping[number], late)
                 for number, robot in enumerate(self.robots)), self.time_ns))

        if self._is_due("line", now_s, LINE_S):
            commands = sum(robot.command.count for robot in self.robots)
            self.say(f"{self.cycles * self.period_s:.0f} s of the robot's time: {commands} commands heard, "
                     f"{self.lateness.late} cycles late")

    def _look_at_graph(self, now_s: float) -> None:
        for name in self.participant.namesakes():
            self.told.tell(now_s, f"{name}: namesake", f"another node is called {name} in domain "
                           f"{self.options.domain}; give --namespace or --domain")
        for topic, kind, why in self.participant.new_writers():
            for robot in self.robots:
                robot.wrong_type(topic, kind, why, now_s)
        for robot in self.robots:
            robot.look_for_publishers()
        for text in self.participant.remarks():
            self.say(text)

    def _pass_on(self, now_s: float) -> None:
        """Tells of what libraries have printed."""
        for line in self.library.take() if self.library else ():
            found = unreadable_of(line)
            if found is None or not any([robot.unreadable(*found, now_s) for robot in self.robots]):
                self.told.tell(now_s, kind_of(line), f"the library of the wire: {line}")

    # ---- the loop

    def run(self) -> None:
        """Cycles until the duration is over; a signal ends it by its exception."""
        pace_s = self.period_s / self.options.speed
        gc.collect()
        gc.freeze()
        due_s, cycles = self.clock.now_s(), cycles_of(self.options, self.period_s)
        while cycles is None or self.cycles < cycles:
            wait_s = due_s - self.clock.now_s()
            if wait_s > 0.0:
                self.clock.sleep(wait_s)
            late_s = self.clock.now_s() - due_s
            self.lateness.seconds.append(late_s)
            self.lateness.late += late_s > pace_s
            if late_s > max(CATCH_UP_S, pace_s):
                self._skip(late_s)
                due_s += late_s
            self.cycle()
            due_s += pace_s

    def _skip(self, late_s: float) -> None:
        self.lateness.skipped_s += late_s
        if self.options.speed > 1.0:
            self.told.tell(self.clock.now_s(), "late", f"--speed {self.options.speed:g} is more than this machine can, "
                           "so the robot runs as fast as it can; the figures at the end state how fast")
            return
        self.told.tell(self.clock.now_s(), "late", f"the machine was {late_s:.2g} s too late for a cycle; the robot's "
                       "time stood still meanwhile")

    def close(self) -> None:
        """Leaves the domain."""
        gc.unfreeze()
        self.participant.close()

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def figures(self) -> dict[str, Any]:
        """What was done."""
        self._pass_on(self.clock.now_s())
        for robot in self.robots:
            robot.look_for_publishers()
        ends = [{"name": robot.node.full_name, "x_m": seen.x_m, "y_m": seen.y_m, "heading_rad": seen.heading_rad}
                for robot, seen in zip(self.robots, self.base.look(), strict=True)]
        return {"cycles": self.cycles, "is_faster": self.options.speed > 1.0, "period_s": self.period_s,
                "robots": self.options.robots, "frame": self._frames["base"],
                "found_publisher": None if "zenoh" in self.options.services_for else
                any(robot.had_publisher for robot in self.robots),
                "messages": sum(robot.messages for robot in self.robots),
                "commands": sum(robot.command.count for robot in self.robots), "late_cycles": self.lateness.late,
                "skipped_s": self.lateness.skipped_s, **self.lateness.figures(),
                "final": {key: value for key, value in ends[0].items() if key != "name"}, "ends": ends,
                "events": dict(self.told.counts)}


def middleware_of(options: Ros2Options) -> Middleware:
    """A participant of DDS, or a session of Zenoh; only that package must be there."""
    if "zenoh" in options.services_for:
        from laconic.ros2.zenoh import Context

        return Context(options.domain, options.distribution, is_local=options.is_local, announces=options.announces,
                       router=options.router, listen=options.listen)
    from laconic.ros2.wire import Participant

    return Participant(options.domain, options.distribution, is_local=options.is_local, announces=options.announces,
                       middlewares=options.services_for)


# ---- what can be checked beforehand

def check_options(options: Ros2Options) -> None:
    """BadInput for numbers that no run can have."""
    if not 1 <= options.robots <= MOST_ROBOTS:
        raise BadInput(f"--robots: {options.robots} is not from 1 to {MOST_ROBOTS}; give another number")
    for name, value in (("--speed", options.speed), ("--duration", options.duration_s),
                        ("--spacing", options.spacing_m)):
        if value is not None and not 0.0 < value < math.inf:
            raise BadInput(f"{name}: {value:g} is not usable; give a finite number above zero")
    if options.speed != 1.0 and not options.is_sim_time:
        raise BadInput(f"--speed: {options.speed:g} needs stamps of simulated time; add --sim-time")
    if options.speed > MOST_SPEED:
        raise BadInput(f"--speed: {options.speed:g} is more than any machine can; give at most {MOST_SPEED:g}, which "
                       "runs as fast as it can")
    if options.robots > 1 and options.record:
        raise BadInput("--record: keeps the run of one robot; leave out --robots")
    if options.map_file and not options.is_loopback:
        raise BadInput("--map: has a meaning with --loopback alone; add it")


def cycle_of(scene: Scene, options: Ros2Options) -> tuple[float, int]:
    """The period, and the steps in it; BadInput where the rate does not fit the step."""
    if not 0.0 < options.rate_Hz < math.inf:
        raise BadInput(f"--rate: {options.rate_Hz:g} Hz is not usable; give a number above 0, such as 50")
    period_s, step_s = 1.0 / options.rate_Hz, scene.run.step_s
    steps = round(period_s / step_s)
    if steps < 1 or abs(steps * step_s - period_s) > 1e-6 * step_s:
        near = f"{1.0 / (max(steps, 1) * step_s):.6g} Hz"
        raise BadInput(f"--rate: a period of {period_s:.6g} s is not a whole number of steps of {step_s:g} s; give "
                       f"{near}, or another --step")
    return steps * step_s, steps


def cycles_of(options: Ros2Options, period_s: float) -> int | None:
    """How many cycles there are; None without an end."""
    return None if options.duration_s is None else max(1, round(options.duration_s / period_s))


def frames_of(given: Sequence[str]) -> dict[str, str]:
    """Frames by their parts, from NAME=FRAME."""
    found = dict(FRAMES)
    for each in given:
        name, _, frame = each.partition("=")
        if name not in FRAMES or not frame:
            raise BadInput(f"--frame: {each} is not NAME=FRAME; give one of {', '.join(FRAMES)}, such as "
                           "base=base_footprint")
        found[name] = frame.lstrip("/")
    for name, frame in found.items():
        if others := [other for other, its in found.items() if its == frame and other != name]:
            raise BadInput(f"--frame: {name} and {others[0]} are both called {frame}; give each frame a name of its "
                           "own")
    return found


def description_of(path: Path) -> str:
    """The text of a URDF; BadInput for another file."""
    text = text_of_file(path, "a URDF file").text
    root = root_of(path, text, "is no URDF, which is XML")
    if root.tag != "robot" or root.find("link") is None and root.find("joint") is None:
        raise BadInput(f"{path}: is no URDF; give the file with <robot>, its links and joints (of xacro: what xacro "
                       "makes of it)")
    return text


def base_at_its_start(scene: Scene, robots: int) -> Base:
    """The base, whose body frame begins where the scene puts the centre of mass, so that odometry and truth agree."""
    made = base_of(scene, robots)
    seen, start = made.look()[0], scene.initial
    if (seen.x_m, seen.y_m) == (start.x_m, start.y_m):
        return made
    moved = replace(start, x_m=2.0 * start.x_m - seen.x_m, y_m=2.0 * start.y_m - seen.y_m)
    return base_of(replace(scene, initial=moved), robots)


def spread(base: Base, options: Ros2Options) -> None:
    """Puts several robots side by side, so that they do not stand in each other."""
    start = [base.motion.look(robot, 0.0) for robot in range(options.robots)]
    for robot in range(1, options.robots):
        at = start[robot]
        base.place(robot, at.x_m, at.y_m + robot * options.spacing_m, at.heading_rad)


# ---- the record of a run

def write_record(session: Session) -> int:
    """Writes the scene with the voltages that acted, and returns the steps; `laconic simulate` gives the same bits."""
    path, base = session.options.record, session.base
    assert path is not None and base.record is not None
    if not base.record:
        raise ResultFails(f"{path}: not written, since no step was taken")
    rows = np.array(base.record)
    while len(text := recorded(session, rows)) > MOST_RECORDED:
        rows = rows[: int(0.98 * len(rows) * MOST_RECORDED / len(text))]
    with opened(path) as file:
        file.write(text)
    return len(rows)


def recorded(session: Session, rows: np.ndarray) -> str:
    """The text of a scene with these inputs, step by step."""
    base, step_s = session.base, session.scene.run.step_s
    entries = read_toml(session.scene.path).plain()
    start = session.scene.initial
    if (start.x_m, start.y_m) != (0.0, 0.0):
        entries["initial"] = {**(entries.get("initial") or {}), "x_m": start.x_m, "y_m": start.y_m}
    entries["run"] = {**{key: value for key, value in entries["run"].items() if key != "tolerance"},
                      "duration_s": len(rows) * step_s, "step_s": step_s, "method": session.scene.run.method,
                      "real": session.scene.run.real}
    entries["input"] = [changes(signal, column, step_s) for signal, column in zip(base.signals, rows.T, strict=True)
                        if column.any()]
    if (entries.get("outputs") or {}).get("every_s"):
        entries["outputs"]["every_s"] = step_s
    if not entries["input"]:
        entries.pop("input")
    return "\n".join(lines_of(entries, {})) + "\n"


def changes(signal: str, values: np.ndarray, step_s: float) -> dict[str, Any]:
    """An [[input]] of kind "steps" with the instants at which the value changes."""
    is_new = np.append(True, values[1:] != values[:-1])
    steps = np.flatnonzero(is_new)
    return {"signal": signal, "kind": "steps", "t_s": [round(float(step) * step_s, 12) for step in steps],
            "value": [float(each) for each in values[is_new]]}
