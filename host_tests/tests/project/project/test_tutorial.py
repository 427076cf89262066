"""The tutorial, followed word by word in an empty folder."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from laconic.base.paths import SOURCE_DIR
from laconic.cli.main import run

PAGE = (SOURCE_DIR / "docs" / "tutorial.md").read_text(encoding="utf-8")
STEP = re.compile(r"```(?P<language>\w+)\n(?P<block>.*?)```|^    (?P<command>(?:laconic|python|cc|\./courier)\b.*?)$",
                  re.DOTALL | re.MULTILINE)
FILES = {"xml": "courier.urdf", "c": "courier.c"}


def printed_by(program: str, arguments: list[str]) -> str:
    """What a program prints; C is compiled without optimization, which takes a fraction of the time."""
    if program == "cc" and shutil.which("cc") is None:
        pytest.skip("no C compiler")
    arguments = ["-O0" if each == "-O2" else each for each in arguments]
    command = [sys.executable if program == "python" else program, *arguments]
    return subprocess.run(command, check=True, text=True, capture_output=True).stdout


def shows(block: str, printed: str) -> bool:
    """Whether a block is what was printed, with "…" for lines that it leaves out."""
    pattern = "".join(r"(?:.*\n)+" if line == "…" else re.escape(line) + r"\n" for line in block.splitlines())
    return re.fullmatch(pattern, printed) is not None


def test_every_step_does_what_the_page_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                            capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    printed, prints_of_x = "", []
    for step in STEP.finditer(PAGE):
        block = step["block"]
        if step["language"] == "text":
            assert shows(block, printed), block
        elif step["language"] == "python":
            Path("motors.py" if "motor" in block else "run.py").write_text(block, encoding="utf-8")
            if "motor" not in block:
                printed = printed_by("python", ["run.py"])
                prints_of_x.append(printed)
        elif step["language"] in FILES:
            Path(FILES[step["language"]]).write_text(block, encoding="utf-8")
        else:
            program, *arguments = shlex.split(step["command"])
            if program != "laconic":
                printed = printed_by(program, arguments)
                prints_of_x += [printed] if program == "./courier" else []
            else:
                assert run(arguments) == 0, step["command"]
                printed = capsys.readouterr().out
    made = {"first.png", "drive.png", "drive.csv", "courier.fmu", "courier"}
    assert {path.name for path in tmp_path.iterdir()} >= made
    assert len(prints_of_x) == 2
    assert prints_of_x[0] == prints_of_x[1]
