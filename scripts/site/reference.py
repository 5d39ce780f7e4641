"""The reference, written from what the program itself knows: public names, keys of every kind, figures, commands."""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import typer
from pydantic import BaseModel

import gearmesh as gm
from gearmesh.answers.tables import json_text
from gearmesh.api.design_schema import design_schema
from gearmesh.api.reference import figure_groups
from gearmesh.api.report_schema import report_schema
from gearmesh.app import cli
from gearmesh.deprecated import Deprecated
from gearmesh.design.core import Design
from gearmesh.design.keys import Table
from gearmesh.figures import Figures
from gearmesh.formats import FILE_FORMATS, FORMAT_COLUMNS, format_row

#: pages of public names: file, title, what is on it, and its names; kinds of design have a page of their keys instead
PYTHON = (
    (
        "building",
        "Designs and gears",
        "From a file to gears.",
        ("load", "parse", "new", "toml", "build", "gear", "Design"),
    ),
    ("gears", "Gears", "The object from which every question is asked.", ("Gears",)),
    ("sizing", "Sizing", "Gears for a ratio and a space.", ("size", "size_planetary", "Sizing", "PlanetarySizing")),
    ("results", "What every answer can do", "", ("Result", "Summary")),
    ("contact", "Tooth contact", "", ("Contact", "EaseOffMap", "VHCheck", "Limits", "Check", "RollTest")),
    ("load", "Contact under load", "", ("LoadedContact", "Tribology", "Dynamics", "FlexibleMount")),
    (
        "bodies",
        "Solids, sections, drawings, tool paths",
        "",
        ("Solid", "Solids", "Cad", "FaceNames", "Section", "WorkshopDrawing", "ToolPathAnswer"),
    ),
    (
        "finite_elements",
        "Finite elements",
        "",
        (
            "FiniteElements",
            "FiniteElementModel",
            "FiniteElementDecks",
            "FiniteElementSolution",
            "UnloadedFiniteElements",
        ),
    ),
    (
        "inspection",
        "Measured gears and corrections",
        "",
        ("MeasuringGrids", "FlankTopography", "Inspection", "CompositeTest", "Correction", "Compensation"),
    ),
    ("studies", "Studies and optimisation", "", ("Study", "StudySummary", "LargestErrors", "Optimum")),
    ("trains", "Trains of several stages", "", ("load_train", "MultistageTrain", "TrainError")),
    (
        "teeth",
        "Members and pairs",
        "What gears consist of. `gears.train` has the pairs, `gears.members` each member by its name.",
        ("GearTrain", "GearPair", "Member", "Rigid"),
    ),
    (
        "sheets",
        "Data sheets, pictures, reports, exchange",
        "",
        (
            "DesignSheet",
            "Pinned",
            "Picture",
            "Diagram",
            "Animation",
            "Report",
            "ReportPage",
            "Explorer",
            "load_rexs",
            "RexsReading",
            "RexsExport",
        ),
    ),
    ("errors", "Errors", "", ("GearmeshError", "DesignError", "OutputError", "NoSolutionError")),
    ("systems", "Gear systems of your own", "", ("kinds", "system", "register", "System", "prove", "KindProof")),
)


#: members of public classes that are of use to the program alone
INTERNAL = {
    "Gears": {"as_built", "check_solved", "part", "place", "within"},
    "GearmeshError": {"later", "topic", "subject", "rename"},
    "System": {"of_keys"},
    "FlexibleMount": {"wrenches", "displace"},
    "RollTest": {"patches"},
}
#: members of a design that people use; what else it has is how files are read
OF_DESIGNS = ("title", "kind_in_words", "resolve", "in_mm", "given_module", "mm_per_unit", "key_lines", "key_groups")


def write(source: Path) -> None:
    """Write all pages of the reference below a folder."""
    folder = source / "reference"
    python_pages(folder / "python")
    key_pages(folder / "keys")
    schemas(folder / "schema")
    page(folder / "figures.md", "Figures", figures())
    page(folder / "commands.md", "Commands", commands())
    page(folder / "formats.md", "File formats", file_formats())


def page(path: Path, title: str, body: Iterable[str]) -> None:
    """Write one page."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join([f"# {title}", "", *body]) + "\n", encoding="utf-8")


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> list[str]:
    """A Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return ["| " + " | ".join(str(cell).replace("|", "\\|") for cell in line) + " |" for line in lines] + [""]


def wide(lines: Sequence[str]) -> list[str]:
    """A table of many columns, to which its page gives more room."""
    return ["::::{container} wide", "", *lines, "::::", ""]


def code(text: str) -> str:
    """A text as code, or nothing of nothing."""
    return f"`{text}`" if text else ""


# ---------------------------------------------------------------- public names


def own_members(owner: type) -> list[str]:
    """Public methods and properties of a class, without those that every answer and every model of pydantic has."""
    common = set() if owner is gm.Result else {name for name in vars(gm.Result) if not name.startswith("_")}
    internal = {name for kind in owner.__mro__ for name in INTERNAL.get(kind.__name__, ())}
    hidden = {"model_post_init", *internal, *common, *dir(BaseModel), *dir(Exception)}
    if issubclass(owner, Design):
        return list(OF_DESIGNS)
    names: dict[str, None] = {}
    for kind in reversed(owner.__mro__):
        if kind.__module__.startswith("gearmesh."):
            for name, member in vars(kind).items():
                shown = inspect.isroutine(member) or isinstance(member, property | cached_property | classmethod)
                if shown and not isinstance(member, Deprecated) and not name.startswith("_") and name not in hidden:
                    names.setdefault(name)
    return [name for name in names if inspect.getdoc(getattr(owner, name))]


def directive(name: str) -> list[str]:
    """Return the lines of which autodoc makes the entry of a public name."""
    value = getattr(gm, name)
    lines = [f"## {name}", "", "```{eval-rst}", ".. py:currentmodule:: gearmesh", ""]
    if inspect.isclass(value):
        lines += [f".. autoclass:: gearmesh.{name}"]
        for member in own_members(value):
            is_value = isinstance(inspect.getattr_static(value, member), property | cached_property)
            lines += ["", f"   .. auto{'property' if is_value else 'method'}:: gearmesh.{name}.{member}"]
    else:
        lines += [f".. autofunction:: gearmesh.{name}"]
    return [*lines, "```", ""]


def fields_of(value: type) -> str:
    """Return the fields of a class, in their order; the keys of a table of a design."""
    fields = value.model_fields if issubclass(value, Table) else getattr(value, "__dataclass_fields__", {})
    return ", ".join(code(field) for field in fields if not field.startswith("_"))


#: types within answers: their base, title, and what they are
PARTS = (
    (
        Figures,
        "Figures",
        "Rows of answers and what is in them, each field a figure; units and meanings are on [their page](../figures.md).",
    ),
    (
        Table,
        "Tables of designs",
        "`design.pinion`, `design.assembly` and all other tables of a design; what keys mean is on the page of their kind.",
    ),
)


def loaded_classes_of(base: type) -> dict[str, type]:
    """Return the classes of the package that are loaded and have a base, by their names; no designs."""
    found = {one.__name__: one for one in base.__subclasses__() if one.__module__.startswith("gearmesh.")}
    for one in list(found.values()):
        found |= loaded_classes_of(one)
    shown = {name: one for name, one in found.items() if not name.startswith("_") and not issubclass(one, Design)}
    return dict(sorted(shown.items()))


def parts() -> list[str]:
    """Return tables of the types within answers and designs."""
    body: list[str] = []
    for base, title, about in PARTS:
        rows = ((code(name), summary(one), fields_of(one)) for name, one in loaded_classes_of(base).items())
        body += [f"## {title}", "", about, "", *table(("class", "what", "fields"), rows)]
    return body


def kinds_of_design() -> dict[str, list[str]]:
    """Names of the exported design classes, and the kinds whose designs they are."""
    names: dict[str, list[str]] = {}
    for name in gm.__all__:
        value = getattr(gm, name)
        if inspect.isclass(value) and issubclass(value, Design) and value is not Design:
            names[name] = [kind for kind in gm.kinds() if value in classes_of(kind)]
    return names


def classes_of(kind: str) -> set[type]:
    """The classes that a design of a kind can have."""
    known = gm.system(kind)
    return {known.design} if known.single is None else {known.design, known.single.design}


def python_pages(folder: Path) -> None:
    """One page for each group of public names, and their index."""
    assigned = [name for *_, names in PYTHON for name in names]
    designs = kinds_of_design()
    missing = set(gm.__all__) - {*assigned, *designs}
    if missing or len(assigned) != len(set(assigned)):
        raise ValueError(f"public names on no page, or on two: {sorted(missing)}")
    for file, title, about, names in PYTHON:
        page(folder / f"{file}.md", title, [about, "", *(line for name in names for line in directive(name))])
    rows = [
        [code(name), summary(getattr(gm, name)), ", ".join(f"[{kind}](../keys/{kind}.md)" for kind in kinds)]
        for name, kinds in designs.items()
    ]
    page(
        folder / "designs.md",
        "Classes of designs",
        [
            "`gm.load`, `gm.parse` and `gm.build` know by its `kind` which class a design has; its fields are the keys",
            "of the file.",
            "",
            *table(("class", "what", "keys"), rows),
        ],
    )
    page(
        folder / "parts.md",
        "Types within answers",
        [
            "What attributes of answers and designs are. They are no public names: their fields stay, their modules may change.",
            "",
            *parts(),
        ],
    )
    listed = [*(file for file, *_ in PYTHON), "designs", "parts"]
    body = [
        "All public names are those of `import gearmesh as gm`. Lengths are in mm, or texts with their unit, as `10um` or",
        "`0.5in`; angles in degrees, torques in Nm. Shapes of arrays: (P,) is one number for each of P positions, (..., 3) are",
        "points.",
        "",
        *table(
            ("page", "names"),
            [(f"[{title}]({file}.md)", ", ".join(f"`{name}`" for name in names)) for file, title, _, names in PYTHON],
        ),
        *toctree(listed),
    ]
    page(folder / "index.md", "Python", body)


def toctree(entries: Iterable[str], *, hidden: bool = True) -> list[str]:
    """The pages below a page."""
    return ["```{toctree}", ":maxdepth: 1", *([":hidden:"] if hidden else []), "", *entries, "```", ""]


# ---------------------------------------------------------------- files


def file_formats() -> list[str]:
    """Return the table of all file formats, as `gearmesh formats` prints it."""
    rows = [format_row(entry) for entry in FILE_FORMATS]
    return wide(table(FORMAT_COLUMNS, rows))


# ---------------------------------------------------------------- keys


def key_pages(folder: Path) -> None:
    """Every key of every kind, as `gearmesh describe KIND` lists them."""
    kinds = gm.kinds()
    for kind in kinds:
        design = gm.system(kind).design
        body = [
            f"{design.about[:1].upper()}{design.about[1:]}.",
            "",
            f"`gearmesh new {kind} -o FILE.toml` writes a file to start from; the [JSON Schema](../schema/{kind}.json) of these",
            "files completes and checks them in editors. Lengths are in the `units` of the file.",
            "",
        ]
        if gm.system(kind).single is not None:
            body += [
                "A file with one member alone describes one gear without a mating gear; its keys are among these.",
                "",
            ]
        for group, lines in design.key_groups().items():
            rows = [(code(line.key), line.unit, line.range, line.default, line.about, line.source) for line in lines]
            body += [f"## {group}" if group else "## Keys", ""]
            body += wide(table(("key", "unit", "range", "default", "meaning", "source"), rows))
        page(folder / f"{kind}.md", kind, body)
    rows = [(f"[`{kind}`]({kind}.md)", gm.system(kind).design.about) for kind in kinds]
    page(
        folder / "index.md",
        "Keys of design files",
        [
            "A design is a TOML or JSON file with a `kind`. `gearmesh describe KIND` prints these tables, `--json FILE` writes",
            "them, `--schema` the JSON Schema. Every key can be set anew on the command line: `--set pinion.teeth=25`.",
            "",
            *table(("kind", "gears"), rows),
            *toctree(kinds),
        ],
    )


def schemas(folder: Path) -> None:
    """The JSON Schema of the files of every kind, and of report.json."""
    folder.mkdir(parents=True, exist_ok=True)
    for kind in gm.kinds():
        text = json_text(design_schema(gm.system(kind).design, kind))
        (folder / f"{kind}.json").write_text(text, encoding="utf-8")
    (folder / "report.json").write_text(json_text(report_schema()), encoding="utf-8")


# ---------------------------------------------------------------- figures


def figures() -> list[str]:
    """Every figure of every answer, as `gearmesh describe --figures` prints them."""
    body = [
        "Keys of JSON files and columns of tables, with unit, symbol (ISO 21771, ISO 23509, ISO 6336, or the source's) and",
        "meaning. `gearmesh describe --figures WORD` prints those whose key contains a word. `{member}` stands for the name of",
        "a member.",
        "",
    ]
    for group in figure_groups():
        rows = [(code(key), unit, symbol, meaning) for key, unit, symbol, meaning in group.rows]
        body += [f"## {group.of}", "", *table(("key", "unit", "symbol", "meaning"), rows)]
    return body


# ---------------------------------------------------------------- commands


def commands() -> list[str]:
    """Every command with its arguments and options."""
    group: Any = typer.main.get_command(cli.command_line())
    body = [
        "`gearmesh COMMAND --help` prints the same. `-` as DESIGN is standard input. [Exit statuses and files](files.md).",
        "",
        *table(
            ("command", "what it does"),
            [(f"[`{name}`](#{name})", first_sentence(known.help)) for name, known in group.commands.items()],
        ),
    ]
    for name, known in group.commands.items():
        context = known.make_context(name, [], resilient_parsing=True)
        usage = " ".join(["gearmesh", name, *known.collect_usage_pieces(context)])
        records = [record for parameter in known.get_params(context) if (record := parameter.get_help_record(context))]
        body += [f"## {name}", "", " ".join((known.help or "").split()), "", "```text", usage, "```", ""]
        body += table(
            ("argument, option", "meaning"), [(code(option), " ".join(text.split())) for option, text in records]
        )
    return body


def first_sentence(text: str | None) -> str:
    return " ".join((text or "").split()).partition(". ")[0].rstrip(".") + "."


def summary(value: Any) -> str:
    """The first line of a docstring."""
    return (inspect.getdoc(value) or "").partition("\n")[0]
