"""What the package's files say, taken apart once for all tests that look."""

from __future__ import annotations

import ast
from functools import cache


@cache
def parsed(text: str) -> ast.Module:
    """The syntax tree of a source text."""
    return ast.parse(text)


@cache
def nodes(text: str) -> tuple[ast.AST, ...]:
    """All nodes of it, as `ast.walk` has them."""
    return tuple(ast.walk(parsed(text)))
