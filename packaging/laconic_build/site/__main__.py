"""`python -m laconic_build.site SOURCE OUT`: stages the pages in OUT/pages and lets Sphinx make OUT/html of them."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

from laconic_build.site.pages import stage

CONFIG = Path(__file__).resolve().parents[2] / "site"  # Sphinx's conf.py, styles and scripts


def main() -> int:
    """0, or Sphinx's exit status; a warning of Sphinx is an error."""
    source, out = (Path(argument).resolve() for argument in sys.argv[1:3])
    pages, html = out / "pages", out / "html"
    shutil.rmtree(out, ignore_errors=True)
    stage(source, pages)
    from sphinx.cmd.build import main as sphinx

    os.environ.setdefault("SOURCE_DATE_EPOCH", "0")  # no dates in the pages
    status = sphinx(["-q", "-W", "--keep-going", "-b", "html", "-c", str(CONFIG),
                     "-d", str(out / "cache"), str(pages), str(html)])
    return int(status)


if __name__ == "__main__":
    sys.exit(main())
