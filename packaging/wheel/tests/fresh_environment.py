"""An empty environment with the wheel in it: what a new user has after `pip install`, and nothing else."""

from __future__ import annotations

import os
import re
import subprocess
import time
import venv
from dataclasses import dataclass
from importlib.metadata import requires
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

PROJECT = Path(__file__).resolve().parents[3]
LOCK = PROJECT / "python" / "requirements.txt"


@dataclass(frozen=True)
class Environment:
    """An environment of Python in an empty folder, where its commands run."""

    folder: Path

    @property
    def bin(self) -> Path:
        """Where its commands are."""
        return self.folder / "venv" / "bin"

    def run(self, *command: str, status: int = 0) -> subprocess.CompletedProcess[str]:
        """Runs one of its commands, with no other on the search path: no compiler. Prints how long it took."""
        began = time.perf_counter()
        done = subprocess.run([str(self.bin / command[0]), *command[1:]], cwd=self.folder, text=True, check=False,
                              capture_output=True, env={"PATH": str(self.bin), "HOME": str(self.folder)})
        print(f"{time.perf_counter() - began:6.2f} s  {' '.join(command)[:90]}")
        assert done.returncode == status, done.stdout + done.stderr
        return done

    def pip(self, *arguments: str) -> None:
        """Installs, with the settings that this machine has for pip; prints how long it took."""
        began = time.perf_counter()
        command = [str(self.bin / "python"), "-m", "pip", "--disable-pip-version-check", "install", "-q",
                   "--no-compile", *arguments]
        settings = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}  # is not installed here
        done = subprocess.run(command, cwd=self.folder, text=True, check=False, capture_output=True, env=settings)
        print(f"{time.perf_counter() - began:6.2f} s  pip install {Path(arguments[-1]).name}")
        assert done.returncode == 0, done.stdout + done.stderr


def fresh_environment(folder: Path, wheel: Path, extras: tuple[str, ...]) -> Environment:
    """With the wheel, and with what it needs as the project's lock has it, hashes checked."""
    venv.create(folder / "venv", with_pip=True)
    made = Environment(folder)
    lock = folder / "requirements.txt"
    lock.write_text(locked(needed_by(f"laconic[{','.join(extras)}]")), encoding="utf-8")
    made.pip("--require-hashes", "--no-deps", "-r", str(lock))
    made.pip("--no-deps", "--no-index", str(wheel))
    return made


def needed_by(wanted: str) -> set[str]:
    """Names of the distributions that a requirement needs here, by the metadata of the build's environment."""
    found: set[str] = set()
    waiting = [Requirement(wanted)]
    seen = set()
    while waiting:
        each = waiting.pop()
        for extra in ("", *each.extras):
            if (each.name, extra) in seen:
                continue
            seen.add((each.name, extra))
            needs = map(Requirement, requires(each.name) or [])
            waiting += [need for need in needs if need.marker is None or need.marker.evaluate({"extra": extra})]
        found.add(canonicalize_name(each.name))
    return found - {Requirement(wanted).name}


def locked(names: set[str]) -> str:
    """Those parts of the lock, version and hashes, that are for these distributions."""
    blocks = re.split(r"^(?=[a-z0-9])", LOCK.read_text(encoding="utf-8"), flags=re.MULTILINE | re.IGNORECASE)
    chosen = [block for block in blocks if canonicalize_name(re.split(r"[=\[ ]", block)[0]) in names]
    return "".join(chosen)
