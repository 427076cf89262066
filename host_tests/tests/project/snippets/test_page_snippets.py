"""Every snippet of the pages runs, in the order of its page and in one empty folder, or its page says why not.

page_snippets.py has the marks by which a page says so.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import socket
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from click import Context
from page_snippets import ALL, PAGES, SHELL, SHOWN, Snippet

from laconic.base.paths import SCENE_DIR, SOURCE_DIR, build_dir
from laconic.cli.main import commands, run
from laconic.robot.logs.column_map import read_map
from laconic.scene.scene import scene_of
from laconic.scene.table import Table, read_toml

NOT_RUN = 61  # a page that leaves out one more says so here, too
OF_THE_READER = {"my.toml": "scenes/kuka_youbot.toml", "robot.urdf": ("docs/tutorial.md", "xml"),
                 "program.c": ("README.md", "c")}
"""Files that pages call by these names: a file of the project, or a page's first snippet in a language."""
KNOWN = "".join((SOURCE_DIR / "python" / name).read_text(encoding="utf-8") for name in (
    "requirements.in", "requirements-peers.in"))
SLOW = {"c", "ros2", "bags", "scenes", "control", "rig", "rig-ports", "how-to", "play-drives", "sweep", "accuracy"}
"""Pages whose snippets take more than some seconds."""
PAGES_THAT_RUN = [pytest.param(page, id=str(page.relative_to(SOURCE_DIR)),
                               marks=[pytest.mark.nightly] if page.stem in SLOW else [])
                  for page in sorted({snippet.page for snippet in ALL if snippet.runs_here})]


@dataclass
class Reader:
    """Who follows a page in an empty folder."""

    printed: str = ""
    names: dict[str, Any] = field(default_factory=lambda: {"__name__": "__main__"})
    beside: list[subprocess.Popen[str]] = field(default_factory=list)
    ports: dict[str, str] = field(default_factory=dict)

    def with_ports(self, text: str) -> str:
        for given, free in self.ports.items():
            text = text.replace(given, free)
        return text


@pytest.fixture
def reader(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Reader]:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    for name, source in OF_THE_READER.items():
        if isinstance(source, str):
            shutil.copy(SOURCE_DIR / source, name)
        else:
            page, language = source
            first = next(each for each in ALL if each.page == SOURCE_DIR / page and each.language == language)
            Path(name).write_text(first.text, encoding="utf-8")
    found = Reader()
    yield found
    for each in found.beside:
        each.terminate()
    for each in found.beside:
        each.communicate(timeout=20)


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def start_beside(reader: Reader, snippet: Snippet, port: str) -> None:
    """Starts what keeps running, and waits until it says that its port is open."""
    reader.ports[port] = str(free_port())
    Path("program.py").unlink(missing_ok=True)
    command, *rest = snippet.commands()
    words = shlex.split(reader.with_ports(command).removesuffix("&"))
    words[0] = words[0].replace("build/", f"{build_dir()}/")
    reader.beside.append(subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True))
    announced = any("listening" in line for line in reader.beside[-1].stdout or ())
    assert announced, f"{snippet.where}: {reader.beside[-1].communicate()[1]}"
    for each in rest:
        run_command(reader, snippet, each)


def run_command(reader: Reader, snippet: Snippet, command: str) -> None:
    """One line of a shell block."""
    command = reader.with_ports(command)
    words = shlex.split(command)
    if words[:2] == ["pip", "install"]:
        assert [name for name in words[2:] if f"\n{name}" not in KNOWN] == [], command
    elif words[0] == "laconic" and "&&" not in words:
        assert run(words[1:]) == 0, f"{snippet.where}: {command}"
    else:
        done = subprocess.run(command, shell=True, check=False, capture_output=True, text=True)
        assert done.returncode == 0, f"{snippet.where}: {command}\n{done.stderr}"
        print(done.stdout)


def run_python(reader: Reader, snippet: Snippet) -> None:
    """A page's Python goes on from block to block; beside another process it is a program of its own."""
    code = reader.with_ports(snippet.shortened)
    if not reader.beside:
        exec(compile(code, snippet.where, "exec"), reader.names)
        return
    with Path("program.py").open("a", encoding="utf-8") as program:
        program.write(code)
    done = subprocess.run([sys.executable, "program.py"], check=False, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, f"{snippet.where}:\n{done.stderr}"
    print(done.stdout)


def read_tables(snippet: Snippet) -> None:
    """Tables of a scene as part of the scene that the page's mark names; other tables are a map of a log's columns."""
    Path("given.toml").write_text(snippet.text, encoding="utf-8")
    scene, = snippet.marked("scene") or [""]
    if not scene:
        read_map(Path("given.toml"))
    elif scene == "itself":
        scene_of(read_toml(Path("given.toml")))
    else:
        base = read_toml(SCENE_DIR / f"{scene}.toml").plain()
        scene_of(Table(Path(snippet.page.name), "", joined(base, read_toml(Path("given.toml")).plain())))


def joined(base: dict[str, Any], given: dict[str, Any]) -> dict[str, Any]:
    """A scene with some of its tables replaced; a wheel with a kind is one more, else it says more of the first.

    A ground with friction takes the place of the vehicle's coefficient for the no-slip margin.
    """
    if "friction_coefficient" in given.get("ground", {}):
        base["vehicle"].pop("friction_coefficient", None)
    for key, value in given.items():
        if key == "wheel":
            for each in value:
                base[key] += [each] if "kind" in each else []
                base[key][0] |= {} if "kind" in each else each
        elif isinstance(value, dict):
            base[key] = joined(base.get(key, {}), value)
        else:
            base[key] = value
    return base


@pytest.mark.parametrize("page", PAGES_THAT_RUN)
def test_what_a_page_shows_does_what_the_page_says(page: Path, reader: Reader,
                                                   capsys: pytest.CaptureFixture[str]) -> None:
    for snippet in (each for each in ALL if each.page == page):
        if snippet.language in SHOWN and reader.printed:
            assert all(line in reader.printed for line in snippet.text.splitlines()), snippet.where
        reader.printed = ""
        if not snippet.runs_here:
            continue
        if snippet.marked("beside"):
            start_beside(reader, snippet, snippet.marked("beside")[0])
        elif snippet.language in SHELL:
            for command in snippet.commands():
                run_command(reader, snippet, command)
        elif snippet.language == "python":
            run_python(reader, snippet)
        else:
            assert snippet.language == "toml", f"{snippet.where}: nothing here runs {snippet.language}; mark it"
            read_tables(snippet)
        reader.printed = capsys.readouterr().out


def test_pages_whose_snippets_run_at_night_name_commands_and_options_that_exist() -> None:
    lines = [(snippet, line) for snippet in ALL if snippet.page.stem in SLOW and snippet.language in SHELL
             for line in snippet.text.replace("\\\n", " ").splitlines()
             if line.lstrip("$ ").startswith("laconic ")]
    assert len(lines) > 60
    for snippet, line in lines:
        _, name, *words = line.lstrip("$ ").split("#")[0].split(";")[0].split("&")[0].split("|")[0].split()
        command = commands.get_command(Context(commands), name)
        assert command is not None, (snippet.where, line)
        known = {option for each in command.params for option in (*each.opts, *each.secondary_opts)} | {"--help"}
        options = {word.partition("=")[0] for word in words if word.startswith("--") and word != "--"}
        assert options <= known, (snippet.where, line, options - known)


def test_every_snippet_that_is_not_run_says_why_and_there_are_no_more_of_them() -> None:
    left_out = [snippet for snippet in ALL if snippet.marked("not run")]
    assert all(len(reason.split()) > 1 for snippet in left_out for reason in snippet.marked("not run"))
    per_page = Counter(str(snippet.page.relative_to(SOURCE_DIR)) for snippet in left_out)
    assert sum(per_page.values()) == NOT_RUN, per_page
    assert sum(snippet.language not in SHOWN for snippet in ALL) > NOT_RUN + 50


@pytest.mark.parametrize("test", sorted({test for snippet in ALL for test in snippet.marked("run by")}))
def test_a_test_that_a_page_names_reads_that_page(test: str) -> None:
    text = (SOURCE_DIR / test).read_text(encoding="utf-8")
    pages = {snippet.page for snippet in ALL if test in snippet.marked("run by")}
    assert [page.name for page in pages if page.name not in text] == []


def test_no_command_hides_in_a_block_that_shows_output() -> None:
    commands = re.compile(r"^(\$ |laconic \w+ |pip install |python |cmake )", re.MULTILINE)
    assert [each.where for each in ALL if each.language in SHOWN and commands.search(each.text)] == []


def test_every_mark_of_a_page_stands_above_a_snippet() -> None:
    for page in PAGES:
        written = len(re.findall(r"<!-- (?!all )[a-z ]+: ", page.read_text(encoding="utf-8")))
        of_snippets = sum(len(each.marks) for each in ALL if each.page == page)
        whole = len(re.findall(r"<!-- all ", page.read_text(encoding="utf-8")))
        assert written == of_snippets - whole * sum(each.page == page for each in ALL), page
