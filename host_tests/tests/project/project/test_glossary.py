"""docs/glossary.md explains every symbol that pages and headers use, each word once, and names what the code has."""

from __future__ import annotations

import re

import pytest

from laconic.base.paths import SOURCE_DIR

GLOSSARY = (SOURCE_DIR / "docs" / "glossary.md").read_text(encoding="utf-8")
HEADERS = "\n".join(path.read_text(encoding="utf-8") for path in (SOURCE_DIR / "core_c/include/laconic").glob("*.h"))
PAGES = [SOURCE_DIR / "README.md", *(SOURCE_DIR / "docs").glob("*.md"), SOURCE_DIR / "core_c/include/laconic/laconic.h"]
LETTER = re.compile(r"[Α-Ωα-ω]")
NO_SYMBOLS = {"Σ", "π", "Ω"}  # the sum, the number and the ohm


def first_cells(part: str) -> list[str]:
    """The first cell of each row of the tables under a heading, the heads of the tables left out."""
    rows = re.findall(r"^\| (.*?) \|", GLOSSARY.split(f"\n## {part}\n")[1].split("\n## ")[0], re.MULTILINE)
    return [row for row in rows if row not in ("---", "symbol", "word")]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_greek_letter_of_a_page_is_a_symbol_of_the_glossary(page):
    explained = set(LETTER.findall("".join(first_cells("Symbols")))) | NO_SYMBOLS
    assert set(LETTER.findall(page.read_text(encoding="utf-8"))) - explained == set()


def test_the_names_in_code_that_the_glossary_gives_are_in_the_headers():
    named = re.findall(r"`([\w.\[\]]+)`", GLOSSARY)
    names = {re.sub(r"\[i\]", "", name).split(".")[0] for name in named if name.isidentifier() or "[i]" in name}
    assert len(names) > 30
    assert [name for name in sorted(names) if "_" in name and not re.search(rf"\b{name}\b", HEADERS)] == []


def test_every_word_and_every_symbol_has_one_row():
    for part in ("Symbols", "Words"):
        words = [word.strip(" *") for cell in first_cells(part) for word in cell.split(",")]
        assert len(words) > 30
        assert sorted(words) == sorted(set(words))


def test_every_page_with_words_of_the_project_leads_to_the_glossary():
    for name in ("fmu", "scenes", "paper", "rig", "wire", "architecture", "integrators", "python"):
        assert "(glossary.md)" in (SOURCE_DIR / "docs" / f"{name}.md").read_text(encoding="utf-8"), name
