"""Names in the package: functions are verbs or nouns of the field, variables say which quantity they hold."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "gearmesh"
#: say nothing of what they hold
EMPTY = {"each", "found"}
IRREGULAR = {
    *(
        "bent",
        "bound",
        "broken",
        "built",
        "chosen",
        "drawn",
        "found",
        "given",
        "ground",
        "held",
        "hidden",
        "kept",
        "known",
    ),
    *(
        "laid",
        "left",
        "lost",
        "made",
        "meant",
        "met",
        "said",
        "seen",
        "shown",
        "sought",
        "spent",
        "stood",
        "taken",
        "told",
    ),
    *("written", "driven", "begun", "gone", "thought", "woven"),
}
NO_PARTICIPLES = {
    "bed",
    "bleed",
    "breed",
    "embed",
    "exceed",
    "feed",
    "need",
    "proceed",
    "seed",
    "shed",
    "speed",
    "succeed",
}
PARTICLES = {"alone", "as", "at", "by", "in", "into", "of", "off", "on", "out", "over", "to", "up"}
#: participles that name what they give all the same
ALLOWED = {
    "inverted": "an adjective for each of two axes, True or False",
    "known": "an adjective of a figure or value",
    "measured": "figures that were measured; `Solid` and `Cad` have them as fields",
    "_bound": "a noun: the bound of an interval",
}


def is_participle(name: str) -> bool:
    """Whether a name is a participle without its noun, as `solved`, `left_out`."""
    first, *rest = name.strip("_").split("_")
    regular = first.endswith("ed") and len(first) > 3 and first not in NO_PARTICIPLES
    return (regular or first in IRREGULAR) and all(word in PARTICLES for word in rest)


def says_whether(node: ast.FunctionDef) -> bool:
    """Whether a function returns True or False: an adjective names that."""
    return node.returns is not None and ast.unparse(node.returns) in ("bool", "NDArray[np.bool_]")


def bare_participles(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """(line, name) of functions that are called by a participle alone."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef) and is_participle(node.name) and not says_whether(node):
            yield node.lineno, node.name


def empty_names(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """(line, name) of variables, parameters, fields and functions whose names are EMPTY."""
    for node in ast.walk(tree):
        match node:
            case ast.Name(id=name, ctx=ast.Store()) | ast.arg(arg=name) | ast.FunctionDef(name=name):
                if name in EMPTY:
                    yield node.lineno, name


def trees() -> Iterator[tuple[str, ast.AST]]:
    for file in sorted(PACKAGE.rglob("*.py")):
        yield str(file.relative_to(PACKAGE)), ast.parse(file.read_text())


@pytest.mark.quick
def test_names_say_what_they_are() -> None:
    faults, used = [], set()
    for file, tree in trees():
        faults += [f"{file}:{line}: {name}: which quantity?" for line, name in empty_names(tree)]
        for line, name in bare_participles(tree):
            used.add(name)
            if name not in ALLOWED:
                faults.append(f"{file}:{line}: {name}: a verb, or a noun of the field")
    assert faults == []
    assert ALLOWED.keys() <= used


@pytest.mark.quick
@pytest.mark.parametrize(
    ("source", "names"),
    [
        ("def _solved(): ...", ["_solved"]),
        ("class A:\n    def left_out(self) -> int: ...", ["left_out"]),
        ("def solved_contact(): ...\ndef feed(): ...\ndef closed() -> bool: ...", []),
    ],
)
def test_participles(source: str, names: list[str]) -> None:
    assert [name for _, name in bare_participles(ast.parse(source))] == names


@pytest.mark.quick
@pytest.mark.parametrize(
    "source",
    [
        "[each for each in x]",
        "found = 1",
        "lambda each: each",
        "for found, k in x: ...",
        "def f(found): ...",
        "def each(): ...",
    ],
)
def test_empty_names(source: str) -> None:
    assert list(empty_names(ast.parse(source)))
