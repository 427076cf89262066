"""The version of the package is that of the project, which stands in its CMakeLists.txt; the rest: pyproject.toml."""

import re
from pathlib import Path

from setuptools import setup

text = Path(__file__).resolve().parents[1].joinpath("CMakeLists.txt").read_text(encoding="utf-8")
setup(version=re.search(r"^project\(laconic VERSION ([\d.]+)", text, re.MULTILINE)[1])
