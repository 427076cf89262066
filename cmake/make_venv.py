"""Make the Python environment that the build and the `laconic` command use: locked packages, then our own, editable.

Without --requirements it ends when pip is there, which is all that other parts of the build need to fetch theirs.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
import venv
from pathlib import Path


def main() -> int:
    arguments = parse()
    try:
        create(arguments.venv)
        python = next(path for path in candidates(arguments.venv) if path.exists())
        if arguments.requirements:
            install_locked(python, arguments.requirements)
        if arguments.packages:
            own = [word for folder in arguments.packages for word in ("--editable", str(folder))]
            pip(python, "install", "--no-build-isolation", "--no-deps", *own)
    except subprocess.CalledProcessError as failure:
        print(f"laconic: the Python environment could not be made: {reason(failure)}", file=sys.stderr)
        return 1
    arguments.stamp.write_text("made by make_venv.py\n")
    return 0


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("venv", "stamp"):
        parser.add_argument(f"--{name}", type=Path, required=True)
    parser.add_argument("--requirements", type=Path, help="the lock file")
    parser.add_argument("--packages", type=Path, nargs="+", default=[], help="folders of our own packages")
    return parser.parse_args()


def create(directory: Path) -> None:
    """A new environment; one that an earlier attempt left incomplete is replaced."""
    if any(path.exists() for path in candidates(directory)):
        return
    shutil.rmtree(directory, ignore_errors=True)
    venv.create(directory, with_pip=True)


def candidates(directory: Path) -> list[Path]:
    return [directory / "bin" / "python", directory / "Scripts" / "python.exe"]


def install_locked(python: Path, requirements: Path) -> None:
    """Install the lock file and show the progress: this can take a minute.

    pip would compile every module on one core, more than half of them tests of the packages that nobody imports.
    """
    wanted = len(re.findall(r"^[a-z0-9].*==", requirements.read_text(), re.MULTILINE | re.IGNORECASE))
    command = [str(python), "-m", "pip", "install", "--no-compile", "--require-hashes", "--no-input", "-r",
               str(requirements)]
    seen, lines = 0, []
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        for line in process.stdout:
            lines.append(line)
            if line.startswith(("Collecting", "Requirement already", "Ignoring")):
                seen += 1
                progress(f"laconic: Python packages {seen} of {wanted}", last=False)
            elif line.startswith("Installing collected"):
                progress("laconic: Python packages: all there, installing", last=True)
    if process.returncode:
        raise subprocess.CalledProcessError(process.returncode, command, "".join(lines))
    compile_modules(python)


def compile_modules(python: Path) -> None:
    """Byte code for what can be imported, on all cores; a module that cannot be compiled is left to its importer."""
    libraries = str(python.parent.parent / ("Lib" if python.suffix else "lib"))
    subprocess.run([str(python), "-m", "compileall", "-q", "-j", "0", "-x", r"[/\\](tests?|pip)[/\\]", libraries],
                   check=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def progress(text: str, last: bool) -> None:
    if sys.stdout.isatty():
        print(f"\r{text:60}", end="\n" if last else "", flush=True)
    elif last:
        print(text, flush=True)


def pip(python: Path, *arguments: str) -> None:
    subprocess.run(
        [str(python), "-m", "pip", *arguments], check=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )


def reason(failure: subprocess.CalledProcessError) -> str:
    """The line of the failed command's output that gives the reason."""
    text = failure.output if isinstance(failure.output, str) else (failure.output or b"").decode(errors="replace")
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    errors = [line for line in lines if line.startswith("ERROR")]
    if "ensurepip" in " ".join(map(str, failure.cmd)):
        return "pip cannot be put into it: install your system's python3-venv"
    if any("ConnectionError" in line or "ConnectTimeout" in line or "from versions: none" in line for line in lines):
        return "the package index cannot be reached: connect this machine once, or configure pip for a mirror"
    return (errors or lines or [f"exit status {failure.returncode}"])[0]


if __name__ == "__main__":
    sys.exit(main())
