"""The tutorial, followed word by word in an empty folder."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from laconic.cli.main import run
from laconic.paths import SOURCE_DIR, built

PAGE = (SOURCE_DIR / "docs" / "tutorial.md").read_text(encoding="utf-8")
STEP = re.compile(r"```(?P<language>\w+)\n(?P<block>.*?)```|^    (?P<command>(?:laconic|python) .*?)$",
                  re.DOTALL | re.MULTILINE)
FILES = {"xml": "courier.urdf", "c": "courier.c"}


def compiled(source: Path) -> str:
    """What the program prints, linked with the core."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        pytest.skip("no C compiler")
    program = source.with_suffix("")
    subprocess.run([compiler, "-std=c99", f"-I{SOURCE_DIR / 'core_c' / 'include'}", str(source),
                    str(built("core_c/liblaconic.a")), "-o", str(program)], check=True)
    return subprocess.run([str(program)], check=True, text=True, capture_output=True).stdout


def test_every_step_does_what_the_page_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                            capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    printed, prints_of_x = "", []
    for step in STEP.finditer(PAGE):
        block = step["block"]
        if step["language"] == "text":
            assert all(line in printed for line in block.splitlines()), block
        elif step["language"] == "python":
            Path("motors.py" if "motor" in block else "run.py").write_text(block, encoding="utf-8")
            if "motor" not in block:
                printed = subprocess.run([sys.executable, "run.py"], check=True, text=True, capture_output=True).stdout
                prints_of_x.append(printed)
        elif step["language"] in FILES:
            Path(FILES[step["language"]]).write_text(block, encoding="utf-8")
            if step["language"] == "c":
                prints_of_x.append(compiled(Path("courier.c").resolve()))
        else:
            program, *arguments = shlex.split(step["command"])
            if program == "python":
                subprocess.run([sys.executable, *arguments], check=True)
            else:
                assert run(arguments) == 0, step["command"]
                printed = capsys.readouterr().out
    assert {path.name for path in tmp_path.iterdir()} >= {"first.png", "drive.png", "drive.csv", "courier.fmu"}
    assert len(prints_of_x) == 2
    assert prints_of_x[0] == prints_of_x[1]
