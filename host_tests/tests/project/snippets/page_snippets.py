"""The snippets of the pages: what each is, and what the page says of how it is run.

A comment in the page's source above a snippet says why it is not run, or how; with `all` in front, at the head of a
page, it says so of all its snippets:
    <!-- not run: REASON -->           counted by the test
    <!-- run by: TEST_FILE -->         that test takes the snippet from the page
    <!-- shortened: THIS → THAT -->    it is run with THAT instead; {source} is the project's folder
    <!-- beside: PORT -->              the first command keeps running, on a free port, beside what follows on the page
    <!-- scene: NAME -->               tables of a scene, which are read as part of this one
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from markdown_it import MarkdownIt

from laconic.base.paths import SOURCE_DIR

KINDS = ("not run", "run by", "shortened", "beside", "scene")
MARK = re.compile(rf"<!-- (all )?({'|'.join(KINDS)}): (.+?) -->", re.DOTALL)
SHELL = ("sh", "console", "")  # "": an indented block
SHOWN = ("text", "json")       # output, a formula, a form: nothing that runs
PAGES = [SOURCE_DIR / "README.md", SOURCE_DIR / "CONTRIBUTING.md", SOURCE_DIR / "web/npm/README.md",
         SOURCE_DIR / "packaging/site/README.md", *sorted((SOURCE_DIR / "docs").glob("*.md"))]


@dataclass(frozen=True)
class Snippet:
    """One block of code of a page, from a line on, with the marks above it."""

    page: Path
    line: int
    language: str
    text: str
    marks: tuple[tuple[str, str], ...]

    @property
    def where(self) -> str:
        """Page and line, for messages."""
        return f"{self.page.relative_to(SOURCE_DIR)}:{self.line}"

    def marked(self, kind: str) -> list[str]:
        """What the marks of one kind say."""
        return [text for name, text in self.marks if name == kind]

    @property
    def runs_here(self) -> bool:
        """Whether the test of all pages runs it."""
        return self.language not in SHOWN and not self.marked("not run") and not self.marked("run by")

    @property
    def shortened(self) -> str:
        """Its text as the marks shorten it."""
        text = self.text
        for change in self.marked("shortened"):
            this, that = (part.strip() for part in change.split("→"))
            assert this in text, f"{self.where}: there is no {this!r} to shorten"
            text = text.replace(this, that.replace("{source}", str(SOURCE_DIR)))
        return text

    def commands(self) -> list[str]:
        """The lines of a shell block, without comments, continued lines joined."""
        text = re.sub(r"\\\n\s*", " ", self.shortened)
        lines = (re.sub(r"(?:^|\s+)#.*$", "", line).strip().removeprefix("$ ") for line in text.splitlines())
        return [line for line in lines if line]


def snippets(page: Path) -> list[Snippet]:
    """All of a page, in order."""
    found: list[Snippet] = []
    whole: list[tuple[str, str]] = []
    marks: list[tuple[str, str]] = []
    for token in MarkdownIt("commonmark").enable("table").parse(page.read_text(encoding="utf-8")):
        if token.type == "html_block":
            for every, kind, text in MARK.findall(token.content):
                (whole if every else marks).append((kind, " ".join(text.split())))
        elif token.type in ("fence", "code_block"):
            language = (token.info.split() or ["text"])[0] if token.type == "fence" else ""
            assert token.map is not None
            found.append(Snippet(page, token.map[0] + 1, language, token.content, (*whole, *marks)))
            marks = []
        elif not token.type.endswith("_close"):
            marks = []
    return found


ALL = [snippet for page in PAGES for snippet in snippets(page)]
