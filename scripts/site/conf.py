"""Configuration of Sphinx: nothing of the built site comes from elsewhere."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

from docutils import nodes

sys.path.insert(0, str(Path(__file__).parent))

from gearmesh import __version__

project = "gearmesh"
release = version = __version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "mathml"]

# ---- pages
source_suffix = {".md": "markdown"}
myst_enable_extensions = ["dollarmath", "amsmath", "html_image", "deflist", "colon_fence"]
myst_heading_anchors = 4
myst_dmath_double_inline = False
suppress_warnings = ["myst.header", "misc.highlighting_failure"]
highlight_language = "none"
# `x` in docstrings is code, as in Markdown
default_role = "code"
# two hyphens are those of an option
smartquotes = False

# ---- docstrings
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
autodoc_class_signature = "mixed"
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 90
add_module_names = False

# ---- HTML
html_theme = "furo"
html_title = f"gearmesh {version}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_math_renderer = "mathml"
html_show_copyright = False
html_show_sphinx = False
html_show_sourcelink = False
html_copy_source = False
# summaries of search results are fetched from pages, which files must not do
html_show_search_summary = False
html_use_index = True
html_theme_options = {"navigation_with_keys": False}

#: an array as signatures have it, `~` before what is shown by its last name
ARRAY = re.compile(r"~?numpy\.ndarray\[~?tuple\[~?typing\.Any, \.\.\.\], ~?numpy\.dtype\[~?[\w.]+\]\]")


def setup(app: Any) -> None:
    # before napoleon, which takes the words before a colon for the type of a property
    app.connect("autodoc-process-docstring", plain_first_line, priority=400)
    app.connect("autodoc-process-signature", plain_signature)
    app.connect("doctree-read", full_pictures)


def full_pictures(app: Any, doctree: nodes.document) -> None:
    """Give pictures without a width their own size: Sphinx links pictures that have a size to their file."""
    for picture in doctree.findall(nodes.image):
        if not {"width", "height", "scale"} & set(picture.attributes):
            picture["scale"] = 100


def plain_first_line(app: Any, what: str, name: str, value: object, options: object, lines: list[str]) -> None:
    """Put a blank that is not shown before the text of a property."""
    if what in ("property", "attribute") and lines:
        lines.insert(0, "\\ ")


def plain_signature(
    app: Any, what: str, name: str, value: object, options: object, signature: str | None, returned: str | None
) -> tuple[str | None, str | None]:
    """Arrays by their short name, as shapes stand in the sections; protocols, of which nobody makes one, without arguments."""
    if getattr(value, "_is_protocol", False):
        return "", returned
    first, second = (None if text is None else ARRAY.sub("~numpy.ndarray", text) for text in (signature, returned))
    return first, second
