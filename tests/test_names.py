"""Docstrings open with a verb or a noun; constants say which quantity they hold."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "gearmesh"
#: constants of one word that is the whole name of what they hold
WHOLE_NAMES = {"ARCSEC", "STEEL", "_RELATIONSHIPS"}
#: openings that fit no verb and no noun
NO_NOUN_NO_VERB = re.compile(r"(What|Of|Whether|How|Where|Which|As|By)\b")
CONSTANT = re.compile(r"_?[A-Z][A-Z0-9_]+")


def docstrings(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Yield line and text of the docstrings of a module, its classes and its functions."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and (text := ast.get_docstring(node)):
            yield getattr(node, "lineno", 1), text


def constants(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Yield line and name of the constants of a module."""
    for node in tree.body:
        targets = (
            node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
        )
        for target in targets:
            for name in ast.walk(target):
                if isinstance(name, ast.Name) and CONSTANT.fullmatch(name.id):
                    yield node.lineno, name.id


def faults_of(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Yield line and text of each docstring and constant that breaks a rule."""
    for line, text in docstrings(tree):
        if NO_NOUN_NO_VERB.match(text):
            yield line, f"{text.splitlines()[0]!r}: a docstring opens with a verb or a noun"
    for line, name in constants(tree):
        if "_" not in name.strip("_") and name not in WHOLE_NAMES:
            yield line, f"{name}: a constant names its quantity and its place, as MAX_NEWTON_STEPS"


def trees() -> Iterator[tuple[str, ast.Module]]:
    """Yield path and syntax tree of each module of the package."""
    for file in sorted(PACKAGE.rglob("*.py")):
        yield str(file.relative_to(PACKAGE)), ast.parse(file.read_text(encoding="utf-8"))


@pytest.mark.quick
def test_docstrings_open_with_a_verb_or_noun_and_constants_name_a_quantity() -> None:
    faults = [f"{file}:{line}: {text}" for file, tree in trees() for line, text in faults_of(tree)]
    assert faults == []


@pytest.mark.quick
@pytest.mark.parametrize(
    ("source", "count"),
    [
        ('"""What a gear is."""\nENOUGH = 3', 2),
        ('def f():\n    """Of teeth (N,): stresses."""', 1),
        ('"""Whole gears."""\nMAX_NEWTON_STEPS, MOST = 3, 4', 1),
        ('"""Asymmetric teeth."""\nT = TypeVar("T")\nARCSEC: float = 1.0', 0),
    ],
)
def test_rules_of_names_find_what_they_should(source: str, count: int) -> None:
    assert len(list(faults_of(ast.parse(source)))) == count
