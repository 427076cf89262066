"""Sphinx's configuration of the site."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HEADER = (ROOT / "core_c" / "include" / "laconic" / "laconic.h").read_text(encoding="utf-8")

project = "Laconic"
author = "the authors of Laconic"
release = re.search(r'#define LACONIC_VERSION "([^"]+)"', HEADER)[1]
extensions = ["myst_parser", "sphinx.ext.autodoc", "laconic_build.site.formulas"]
myst_enable_extensions = ["colon_fence", "dollarmath"]
html_math_renderer = "mathml"
myst_heading_anchors = 4
html_theme = "furo"
html_title = f"Laconic {release}"
html_static_path = [str(Path(__file__).parent / "static")]
html_css_files = ["site.css"]
html_js_files = ["copy.js"]
html_show_sphinx = False
html_copy_source = False
highlight_language = "none"  # indented blocks are command lines
autodoc_typehints = "description"
autodoc_member_order = "bysource"
nitpicky = False
