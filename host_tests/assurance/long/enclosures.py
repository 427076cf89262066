"""Enclosures of all scenes over their whole run, then of random vehicles, up to a million times as stiff: how wide they
are, and how far the core is from them."""

from __future__ import annotations

import random
import tempfile
from pathlib import Path

from assurance.common import Clock
from laconic.errors import BadInput, LaconicError
from laconic.scene import Scene, read_scene, rigid_scene_names
from laconic.tools.enclosure.readings import check_enclosable
from laconic.tools.enclosure.study import verify_scene_enclosed
from laconic.tools.verify.trajectories import EnclosedResult, bound_text

NARROW = 1e-12
STEPS_S = ("0.001", "0.01")


def run_enclosures(clock: Clock, seed: int) -> list[str]:
    """Every scene to its end, however long; then random vehicles until the time is up. All must be narrow."""
    source, wide, drawn = random.Random(seed), list[str](), list[EnclosedResult]()
    for name in rigid_scene_names():
        text, is_wide = of_scene(read_scene(name))
        print(f"  {name}: {text}", flush=True)
        wide += [name] if is_wide else []
    while not drawn or clock:
        text = random_scene(source)
        drawn.append(enclosed(text))
        wide += [text] if drawn[-1].status != "ok" or drawn[-1].width > NARROW else []
    fine = [each for each in drawn if each.status == "ok"]
    for what, numbers in (("width", sorted(each.width for each in fine)),
                          ("error", sorted(each.worst for each in fine))):
        shares = ((share, numbers[min(len(numbers) - 1, int(share * len(numbers)))]) for share in (0.5, 0.95, 1.0)
                  if numbers)
        print(f"  {what} of {len(drawn)} random vehicles:",
              ", ".join(f"{share:.0%} at most {bound_text(number)}" for share, number in shares))
    return wide


def of_scene(scene: Scene) -> tuple[str, bool]:
    """A scene's figures in words, and whether it is wider than it should be."""
    try:
        check_enclosable(scene)
    except BadInput as why:
        return f"not enclosed: {str(why).removeprefix(f'{scene.path}: ')}", False
    double, single = (verify_scene_enclosed(scene.with_run(real=real), shown=False) for real in ("double", "single"))
    return (f"width ≤ {bound_text(double.width)}, error of nu, pose, wheels ≤ {errors_of(double)}, in single ≤ "
            f"{errors_of(single)}"), double.width > NARROW


def errors_of(found: EnclosedResult) -> str:
    """Its three errors, or why there are none."""
    errors = (found.error_nu, found.error_pose, found.error_wheel)
    return ", ".join(bound_text(each or 0.0) for each in errors) if found.status == "ok" else found.status


def random_scene(source: random.Random) -> str:
    """A carriage of omni and mecanum wheels, pushed by voltages that change once, its motors up to a million times as
    strong in damping."""
    stiff, wheels = 10.0 ** source.uniform(0.0, 6.0), source.randrange(3, 7)
    lines = ["[vehicle]", f"mass_kg = {source.uniform(2, 40)!r}", f"yaw_inertia_kgm2 = {source.uniform(0.05, 3)!r}",
             f"com_x_m = {source.uniform(-0.05, 0.05)!r}", f"com_y_m = {source.uniform(-0.05, 0.05)!r}",
             f"wheel_radius_m = {source.uniform(0.03, 0.12)!r}",
             f"wheel_inertia_kgm2 = {10.0 ** source.uniform(-4, -2)!r}",
             f"motor_gain_Nm_per_V = {0.1 * stiff!r}", f"motor_damping_Nms = {0.02 * stiff!r}"]
    for i in range(wheels):
        roller = source.choice((90.0, 45.0, -45.0))
        bearing = 360.0 * (i + source.uniform(-0.3, 0.3)) / wheels
        lines += ["[[vehicle.wheel]]", 'kind = "roller"', f"distance_m = {source.uniform(0.1, 0.4)!r}",
                  f"bearing_deg = {bearing!r}", f"axle_deg = {bearing if roller == 90.0 else -90.0!r}",
                  f"roller_deg = {roller!r}"]
    for i in range(1, wheels + 1):
        values = [source.uniform(-3, 3), source.uniform(-3, 3)]
        lines += ["[[input]]", f'signal = "voltage_V[{i}]"', 'kind = "steps"', "t_s = [0.0, 0.5]",
                  f"value = {values!r}"]
    nu = [source.uniform(-5, 5) for _ in range(3)]
    return "\n".join([*lines, "[initial]", f"nu_rad_per_s = {nu!r}", "[run]", "duration_s = 1.0",
                      f"step_s = {source.choice(STEPS_S)}", ""])


def enclosed(text: str) -> EnclosedResult:
    """The enclosure of a scene's text; what goes wrong becomes the status."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "random.toml")
        path.write_text(text, encoding="utf-8")
        try:
            return verify_scene_enclosed(read_scene(path), shown=False)
        except LaconicError as error:
            return EnclosedResult("random", str(error))
