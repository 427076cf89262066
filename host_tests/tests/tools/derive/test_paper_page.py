"""docs/paper.md keeps its promises: the tests it names exist, its pictures are there, its commands can be called."""

import re
import shlex

import pytest

from laconic.base.paths import SCENE_DIR, SOURCE_DIR
from laconic.cli import main as cli

PAGE = (SOURCE_DIR / "docs" / "paper.md").read_text()
TESTS = "\n".join(path.read_text() for path in (SOURCE_DIR / "host_tests" / "tests").rglob("test_*.py"))
COMMANDS = [shlex.split(line, comments=True) for line in PAGE.splitlines() if line.startswith("laconic ")]


@pytest.mark.parametrize("name", sorted(set(re.findall(r"`(test_\w+)`", PAGE))))
def test_every_test_that_the_page_names_exists(name):
    assert f"def {name}(" in TESTS


@pytest.mark.parametrize("picture", re.findall(r"!\[.*?\]\((.*?)\)", PAGE))
def test_every_picture_of_the_page_is_there(picture):
    assert (SOURCE_DIR / "docs" / picture).stat().st_size > 10_000


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_every_command_of_the_page_can_be_called_as_it_stands(words):
    command = cli.commands.get_command(None, words[1])
    context = command.make_context(words[1], list(words[2:]))
    scene = context.params.get("scene")
    assert scene is None or (SCENE_DIR / f"{scene}.toml").exists()


def test_every_erratum_and_the_whole_of_section_5_are_on_the_page():
    for number in range(1, 6):
        assert f"`test_erratum_{number}_" in PAGE
    for word in ("ellipses", "many petals", "parabola", "subcritical", "caster", "no slip"):
        assert word in PAGE
