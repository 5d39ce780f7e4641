"""Public names say what they take, give and refuse, each under its heading, and show it in an example that runs."""

from __future__ import annotations

import doctest
import inspect
import re
from collections.abc import Callable, Iterator
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.places import SAMPLES
from oracles.scripts import script

import gearmesh as gm

reference = script("site/reference")


def public() -> Iterator[tuple[str, Callable[..., Any]]]:
    """Public functions, and the methods that the reference shows, each where it is defined."""
    seen = set()
    for name in gm.__all__:
        value = getattr(gm, name)
        if not inspect.isclass(value):
            yield name, value
            continue
        for member in reference.own_members(value):
            if isinstance(inspect.getattr_static(value, member), property | cached_property):
                continue
            method = getattr(value, member)
            if method.__qualname__ not in seen:
                seen.add(method.__qualname__)
                yield f"{name}.{member}", method


PUBLIC = dict(public())


def arguments(function: Callable[..., Any]) -> list[str]:
    return [name for name in inspect.signature(function).parameters if name not in ("self", "cls")]


#: those without arguments say in a sentence what they give
WITH_ARGUMENTS = [name for name, function in PUBLIC.items() if arguments(function)]


def sections(function: Callable[..., Any]) -> dict[str, str]:
    """Texts of a docstring by their headings; what is before the first one under ""."""
    parts = re.split(r"^(\w+)\n-+$", inspect.getdoc(function) or "", flags=re.MULTILINE)
    return {"": parts[0]} | dict(zip(parts[1::2], parts[2::2], strict=True))


@pytest.mark.quick
@pytest.mark.parametrize("name", WITH_ARGUMENTS)
def test_arguments_results_and_examples_have_their_headings(name: str) -> None:
    function = PUBLIC[name]
    known = sections(function)
    wanted = ["", "Parameters", "Returns", "Raises", "Examples"]
    assert [heading for heading in wanted if heading in known] == list(known)
    assert {"Parameters", "Examples"} <= set(known)
    assert "Returns" in known or inspect.signature(function).return_annotation in ("None", "NoReturn")
    named = re.findall(r"^(\w+(?:, \w+)*)(?: :.*)?$", known["Parameters"], re.MULTILINE)
    assert [one for names in named for one in names.split(", ")] == arguments(function)
    assert "Raises" not in known[""]


@pytest.mark.quick
@pytest.mark.parametrize("name", [name for name in gm.__all__ if inspect.isclass(getattr(gm, name))])
def test_classes_and_what_they_have_are_described(name: str) -> None:
    value = getattr(gm, name)
    assert len((value.__doc__ or "").split()) > 2
    for member in reference.own_members(value):
        assert len((inspect.getdoc(getattr(value, member)) or "").split()) > 1, member


@pytest.mark.quick
def test_what_a_docstring_lacks_is_found() -> None:
    def undocumented(ratio: float) -> float:
        """Twice as much. Raises nothing.

        Parameters
        ----------
        factor
            Another.
        """
        return 2.0 * ratio

    PUBLIC["undocumented"] = undocumented
    try:
        with pytest.raises(AssertionError):
            test_arguments_results_and_examples_have_their_headings("undocumented")
    finally:
        del PUBLIC["undocumented"]


@pytest.fixture(scope="module")
def spur() -> gm.Gears:
    return gm.build(gm.load(SAMPLES / "spur.toml"))


@pytest.mark.sweep
@pytest.mark.parametrize("name", WITH_ARGUMENTS)
def test_examples_run(name: str, spur: gm.Gears, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a folder with the samples, `gears` being a spur pair; what an example says that it gives, it gives."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "samples").symlink_to(SAMPLES)
    build123d = pytest.importorskip("build123d") if "build123d" in str(sections(PUBLIC[name])) else None
    names = {"gm": gm, "np": np, "gears": spur, "Path": Path, "build123d": build123d}
    for example in doctest.DocTestParser().get_examples(inspect.getdoc(PUBLIC[name]) or ""):
        if doctest.SKIP in example.options:
            continue
        if "cadquery" in example.source:
            pytest.importorskip("cadquery")
        try:
            code, evaluated = compile(example.source, name, "eval"), True
        except SyntaxError:
            code, evaluated = compile(example.source, name, "exec"), False
        value = eval(code, names) if evaluated else exec(code, names)
        assert not example.want or repr(value) == example.want.strip()
