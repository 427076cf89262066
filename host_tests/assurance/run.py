"""The one entry: `build/venv/bin/python host_tests/assurance/run.py NAME [options]` runs a part and prints its result.

The exit status is 0 where nothing was found that must not be, 1 where something was, 2 where the part cannot run."""

from __future__ import annotations

import argparse
import importlib
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from assurance.common import Unusable

PARTS = {
    "boards": "emulated boards started again and again, idle and with all cores busy",
    "faults": "memory, power and clocks of a node fail in the midst of a session",
    "fuzz": "whatever reads bytes, frames, calls, vehicles and files, under sanitizers",
    "gazebo": "Gazebo's physics on the same robots: error against step, and time of a step",
    "imports": "robots' files with something broken",
    "long": "long runs beside independent references",
    "misra": "MISRA C:2012 by cppcheck's addon",
    "mujoco_trees": "MuJoCo on vehicles with hinges that slip: time of a step, where they end, and why elsewhere",
    "mutate": "small faults in the C sources, which the C tests should notice",
    "population": "made-up vehicles beside their true motion",
    "proof": "Frama-C: no undefined behaviour for any input",
    "ros2": "robots on ROS 2 among broken messages and packets",
    "rules": "what CONTRIBUTING.md asks of every file",
    "sizes": "lines and files of product, tests and apparatus",
    "targets": "the same bits from other compilers, processors and boards",
    "tidy": "clang-tidy",
}


def main(words: list[str]) -> int:
    layout = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(prog="assurance", description=__doc__, formatter_class=layout)
    parts = parser.add_subparsers(dest="part", metavar="NAME", required=True)
    for name, text in PARTS.items():
        parts.add_parser(name, help=text, add_help=False)
    options, rest = parser.parse_known_args(words)
    module = importlib.import_module(f"assurance.{options.part}")
    own = argparse.ArgumentParser(prog=f"assurance {options.part}", description=module.__doc__,
                                  formatter_class=layout)
    module.arguments(own)
    try:
        return 0 if module.run(own.parse_args(rest)) else 1
    except Unusable as why:
        print(f"assurance {options.part}: {why}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print(f"assurance {options.part}: stopped by the user", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
