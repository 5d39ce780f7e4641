"""Sources of the package, parsed once for all tests that read them.

The syntax trees of all files take 4 s: a test that looks for a word reads the text first.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache

#: import statements and names of classes, as the formatter writes them
IMPORTS = re.compile(r"^[ \t]*((?:from[ \t]+[.\w]+[ \t]+)?import[ \t]+(?:\([^)]*\)|[^\n(]*))", re.MULTILINE)
CLASSES = re.compile(r"^[ \t]*class (\w+)", re.MULTILINE)


@cache
def parsed(text: str) -> ast.Module:
    """The syntax tree of a source text."""
    return ast.parse(text)


@cache
def nodes(text: str) -> tuple[ast.AST, ...]:
    """All nodes of it, as `ast.walk` has them."""
    return tuple(ast.walk(parsed(text)))


def imports(text: str) -> Iterator[ast.Import | ast.ImportFrom]:
    """Its imports, wherever they stand, and those of programs that it writes."""
    for found in IMPORTS.finditer(text):
        try:
            (statement,) = ast.parse(found[1]).body
        except SyntaxError:
            continue  # words of a docstring
        assert isinstance(statement, ast.Import | ast.ImportFrom)
        yield statement
