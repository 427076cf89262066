"""The page's program in C compiles against the core as it is shipped, and prints what the page says."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from laconic.base.paths import SOURCE_DIR, built

PAGE = (SOURCE_DIR / "docs/control.md").read_text(encoding="utf-8")


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_the_page_s_program_compiles_and_prints_what_the_page_says(tmp_path: Path) -> None:
    _, _, rest = PAGE.partition("```c\n")
    program, _, rest = rest.partition("```\n")
    shown = rest.partition("```text\n")[2].partition("```")[0]
    (tmp_path / "program.c").write_text(program, encoding="utf-8")
    subprocess.run(["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", f"-I{SOURCE_DIR / 'core_c/include'}", "program.c",
                    str(built("core_c/liblaconic.a")), "-o", "program"], cwd=tmp_path, check=True)
    printed = subprocess.run(["./program"], cwd=tmp_path, check=True, capture_output=True, text=True).stdout
    assert printed == shown
