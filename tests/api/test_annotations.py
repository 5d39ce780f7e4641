"""What a user gets back can be annotated: types of fields, properties and return values of public names are public."""

from __future__ import annotations

import ast
import importlib
import inspect
import sys
import typing
from collections.abc import Iterator
from functools import cache, cached_property
from typing import Any

import pytest
from oracles.sources import nodes

import gearmesh as gm

#: what aliases that are texts may name wherever they are read
PUBLIC = {name: getattr(gm, name) for name in gm.__all__}
#: of which names are looked for in modules, but which may not be installed
OTHERS = ("build123d", "cadquery", "pyvista", "trimesh", "manifold3d")


#: Classes without public names, and why they have none. How a gear is inspected or read from other files, and what a tool says of
#: itself (InspectionBasis, StageForm, ToolDescription), is what systems are made of: who adds one imports them from their modules
#: (samples/guides/11-own-gear-system.md), and they may change in any version. What the contact solver goes on working with
#: (MeshCurve, Pair) has its figures in the answers that hold it, and what it gives back, rotation by rotation, `Engagement`; public
#: names for both would take eight more for what they consist of. How a solid is kept until its `mesh` is asked for (Facets,
#: ToothMesh) saves memory and a second meshing, and says nothing that `mesh` does not.
WORKING = {"Facets", "InspectionBasis", "MeshCurve", "Pair", "StageForm", "ToolDescription", "ToothMesh"}


class Absent:
    """Stands in for a module, and for all that is in it, that is not looked into."""

    def __getattr__(self, name: str) -> Any:
        return Any


@cache
def names_in(module: str) -> dict[str, Any]:
    """What annotations in a module may name: what it has, and what it imports for types alone."""
    source = inspect.getsource(sys.modules[module])
    known = {**{name: Absent() for name in OTHERS}, **PUBLIC, **vars(typing), **vars(sys.modules[module])}
    for node in nodes(source):
        if isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                value = getattr(importlib.import_module(node.module), alias.name, Absent())
                known.setdefault(alias.asname or alias.name, value)
    return known


def types_of(hint: Any, module: str, within: tuple[Any, ...] = ()) -> Iterator[type]:
    """All classes in an annotation, however deep; of one that names itself, as that of JSON, those that it names beside."""
    if isinstance(hint, typing.ForwardRef):
        hint = hint.__forward_arg__
    if isinstance(hint, str):
        if hint not in within:
            # an alias that is a text, with `| None`
            value = eval(hint.replace("FirstOrder | None", "Any"), names_in(module))
            yield from types_of(value, module, (*within, hint))
    elif isinstance(hint, typing.TypeVar):
        yield from types_of(hint.__bound__, module, within)
    elif inspect.isclass(hint) and not typing.get_args(hint):
        yield hint
    elif typing.get_origin(hint) is not typing.Literal:
        for part in typing.get_args(hint):
            for one in part if isinstance(part, list) else [part]:
                yield from types_of(one, module, within)


def given(name: str) -> Iterator[tuple[str, Any, str]]:
    """Fields, properties and what is returned, of a public name: where it is, its annotation, the module that this is read in."""
    thing = getattr(gm, name)
    if not inspect.isclass(thing):
        yield name, thing.__annotations__.get("return"), thing.__module__
        return
    for owner in (owner for owner in thing.__mro__ if owner.__module__.startswith("gearmesh.")):
        for key, hint in list(vars(owner).get("__annotations__", {}).items()):
            yield f"{name}.{key}", hint, owner.__module__
        for key, member in list(vars(owner).items()):
            plain = inspect.unwrap(getattr(member, "__func__", member))
            if isinstance(member, property):
                plain = member.fget
            elif isinstance(member, cached_property):
                plain = member.func
            if inspect.isfunction(plain) and plain.__module__.startswith("gearmesh"):
                yield f"{name}.{key}", plain.__annotations__.get("return"), plain.__module__


def not_public(names: list[str]) -> dict[str, str]:
    """Classes of the package that public names give back without being public themselves, and one place of each."""
    public = {getattr(gm, name) for name in gm.__all__}
    found = {}
    for name in names:
        for place, hint, module in given(name):
            if place.rpartition(".")[2].startswith("_"):
                continue
            for kind in types_of(hint, module):
                if kind.__module__.startswith("gearmesh") and kind not in public:
                    found[kind.__name__] = place
    return found


@pytest.mark.quick
def test_types_of_all_that_is_given_back_are_public() -> None:
    assert set(not_public(gm.__all__)) == WORKING


@pytest.mark.quick
def test_types_that_are_not_public_are_seen_in_fields_properties_and_methods(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        gm, "__all__", [name for name in gm.__all__ if name not in ("Fit", "GearTrain", "Tooth", "Mount")]
    )
    assert {"Fit", "GearTrain", "Tooth", "Mount"} <= set(not_public(gm.__all__))
