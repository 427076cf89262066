"""The demo of docs/fmu-importers.md: a vehicle, a CAN bus and a controller, each an FMU, connected by FMI-LS-BUS.

    python -m laconic.fmu.bus_demo FOLDER

writes vehicle.fmu, bus.fmu, controller.fmu and demo.json, which the FMU manipulation toolbox makes one FMU of, into
FOLDER, runs them by FMPy for two seconds, and prints where the vehicle is.
"""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

from laconic.base.paths import built
from laconic.fmu.bus_importer import Link, Network
from laconic.fmu.network import make_network_fmu
from laconic.scene import read_scene

SCENE, DRIVES = "robomaster_mecanum", "robomaster"
SETPOINT_RAD_PER_S = 5.0  # of each wheel: straight ahead
UNTIL_S, STEP_S = 2.0, 0.001
NAMES = ("bus.fmu", "vehicle.fmu", "controller.fmu")
LINKS: list[Link] = [(1, "CAN", 0, "Node1"), (2, "CAN", 0, "Node2")]
SHOWN = {1: ("x_m", "wheel_speed_rad_per_s[1]"), 0: ("frames_carried", "lost_arbitrations", "busy_s")}
"""Of which FMU what is printed."""


def make(folder: Path) -> None:
    """Writes the FMUs and the toolbox's description of their container."""
    folder.mkdir(parents=True, exist_ok=True)
    make_network_fmu(read_scene(SCENE), folder / "vehicle.fmu", drives=DRIVES)
    shutil.copyfile(built("fmu/LaconicCanBus_fmi3.fmu"), folder / "bus.fmu")
    shutil.copyfile(built("fmu/LaconicCanController_fmi3.fmu"), folder / "controller.fmu")
    container = {"name": "demo.fmu", "fmu": list(NAMES), "sequential": True, "step_size": STEP_S,
                 "link": [[NAMES[one], a, NAMES[two], b] for one, a, two, b in LINKS]}
    (folder / "demo.json").write_text(json.dumps(container, indent=1) + "\n", encoding="utf-8")


def demo(folder: Path, until_s: float = UNTIL_S) -> dict[str, float]:
    """Runs the FMUs by FMPy; the figures at the end by their names."""
    make(folder)
    setpoints = {f"setpoint_rad_per_s[{wheel}]": SETPOINT_RAD_PER_S for wheel in (1, 2, 3, 4)}
    with Network([folder / name for name in NAMES], LINKS) as network:
        network.start([{}, {}, setpoints])
        network.run(until_s, STEP_S)
        return {name: float(network.fmus[number].get(name)) for number, names in SHOWN.items() for name in names}


def main(arguments: Sequence[str]) -> int:
    """Prints a line for each figure."""
    if len(arguments) != 1:
        print("laconic.fmu.bus_demo: give one folder to write to", file=sys.stderr)
        return 2
    for name, value in demo(Path(arguments[0])).items():
        print(f"{name:26}{value:.9g}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
