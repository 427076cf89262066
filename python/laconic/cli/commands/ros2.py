"""The robot as a ROS 2 node, without a ROS installation."""

from __future__ import annotations

import json
import os
import time
from typing import TYPE_CHECKING, Any

import click

from laconic.cli.options import (
    InputPath,
    OutputFile,
    SceneName,
    belongs_to,
    check_step,
    json_flag,
    one_of,
    only_one,
)
from laconic.errors import BadInput, ResultFails
from laconic.ros2 import GID_BYTES, MIDDLEWARES, OF_DDS, USUAL_DISTRIBUTION
from laconic.scene import METHODS, read_scene

if TYPE_CHECKING:
    from laconic.ros2.session import Session


LOCAL_PEERS = ('<General><Interfaces><NetworkInterface name="lo"/></Interfaces></General>'
               '<Discovery><Peers><Peer address="localhost"/></Peers></Discovery>')
MOST_ENDS = 5  # robots whose last pose is printed


@click.command("ros2")
@click.argument("scene_name", type=SceneName(hinges=True), metavar="SCENE")
@one_of("--distro", tuple(GID_BYTES), "Distribution of the peers, instead of ROS_DISTRO or jazzy")
@one_of("--rmw", tuple(MIDDLEWARES), "Middleware of the peers, instead of RMW_IMPLEMENTATION or "
        "both of DDS; zenoh is experimental")
@click.option("--domain", type=int, help="Domain.  [default: ROS_DOMAIN_ID, else 0]")
@click.option("--local", "is_local", is_flag=True, help="This machine alone, or a network without multicast.")
@click.option("--router", default="tcp/localhost:7447", metavar="ENDPOINT", show_default=True,
              help="With --rmw zenoh: where to connect.")
@click.option("--namespace", default="/", help="Of all topics, services and of the node.")
@click.option("--robots", type=int, default=1, help="Number of robots, in namespaces robot1, robot2 …")
@click.option("--spacing", "spacing_m", type=float, default=1.0, metavar="METRES", help="Between them at the start.")
@click.option("--rate", "rate_Hz", type=float, default=50.0, metavar="HZ", show_default=True, help="Of all topics.")
@click.option("--sim-time", "is_sim_time", is_flag=True, help="Stamps of simulated time, and /clock.")
@click.option("--speed", type=float, default=1.0, help="With --sim-time: seconds of the robot in a real one.")
@click.option("--stamped", is_flag=True, help="Hear TwistStamped alone on cmd_vel.  [default: also Twist]")
@click.option("--unstamped", is_flag=True, help="Hear Twist alone on cmd_vel.")
@click.option("--frame", "frames", multiple=True, metavar="NAME=FRAME",
              help="Another name of the frame base, odom, map, imu or scan.")
@click.option("--shared-tf", "shares_tf", is_flag=True, help="/tf for all, with the namespace before each frame.")
@click.option("--urdf", type=InputPath(), metavar="FILE", help="Publish this file as robot_description.")
@click.option("--loopback", "is_loopback", is_flag=True,
              help="For Nav2 without localization: initialpose, and map → odom from the exact pose.")
@click.option("--map", "map_file", type=InputPath(), metavar="FILE.yaml",
              help="With --loopback: publish this map, and the scan that the robot sees in it.")
@click.option("--no-discovery-info", "is_silent", is_flag=True, help="Leave the node out of the graph.")
@click.option("--duration", "duration_s", type=float, metavar="SECONDS",
              help="How long, by the robot's time.  [default: until Ctrl-C]")
@click.option("--record", type=OutputFile(".toml"), metavar="F.toml",
              help="Write the scene with the voltages that acted, for `laconic simulate`.")
@one_of("--method", METHODS, "Method instead of the scene's")
@click.option("--step", "step_s", type=float, metavar="H", help="Step in seconds instead of the scene's.")
@json_flag("Machine-readable summary.")
def command(scene_name: str, distro: str | None, rmw: str | None, domain: int | None, is_silent: bool,
            method: str | None, step_s: float | None, json_wanted: bool, stamped: bool, unstamped: bool,
            **given: Any) -> int:
    """Runs the robot of SCENE as a ROS 2 node: cmd_vel in; odom, tf, joint_states, imu … out.

    A controller as bases have one turns velocities into voltages, and odom is what its encoders make of the motion;
    ground_truth/odom is the motion itself. [base] of the scene has gains, limits and beliefs. The robot stops when
    cmd_vel falls silent. Ctrl-C ends the run with exit status 0; a step that was refused makes it 1.
    """
    check_step(step_s)
    belongs_to("--rmw zenoh", "zenoh" in middlewares_of(rmw), "--router")
    only_one({"--stamped": stamped, "--unstamped": unstamped})
    from laconic.ros2.session import Ros2Options, Session, write_record

    scene = read_scene(scene_name).with_run(method=method, step_s=step_s)
    options = Ros2Options(distribution_of(distro), domain_of(domain), announces=not is_silent,
                          services_for=middlewares_of(rmw),
                          is_stamped=stamped if stamped or unstamped else None, **given)

    def say(text: str) -> None:
        click.echo(text, err=json_wanted)

    from laconic.ros2.lines import library_lines

    began, cpu = time.perf_counter(), time.process_time()
    with library_lines(say) as library, Session(scene, options, say, library=library) as session:
        try:
            say(introduction(session))
            session.run()
        except KeyboardInterrupt:
            say("stopped by the user")
        figures = session.figures()
    seconds = time.perf_counter() - began
    figures |= {"seconds": seconds, "cpu_share": (time.process_time() - cpu) / seconds}
    if options.record:
        say(f"wrote {options.record}: {write_record(session)} steps")
    click.echo(json.dumps(figures, indent=1) if json_wanted else summary(figures))
    if session.refusals:
        raise ResultFails(next(iter(session.refusals.values())))
    return 0


def distribution_of(given: str | None) -> str:
    """The distribution of the command line, or that of the environment where it is known."""
    of_environment = os.environ.get("ROS_DISTRO", "")
    return given or (of_environment if of_environment in GID_BYTES else USUAL_DISTRIBUTION)


def middlewares_of(given: str | None) -> tuple[str, ...]:
    """The middleware of the command line, or that of the environment where it is known; else both of DDS."""
    of_environment = os.environ.get("RMW_IMPLEMENTATION", "")
    known = [name for name, package in MIDDLEWARES.items() if package == of_environment]
    return (given,) if given else tuple(known or OF_DDS)


def domain_of(given: int | None) -> int:
    """The domain of the command line, or of the environment, as ROS takes it."""
    text = os.environ.get("ROS_DOMAIN_ID", "")
    if given is not None or not text:
        return given or 0
    try:
        return int(text)
    except ValueError:
        raise BadInput(f"ROS_DOMAIN_ID: {text} is not a whole number; give a domain, 0 to 232") from None


def introduction(session: Session) -> str:
    """What it hears and how to drive it."""
    options, robots = session.options, session.robots
    topic = robots[0].command_topic.removeprefix("rt")
    kind = {None: "Twist or TwistStamped", True: "TwistStamped", False: "Twist"}[options.is_stamped]
    drives = " and AckermannDriveStamped on ackermann_cmd and drive of that namespace" if session.base.is_car else ""
    more = f" (and those of {len(robots) - 1} more)" if robots[1:] else ""
    stamps = f"simulated time at {options.speed:g} times" if options.is_sim_time else "the system's time"
    torques = "" if session.base.loop.signal == "voltage_V" else "; has no motors, so torques drive its wheels"
    moves = "\nthe scene starts in motion, which [initial] gives: the robot moves without a command" \
        if session.moves_at_start() else ""
    return (f"{session.scene.name}: {robots[0].node.full_name} in domain {options.domain}, {options.rate_Hz:g} Hz, "
            f"{stamps}; hears {kind} on {topic}{drives}{more}{torques}\n"
            f"drive it: {example_of(session, topic)}\n"
            f"without ROS: the program under \"A command without ROS\" in docs/ros2.md{peers_of(session)}; "
            f"stop with Ctrl-C{moves}")


def example_of(session: Session, topic: str) -> str:
    """A command for a ROS machine that can be pasted: of a car its Ackermann command, else a velocity."""
    rate = "ros2 topic pub -r 10"
    if session.base.is_car:
        return (f"{rate} {topic.removesuffix('cmd_vel')}ackermann_cmd ackermann_msgs/msg/AckermannDriveStamped "
                "'{drive: {speed: 0.5, steering_angle: 0.1}}'")
    velocity = "linear: {x: 0.1}, angular: {z: 0.5}"
    if session.options.is_stamped:
        return f"{rate} {topic} geometry_msgs/msg/TwistStamped '{{twist: {{{velocity}}}}}'"
    return f"{rate} {topic} geometry_msgs/msg/Twist '{{{velocity}}}'"


def peers_of(session: Session) -> str:
    """With --local, the setting by which a program on Cyclone DDS finds this robot, which multicast does not show."""
    if not session.options.is_local or "zenoh" in session.options.services_for:
        return ""
    return f", started with CYCLONEDDS_URI='{LOCAL_PEERS}'"


def nothing_heard(figures: dict[str, Any]) -> list[str]:
    """A line for a run without commands that names its likely cause."""
    if figures["commands"]:
        return []
    if figures["found_publisher"] is None:  # Zenoh does not show publishers
        return ["no command was heard; check the domain, the topic and --router"]
    if figures["found_publisher"]:
        return ["no command was heard: a publisher was found, but no usable message came from it"]
    return ["no command was heard: no publisher of a command that it hears was found; check the domain, the topic, "
            "and with --local the peer's discovery"]


def summary(figures: dict[str, Any]) -> str:
    """The run in some lines."""
    ran_s = figures["cycles"] * figures["period_s"]
    speed = f", {ran_s / figures['seconds']:.3g} times as fast as the clock" if figures["is_faster"] else ""
    ends = figures["ends"]
    lines = [f"{figures['cycles']} cycles of {1e3 * figures['period_s']:g} ms in {figures['seconds']:.2f} s{speed}, "
             f"{figures['commands']} commands heard, {figures['messages']} messages sent, "
             f"{100 * figures['cpu_share']:.0f} % of a core",
             f"late by {figures['late_median_ms']:.2g} ms in the median, {figures['late_99_percent_ms']:.2g} ms at "
             f"99 %, {figures['late_most_ms']:.2g} ms at most; {figures['late_cycles']} cycles by a period or more",
             *nothing_heard(figures),
             *(f"{end['name'] + ' ' if ends[1:] else ''}at x = {end['x_m']:.4f} m, y = {end['y_m']:.4f} m, heading "
               f"{end['heading_rad']:.4f} rad (of {figures['frame']})" for end in ends[:MOST_ENDS])]
    if ends[MOST_ENDS:]:
        lines.append(f"and {len(ends) - MOST_ENDS} more robots; --json lists all of them")
    lines += [f"{count} times {event}" for event, count in figures["events"].items()]
    return "\n".join(lines)
