"""Pages and public headers in plain English: short sentences, and none of the words that readers had to read twice.

`python test_plain_english.py` prints words, mean words of a sentence and the share of long ones for each page. Tables,
code and headings do not count. The lists may never force a worse sentence: change them when they do.
"""

from __future__ import annotations

import re
from pathlib import Path

import click
import pytest

from laconic.cli.main import commands

SOURCE = Path(__file__).resolve().parents[4]
GENERATED = {"signals.md", "wire.md"}
MORE = [SOURCE / "packaging/laconic_build/wire/wire_page.md", *sorted((SOURCE / "core_c/include/laconic").glob("*.h"))]
PAGES = [SOURCE / "README.md", *sorted(each for each in (SOURCE / "docs").rglob("*.md") if each.name not in GENERATED)]
MOST_PAGES, MOST_WORDS, MOST_MEAN, LONG, MOST_LONG = 30, 30_000, 15.0, 30, 0.03
WORDS = {  # what is not written: what is written instead
    r"\b(?:is|are|was|were) no (?!longer)\w+": "is not a …",
    r"\b(?:tells?|told)\b": "reports, prints, states, shows",
    r"\bbesides?\b": "compared with, in addition to, next to",
    r"\b(?:stands?|stood) (?:once|for|in|there|above|below|on the page)\b": "is defined, appears, is",
    r"\b(?:goes|go) (?:with|on)\b": "uses, requires, continues",
    r"\bthe truth\b|\btrue motions?\b": "the reference, the exact solution",
    r"\bdie[sd]? out\b|\bsettles\b": "decays, converges",
    r", too\b|\bfor so long\b|\bso many\b": "also; during that time; a number",
    r"\brooms?\b|\btwins?\b": "package, module; copy, reference run",
    r"\btaken again\b|\bwhole core\b": "repeated; full build",
}
END = re.compile(r"(?<=[.?!])(?:[\")])*\s+(?=[\"(]?[A-ZΑ-Ω0-9])")
OPENINGS = ("Of", "What", "Whoever", "Who", "That", "Where", "By", "Beside", "Besides")


def blocks(text: str) -> list[str]:
    """The paragraphs and items of lists, as one line each, without tables, code, headings, pictures and links."""
    text = re.sub(r"<!--.*?-->|^ *(`{3,}).*?^ *\1$|^\$\$.*?\$\$$", "\n\n", text, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"!\[[^\]]*\]\([^)]*\)|\$[^$\n]+\$", "X", text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    found: list[list[str]] = [[]]
    for line in text.splitlines():
        if not line.strip() or re.match(r"\s*(?:#|\||:::|---)", line) or line.startswith("    "):
            found.append([])
            continue
        if re.match(r"\s*(?:[*-]|\d+\.) ", line):
            found.append([])
        found[-1].append(re.sub(r"^\s*(?:[*-]|\d+\.) ", "", line).strip())
    return [re.sub(r"`[^`]+`|\*\*|\*", lambda code: "X" if code[0][0] == "`" else "", " ".join(lines))
            for lines in found if lines]


def sentences(text: str) -> list[str]:
    """Each sentence that has a word."""
    return [part for block in blocks(text) for part in END.split(block) if re.search(r"\w", part)]


def length(sentence: str) -> int:
    return sum(re.search(r"\w", word) is not None for word in sentence.split())


def habits(text: str) -> list[str]:
    """What a page says in a way that the lists rule out."""
    found = [habit for each in blocks(text) for habit in habits_of_words(each)]
    return found + [each[:60] for each in sentences(text) if each.split()[0] in OPENINGS and not each.endswith("?")]


def habits_of_words(line: str) -> list[str]:
    """The words of a line that the list rules out."""
    return [f"{hit[0]!r}: {better}" for pattern, better in WORDS.items() for hit in re.finditer(pattern, line, re.I)]


def counts(text: str) -> tuple[int, float, float]:
    lengths = [length(each) for each in sentences(text)] or [0]
    return sum(lengths), sum(lengths) / len(lengths), sum(each > LONG for each in lengths) / len(lengths)


def text_of(path: Path) -> str:
    """A page, or the comments of a header without the rows of their tables."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".md":
        return text
    comments = "\n\n".join(re.findall(r"/\*(.*?)\*/", text, re.DOTALL))
    return re.sub(r"^.*\S {2,}\S.*$", "\n", re.sub(r"^[ \t]*\*? ?", "", comments, flags=re.M), flags=re.M)


@pytest.mark.parametrize("page", PAGES + MORE, ids=lambda page: str(page.relative_to(SOURCE)))
def test_a_page_or_public_header_is_in_plain_english(page: Path) -> None:
    text = text_of(page)
    _, mean, share_of_long = counts(text)
    assert mean <= MOST_MEAN
    assert share_of_long <= MOST_LONG, [each for each in sentences(text) if length(each) > LONG]
    assert habits(text) == []


@pytest.mark.parametrize("name", commands.list_commands(click.Context(commands)))
def test_the_help_of_a_command_is_in_plain_english(name: str) -> None:
    command = commands.get_command(click.Context(commands), name)
    assert command is not None
    texts = [command.help, *(getattr(option, "help", None) for option in command.params)]
    assert [each for text in texts for each in habits_of_words(" ".join((text or "").split()))] == []


def test_the_manual_keeps_its_size() -> None:
    words = sum(counts(text_of(page))[0] for page in PAGES)
    assert len(PAGES) - 1 <= MOST_PAGES and words <= MOST_WORDS, (len(PAGES) - 1, words)


if __name__ == "__main__":
    for each in PAGES + MORE:
        words, mean, long = counts(text_of(each))
        print(f"{words:6} words {mean:5.1f} a sentence {long:6.1%} long  {each.relative_to(SOURCE)}")
    print(f"{sum(counts(text_of(page))[0] for page in PAGES):6} words on {len(PAGES)} pages")
