"""The manual: Markdown pages and docstrings, built by Sphinx without a network. `make docs` builds it."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE / "extensions"), str(HERE.parent)]

project = "demheat"
author = "the authors of demheat"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "mathml", "outside"]
exclude_patterns = ["extensions"]

# Equations are MathML, which browsers draw themselves: no script is fetched, no LaTeX is needed.
html_math_renderer = "mathml"
math_eqref_format = "({number})"
html_theme = "alabaster"
html_theme_options = {"description": "Heat conduction in heterogeneous solids", "page_width": "1100px"}
html_show_sourcelink = False
html_copy_source = False

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3

autodoc_member_order = "bysource"
# Types stand in the docstrings, with shapes and units.
autodoc_typehints = "none"
napoleon_google_docstring = False
napoleon_use_rtype = False
