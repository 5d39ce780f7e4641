"""Docstrings of public functions: sections by numpydoc, and examples that run."""

from __future__ import annotations

import doctest
import inspect
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.places import ROOT

import gearmesh as gm
from gearmesh.figures import Figures
from gearmesh.systems.system import kinds
from gearmesh.view.opengl import missing_opengl_message

#: parameters that are no argument of a user
OWN = {"self", "cls"}
SECTIONS = ("Parameters", "Returns", "Raises", "Examples")


def functions() -> Iterator[tuple[str, Any]]:
    """All functions of the public names, and methods of public classes, each once, by the class that has it."""
    known = set()
    for name in gm.__all__:
        # once gearmesh.kinds is imported, that module stands in the place of the function
        thing = kinds if name == "kinds" else getattr(gm, name)
        if not inspect.isclass(thing):
            yield name, thing
            continue
        for owner in thing.__mro__:
            for key, value in vars(owner).items() if owner.__module__.startswith("gearmesh") else ():
                method = value.__func__ if isinstance(value, classmethod | staticmethod) else value
                ours = inspect.isfunction(method) and method.__module__.startswith("gearmesh")
                ours = ours and not (key == "of" and issubclass(owner, Figures))
                # a method that says nothing of its own has the docstring of the one that it overrides
                if ours and not key.startswith("_") and method.__doc__ and method not in known:
                    known.add(method)
                    yield f"{owner.__name__}.{key}", method


FUNCTIONS = dict(functions())


def sections(text: str) -> dict[str, str]:
    """Sections of a docstring by their titles; what stands before them under ""."""
    found, title = {"": ""}, ""
    lines = text.splitlines()
    for k, line in enumerate(lines):
        if line in SECTIONS and lines[k + 1 : k + 2] == ["-" * len(line)]:
            title = line
            found[title] = ""
        elif not (k and lines[k - 1] == title and set(line) == {"-"}):
            found[title] += line + "\n"
    return found


def faults(name: str, function: Any) -> list[str]:
    """Return the faults of the docstring of a function."""
    text, wrong = sections(inspect.getdoc(function) or ""), []
    if not text[""].split("\n\n")[0].strip().endswith((".", ":")):
        wrong.append(f"{name}: its first paragraph says in sentences what it is for")
    signature = inspect.signature(function)
    listed = {
        one.strip()
        for line in text.get("Parameters", "").splitlines()
        if line and not line.startswith(" ")
        for one in line.partition(" : ")[0].split(",")
    }
    lacking = set(signature.parameters) - OWN - listed
    wrong += [f"{name}: Parameters has no {one}" for one in sorted(lacking)]
    wrong += [f"{name}: Parameters has {one}, which is none" for one in sorted(listed - set(signature.parameters))]
    gives = signature.return_annotation not in ("None", "NoReturn", None)
    if gives != ("Returns" in text):
        wrong.append(f"{name}: Returns {'is missing' if gives else 'of nothing'}")
    if "Raises " in text[""]:
        wrong.append(f"{name}: what it raises stands under Raises")
    if ">>>" not in text.get("Examples", ""):
        wrong.append(f"{name}: no example")
    return wrong


@pytest.mark.quick
def test_every_public_function_says_what_it_takes_gives_and_raises() -> None:
    assert len(FUNCTIONS) > 170
    wrong = [line for name, function in FUNCTIONS.items() for line in faults(name, function)]
    assert wrong == [], "\n".join(wrong)


@pytest.mark.quick
def test_lacking_sections_are_seen() -> None:
    def area(width: float, height: float) -> float:
        """Area of a rectangle. Raises ValueError.

        Parameters
        ----------
        width, depth : float
            mm.
        """
        return width * height

    assert faults("area", area) == [
        "area: Parameters has no height",
        "area: Parameters has depth, which is none",
        "area: Returns is missing",
        "area: what it raises stands under Raises",
        "area: no example",
    ]


def once(answer: Callable[..., Any]) -> Callable[..., Any]:
    """The same function, which is asked once for the same arguments: examples ask for the same answers."""
    known: dict[str, Any] = {}

    def again(*asked: Any, **named: Any) -> Any:
        key = repr((asked, named))
        if key not in known:
            known[key] = answer(*asked, **named)
        return known[key]

    return again


@pytest.fixture(scope="module")
def small() -> Iterator[dict[str, Any]]:
    """Return the names that examples use: a small spur pair, whose contact is solved once, and trains that are read once."""
    tables = {"pinion": {"teeth": 18, "face_width": 10}, "gear": {"teeth": 24, "face_width": 10}}
    design = gm.parse({"kind": "cylindrical", "module": 2, **tables})
    with pytest.MonkeyPatch.context() as patch:
        gears = gm.build(design)
        for owner, name in ((gears, "contact"), (gears, "loaded_contact"), (gm, "load_train")):
            patch.setattr(owner, name, once(getattr(owner, name)))
        yield {"gm": gm, "np": np, "json": json, "design": design, "gears": gears}


#: examples that do not run here, by whose they are, and why
LEFT_OUT = {
    "Cad.to_cadquery": "CadQuery needs OpenCASCADE 7, everything else here 8",
    "Gears.to_cadquery": "CadQuery needs OpenCASCADE 7, everything else here 8",
    "Solid.to_cadquery": "CadQuery needs OpenCASCADE 7, everything else here 8",
    "Explorer.wait": "it waits for Ctrl-C",
    "FiniteElements.solve": "CalculiX takes a minute; tests/fe runs it",
    "FiniteElementSolution.save": "CalculiX takes a minute; tests/fe runs it",
    "FiniteElementModel.with_frequencies": "CalculiX takes a minute; tests/fe runs it",
}
#: examples that need OpenGL
DRAWN = ("Gears.animation", "Gears.report", "Gears.run")
#: examples that take more than a second or two
SLOW = (
    *DRAWN,
    *("Gears.loaded_contact", "Correction.topography", "LoadedContact.share_at", "LoadedContact.csv"),
    *("Gears.to_build123d", "Cad.to_build123d", "Solid.to_build123d", "ToolPathAnswer.to_dict", "Gears.save_pictures"),
    *("Gears.check", "Gears.correct", "Gears.largest_errors", "Gears.toolpath", "SolvedGears.check_solved"),
    *(
        "MultistageTrain.cad",
        "MultistageTrain.page",
        "MultistageTrain.scene",
        "MultistageTrain.solids",
        "TrainError.csv",
    ),
    *("CompositeTest.csv", "Gears.composite", "Gears.composite_chart", "Gears.cad", "Gears.picture"),
    *(
        "Gears.finite_elements",
        "Gears.finite_element_decks",
        "FiniteElementModel.save",
        "FiniteElementModel.to_pyvista",
    ),
)
#: which base of Gears has a method is nothing that a list says
EXAMPLES = [pytest.param(name, marks=pytest.mark.sweep if name.endswith(SLOW) else ()) for name in FUNCTIONS]


@pytest.mark.quick
def test_examples_that_do_not_run_are_few_and_have_a_reason() -> None:
    skipped = {name for name, function in FUNCTIONS.items() if "+SKIP" in (function.__doc__ or "")}
    assert len(skipped) == len(LEFT_OUT)
    assert all(name.endswith(tuple(LEFT_OUT)) for name in skipped)
    assert [one for one in SLOW if not any(name.endswith(one) for name in FUNCTIONS)] == []


@pytest.mark.parametrize("name", EXAMPLES)
@pytest.mark.sweep_cases(
    "Cad.face_names",
    "Compensation.apply",
    "Gears.compare",
    "Gears.compensate",
    "Gears.drawing",
    "Gears.roll",
    "Gears.optimize",
    "Gears.study",
    "Gears.theoretical_chart",
    "Gears.with_deviations",
    "ModelledGears.section",
    "Optimum.csv",
    "Optimum.design_text",
    "Optimum.save_all",
    "PlanetarySizing.first_sets",
    "Result.json",
    "RollTest.patches",
    "Saved.save",
    "Study.assemblies",
    "Study.csv",
    "Study.numbers",
    "StudySummary.read",
    "Summary.entry",
    "size_planetary",
    "Explorer.close",
    "Explorer.stop",
    "Gears.vh",
    "MultistageTrain.picture",
    "MultistageTrain.study",
)
def test_examples_run(
    name: str,
    small: dict[str, Any],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """In a folder with the samples; what an example prints is what it says."""
    if name.endswith(DRAWN) and (missing := missing_opengl_message()):
        pytest.skip(missing)
    (tmp_path / "samples").symlink_to(ROOT / "samples")
    monkeypatch.chdir(tmp_path)
    text = inspect.getdoc(FUNCTIONS[name]) or ""
    case = doctest.DocTestParser().get_doctest(text, {**small}, name, None, None)
    results = doctest.DocTestRunner(verbose=False, optionflags=doctest.ELLIPSIS).run(case)
    assert not results.failed, capsys.readouterr().out
