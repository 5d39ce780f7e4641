"""Equations as MathML, written when the site is built: browsers set it without scripts. Their letters come with the site.

MathML is set well only in a font that has a table of what mathematics needs, and not every machine has one: the site carries a
part of STIX Two Math (SIL Open Font License), taken from the package ziamath.
"""

from __future__ import annotations

import logging
import re
from importlib.resources import files
from io import BytesIO
from pathlib import Path
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert

#: characters of the font: Latin, Greek, punctuation, arrows and operators, and italic and bold letters
CHARACTERS = ((0x20, 0x17F), (0x2B0, 0x36F), (0x370, 0x3FF), (0x2010, 0x2069), (0x2100, 0x22FF), (0x2308, 0x23FF),
              (0x27E8, 0x27EF), (0x1D400, 0x1D4CF), (0x1D6A4, 0x1D755))  # fmt: skip
FONT = "stix_two_math.woff"
#: where bold capitals and small letters begin, Latin and Greek
BOLD = (("A", "Z", 0x1D400), ("a", "z", 0x1D41A), ("Α", "Ω", 0x1D6A8), ("α", "ω", 0x1D6C2))  # noqa: RUF001


def mathml(tex: str, display: str) -> str:
    """An equation; bold letters by their own characters, since browsers know no other variant than normal."""
    made: str = convert(tex, display=display)
    return re.sub(r'<mi mathvariant="bold(?:-italic)?">(&#x[0-9A-F]+;|.)</mi>', _bold, made)


def _bold(letter: re.Match[str]) -> str:
    character = chr(int(letter[1][3:-1], 16)) if letter[1].startswith("&#x") else letter[1]
    for first, last, start in BOLD:
        if first <= character <= last:
            return f"<mi>{chr(start + ord(character) - ord(first))}</mi>"
    return letter[0]


def inline(translator: Any, node: nodes.Node) -> None:
    """An equation within a line."""
    translator.body.append(mathml(node.astext(), "inline"))
    raise nodes.SkipNode


def display(translator: Any, node: nodes.Node) -> None:
    """An equation of its own, which may be wider than a phone and is moved sideways then."""
    translator.body.append(f'<div class="equation">{mathml(node.astext(), "block")}</div>\n')
    raise nodes.SkipNode


def write_font(app: Any, failure: Exception | None) -> None:
    """The font of equations, less what they never have, beside the style sheets."""
    from fontTools.subset import Options, Subsetter
    from fontTools.ttLib import TTFont

    if failure is not None or app.builder.format != "html":
        return
    # each table that is left out is an entry in the log
    logging.getLogger("fontTools").setLevel(logging.WARNING)
    whole = TTFont(BytesIO(files("ziamath").joinpath("fonts/STIXTwoMath-Regular.ttf").read_bytes()))
    wanted = Subsetter(Options(layout_features=["ssty"], notdef_outline=True))
    wanted.populate(unicodes=[code for first, last in CHARACTERS for code in range(first, last + 1)])
    wanted.subset(whole)
    whole.flavor = "woff"
    whole.save(Path(app.outdir) / "_static" / FONT)


def setup(app: Any) -> dict[str, bool]:
    app.add_html_math_renderer("mathml", (inline, None), (display, None))
    app.connect("build-finished", write_font)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
