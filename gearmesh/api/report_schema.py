"""JSON Schema of report.json: every figure of a run with its declared unit, symbol and meaning."""

from __future__ import annotations

import re

from gearmesh import __version__
from gearmesh.answers.bodies.solid import SolidFigures
from gearmesh.answers.check import MeshRoll, RollRow, Verdict
from gearmesh.answers.contact.figures import CycleSummary, PathSummary, SlideSummary, TorqueSummary
from gearmesh.answers.contact.fit import FitSummary
from gearmesh.answers.contact.shared import SharedFigures
from gearmesh.answers.contact.turns import TurnsSummary
from gearmesh.answers.contact.zone import ZoneFigures
from gearmesh.answers.load.figures import LoadedFigures
from gearmesh.answers.sheet import MissingFigures
from gearmesh.api.design_schema import SCHEMA_DIALECT, JsonSchema
from gearmesh.figures import MEMBER_PLACE, Figure, Figures
from gearmesh.systems.system import kinds

#: parts of the summary of a contact; gear systems add more figures
CONTACT_SUMMARIES = (
    PathSummary,
    CycleSummary,
    ZoneFigures,
    SlideSummary,
    FitSummary,
    TorqueSummary,
    TurnsSummary,
    SharedFigures,
)
#: schema of a number that may be unknown
NUMBER_OR_NULL = {"type": ["number", "null"]}


def report_schema() -> JsonSchema:
    """Return the schema of report.json, draft 2020-12; `$id` has the version of gearmesh.

    All sections are listed. A kind of gears may have more figures in a section than listed here: see the page of all figures.
    """
    contact, loaded = figures_schema(*CONTACT_SUMMARIES), figures_schema(LoadedFigures)
    sections: JsonSchema = {
        "gearmesh": {"type": "string", "description": "version that wrote the report"},
        "design": {
            "type": "object",
            "description": "the design with its defaults; its keys are those of the schema of its kind",
            "properties": {"kind": {"enum": list(kinds())}},
            "required": ["kind"],
        },
        "mesh": by_name("solids, by members", figures_schema(SolidFigures)),
        "contact": contact | {"description": "contact of the first mesh"},
        "meshes": by_name("contact of every different mesh of a gear set, by pairs", contact),
        "loaded": loaded | {"description": "the first mesh under torque, where one was asked for"},
        "loaded_meshes": by_name("every different mesh of a gear set under torque, by pairs", loaded),
        "roll": rows("the roll test, position by position", RollRow),
        "other_meshes": rows("roll tests of further meshes of a gear set", MeshRoll),
        "verdicts": rows("what was compared", Verdict),
        "sheet": by_name("the data sheet: by title and symbol the unit and the values of a row", {"type": "object"}),
        "sheet_missing": rows("values that the data sheet has not, and why, if there are any", MissingFigures),
        "warnings": {"type": "array", "items": {"type": "string"}, "description": "what to know of gears and figures"},
        "files": {"type": "array", "items": {"type": "string"}, "description": "files in the folder"},
        "frames": by_name("frames of the coordinates in files, by files", {"type": "string"}),
        "timing": {
            "type": "object",
            "description": "run times, s, under the keys of the sections; not with --no-timing",
        },
    }
    return {
        "$schema": SCHEMA_DIALECT,
        "$id": f"urn:gearmesh:{__version__}:report",
        "title": "gearmesh report.json",
        "description": "what gearmesh run found and wrote",
        "type": "object",
        "properties": sections,
        "required": ["gearmesh", "design", "mesh", "roll", "verdicts", "warnings", "files", "frames"],
        "additionalProperties": False,
    }


def by_name(description: str, of: JsonSchema) -> JsonSchema:
    """Return the schema of an object whose keys are names."""
    return {"type": "object", "description": description, "additionalProperties": of}


def rows(description: str, kind: type[Figures]) -> JsonSchema:
    """Return the schema of a list of figures of one kind."""
    return {"type": "array", "description": description, "items": figures_schema(kind)}


def figures_schema(*kinds_of_figures: type[Figures]) -> JsonSchema:
    """Return the schema of an object with figures of some kinds; keys of members are patterns."""
    properties: JsonSchema = {}
    patterns: JsonSchema = {}
    for kind in kinds_of_figures:
        for figure in kind.declared_figures():
            if figure.timing:
                continue
            if MEMBER_PLACE in figure.key:
                name = re.escape(figure.key).replace(re.escape(MEMBER_PLACE), r"[A-Za-z]\w*")
                patterns[f"^{name}$"] = figure_schema(figure)
                continue
            properties[figure.key] = figure_schema(figure)
            if figure.unit == "arcsec":
                travel = figure.in_um()
                properties[travel.key] = figure_schema(travel)
    return {"type": "object", "properties": properties} | ({"patternProperties": patterns} if patterns else {})


def figure_schema(figure: Figure) -> JsonSchema:
    """Return the schema of a figure: its type if it has a unit, is whole or is a vector; null stands for unknown."""
    unit = f" [{figure.unit}]" if figure.unit else ""
    symbol = f", {figure.symbol}" if figure.symbol else ""
    described = {"description": f"{figure.meaning}{symbol}{unit}"}
    if figure.vector:
        return {"type": ["array", "null"], "items": NUMBER_OR_NULL} | described
    if figure.whole:
        return {"type": ["integer", "array", "null"]} | described
    if figure.unit:
        return {"type": ["number", "array", "object", "null"]} | described
    return described
