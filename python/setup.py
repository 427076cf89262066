"""The version of the package is that of the project, which stands in laconic.h; the rest: pyproject.toml."""

import re
from pathlib import Path

from setuptools import setup

text = Path(__file__).resolve().parents[1].joinpath("core_c/include/laconic/laconic.h").read_text(encoding="utf-8")
setup(version=re.search(r'^#define LACONIC_VERSION "([\d.]+)"', text, re.MULTILINE)[1])
