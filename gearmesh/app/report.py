"""Results as people and programs read them: tables for the terminal, JSON documents, CSV.

Everything here turns finished results into text; keys carry their unit, and what is not a number becomes null.
"""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TextIO

from gearmesh import __version__

if TYPE_CHECKING:
    from gearmesh.contact.path import ContactPath
    from gearmesh.design import Design, KeyLine
    from gearmesh.systems.spiral_bevel.sheet import Sheet


#: Characters in a line of a window that is wide enough for anything.
_ENDLESS = 100_000


@dataclass(frozen=True)
class Listing:
    """A table to print: title, column headings (with units) and rows of values."""

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Any]]


def show(listings: Iterable[Listing], file: TextIO) -> None:
    """Print tables: ruled and coloured on a terminal, aligned plain text elsewhere."""
    terminal = file.isatty()
    for index, listing in enumerate(listings):
        if terminal:
            _show_ruled(listing, file)
        else:
            file.write(("\n" if index else "") + aligned(listing))


def aligned(listing: Listing) -> str:
    """A table as plain text: title, headings, then one line a row, columns at least two blanks apart."""
    cells = [[_cell(value) for value in row] for row in listing.rows]
    numeric = [all(isinstance(row[k], int | float) for row in listing.rows) for k in range(len(listing.columns))]
    table = [list(listing.columns), *cells] if any(listing.columns) else cells
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    lines = [
        "  ".join(
            cell.rjust(width) if right else cell.ljust(width)
            for cell, width, right in zip(row, widths, numeric, strict=True)
        ).rstrip()
        for row in table
    ]
    return "".join(line + "\n" for line in [listing.title, *lines] if line)


def _show_ruled(listing: Listing, file: TextIO) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(
        title=listing.title or None, title_justify="left", box=box.SIMPLE_HEAD, show_header=any(listing.columns)
    )
    for k, column in enumerate(listing.columns):
        if all(isinstance(row[k], int | float) for row in listing.rows):
            table.add_column(column.replace(" ", "\n"), justify="right", no_wrap=True)
        else:
            table.add_column(column, no_wrap=k == 0, overflow="fold")
    for row in listing.rows:
        table.add_row(*(Text(_cell(value)) for value in row))
    console = Console(file=file)
    needed = console.measure(table, options=console.options.update(width=_ENDLESS)).minimum
    # a window too narrow for the numbers breaks lines; it never cuts a number short
    console.width = max(console.width, needed)
    console.print(table, soft_wrap=True)


def _cell(value: Any) -> str:
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "-"
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.7g}" if isinstance(value, float) else str(value)


def plain(value: Any) -> Any:
    """Nested data with numpy numbers and arrays made Python ones, and NaN and infinities made None."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def json_text(document: Mapping[str, Any]) -> str:
    """A document as JSON text."""
    return json.dumps(plain(document), indent=1, allow_nan=False) + "\n"


# ---------------------------------------------------------------- contact


def positions(path: ContactPath, params: Mapping[str, Sequence[Mapping[str, float]]]) -> list[dict[str, Any]]:
    """One dict a position with the keys of `tca --json`; NaN where there is nothing."""
    from gearmesh.contact.path import ARCSEC
    from gearmesh.errors import Status

    phi1, phi2, angle = (_degrees(values) for values in (path.phi1, path.phi2, path.angle))
    te = (path.te / ARCSEC).tolist()
    status = [Status(code).name.lower() for code in path.status.tolist()]
    points, normals, majors = path.point.tolist(), path.normal.tolist(), path.major.tolist()
    own = {"pinion": path.point1.tolist(), "gear": path.point2.tolist()}
    a, b = path.semi_major.tolist(), path.semi_minor.tolist()
    return [
        {
            "phi1_deg": phi1[i],
            "phi2_deg": phi2[i],
            "te_arcsec": te[i],
            "contact": str(path.kind[i]),
            "edge": str(path.edge[i]) or None,
            "status": status[i],
            "residual_mm": float(path.residual[i]),
            "point_mm": points[i],
            "normal": normals[i],
            **{member: {"params": dict(params[member][i]), "point_mm": own[member][i]} for member in own},
            "ellipse": {"a_mm": a[i], "b_mm": b[i], "angle_deg": angle[i], "major_axis": majors[i]},
            "line_mm": path.lines[i],
        }
        for i in range(len(phi1))
    ]


def _degrees(radians: Any) -> list[float]:
    """Degrees; the last digits, which going to radians and back leaves behind, are rounded away."""
    return (radians * (180.0 / math.pi)).round(12).tolist()


def tca_document(design: Design, result: Any) -> dict[str, Any]:
    """`tca --json`."""
    rows = _with_hertz(positions(result.path, result.params), result)
    return {
        "gearmesh": __version__,
        "design": design.resolved(),
        "summary": result.summary,
        "warnings": list(result.warnings),
        "positions": [_without_nothing(row) for row in rows],
    }


def _without_nothing(row: dict[str, Any]) -> dict[str, Any]:
    """A position with vectors of NaN and ellipses without axes as None."""
    members = {m: {**row[m], "point_mm": _vector(row[m]["point_mm"])} for m in ("pinion", "gear")}
    vectors = {name: _vector(row[name]) for name in ("point_mm", "normal")}
    ellipse = None if math.isnan(row["ellipse"]["a_mm"]) else row["ellipse"]
    loaded = {"hertz": None if math.isnan(row["hertz"]["p0_mpa"]) else row["hertz"]} if "hertz" in row else {}
    return {**row, **vectors, **members, "ellipse": ellipse, **loaded}


def _with_hertz(rows: list[dict[str, Any]], result: Any) -> list[dict[str, Any]]:
    """Positions with the Hertz contact under the torque that was asked for; as they are without one."""
    hertz = result.hertz
    if hertz is None:
        return rows
    columns = {
        "p0_mpa": hertz.peak_pressure,
        "a_mm": hertz.semi_major,
        "b_mm": hertz.semi_minor,
        "approach_um": 1e3 * hertz.approach,
        "force_n": hertz.force,
    }
    return [{**row, "hertz": {k: float(v[i]) for k, v in columns.items()}} for i, row in enumerate(rows)]


def _vector(values: list[float]) -> list[float] | None:
    return None if any(map(math.isnan, values)) else values


def tca_csv(result: Any) -> str:
    """`tca --csv`: one row a position, the columns of the JSON laid flat, empty where there is nothing."""
    rows = [dict(_flat(row)) for row in _with_hertz(positions(result.path, result.params), result)]
    file = io.StringIO()
    writer = csv.DictWriter(file, fieldnames=list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(plain(row) for row in rows)
    return file.getvalue()


def _flat(row: Mapping[str, Any], prefix: str = "") -> Iterable[tuple[str, Any]]:
    for key, value in row.items():
        if key == "line_mm":
            continue
        if isinstance(value, Mapping):
            yield from _flat(value, prefix if key == "params" else f"{prefix}{key}_")
        elif isinstance(value, list):
            stem, unit = (key[:-3], "_mm") if key.endswith("_mm") else (key, "")
            yield from ((f"{prefix}{stem}_{axis}{unit}", x) for axis, x in zip("xyz", value, strict=True))
        else:
            yield prefix + key, value


def tca_listings(result: Any) -> list[Listing]:
    """`tca` for people: rounded, so that what is zero but for rounding reads as zero."""
    rows = positions(result.path, result.params)
    names = [(member, name) for member in ("pinion", "gear") for name in result.params[member][0]]
    columns = ["phi1 deg", "phi2 deg", "TE arcsec", "contact", "a mm", "b mm"]
    values = [
        [
            _rounded(row["phi1_deg"], 4),
            _rounded(row["phi2_deg"], 4),
            _rounded(row["te_arcsec"], 3),
            f"edge: {row['edge']}" if row["edge"] else row["contact"],
            _rounded(row["ellipse"]["a_mm"], 4),
            _rounded(row["ellipse"]["b_mm"], 4),
            *(_rounded(row[member]["params"][name], 4) for member, name in names),
        ]
        for row in rows
    ]
    columns += [f"{member} {name}" for member, name in names]
    return [Listing("Contact", columns, values), *_hertz_listing(rows, result), figures("Summary", result.summary)]


def _hertz_listing(rows: list[dict[str, Any]], result: Any) -> list[Listing]:
    """The table of the Hertz contact, if a torque was asked for."""
    loaded = _with_hertz(rows, result)
    if "hertz" not in loaded[0]:
        return []
    digits = {"p0_mpa": 1, "a_mm": 4, "b_mm": 4, "approach_um": 3, "force_n": 2}
    columns = ["phi1 deg", *(name.replace("_", " ") for name in digits)]
    values = [
        [_rounded(row["phi1_deg"], 4), *(_rounded(row["hertz"][k], n) for k, n in digits.items())] for row in loaded
    ]
    return [
        Listing(f"Hertz contact, {result.hertz.torque:g} Nm on the pinion, all on this pair of teeth", columns, values)
    ]


def _rounded(value: float, digits: int) -> float:
    return round(value, digits) + 0.0  # no -0


# ---------------------------------------------------------------- solids, checks and the rest


def figures(title: str, values: Mapping[str, Any]) -> Listing:
    """Named figures, one a row, under their JSON keys."""
    rows = []
    for key, value in values.items():
        value = plain(value)
        rows.append((key, ", ".join(map(_cell, value)) if isinstance(value, list) else value))
    return Listing(title, ("", ""), rows)


def fe_document(design: Design, model: Mapping[str, Any], solution: Mapping[str, Any] | None) -> dict[str, Any]:
    """`fe --json`: the model's figures, and the solver's, null where it was not asked."""
    return {"gearmesh": __version__, "design": design.resolved(), "model": model, "solution": solution}


def fe_listings(model: Mapping[str, Any], solution: Mapping[str, Any] | None) -> list[Listing]:
    """The figures of a finite-element model and of its solution, laid flat."""
    listings = [figures("Model", dict(_flat(model)))]
    if solution is None:
        return listings
    pairs = solution.get("tooth_pairs", [])
    rows = [[k, *(_rounded(value, 3) for value in pair.values())] for k, pair in enumerate(pairs, 1)]
    tables = [Listing("Tooth pairs", ["pair", *pairs[0]], rows)] if pairs else []
    rest = {key: value for key, value in solution.items() if key != "tooth_pairs"}
    return [*listings, *tables, figures("Solution", dict(_flat(rest)))]


def check_document(design: Design, result: Mapping[str, Any]) -> dict[str, Any]:
    """`check --json`."""
    return {"gearmesh": __version__, "design": design.resolved(), **result}


def check_listings(result: Mapping[str, Any]) -> list[Listing]:
    """`check` for people."""
    meshes, roll = plain(result["mesh"]), plain(result["roll"])
    figures_of = list(next(iter(meshes.values())))
    rows = [[member, *(values[name] for name in figures_of)] for member, values in meshes.items()]
    listings = [Listing("Meshes against exact surfaces", ["", *figures_of], rows)]
    if roll:
        columns = list(roll[0])
        listings.append(Listing("Roll test against solver", columns, [[row[name] for name in columns] for row in roll]))
    return listings


def check_warnings(result: Mapping[str, Any]) -> list[str]:
    """What the check found wrong with the meshes, one line each."""
    lines = []
    for member, values in result["mesh"].items():
        if not values["watertight"]:
            lines.append(f"the mesh of the {member} is not watertight")
        if values["max_deviation_um"] > values["tolerance_um"]:
            lines.append(
                f"the mesh of the {member} is {values['max_deviation_um']:.4g} um from the exact surface, more than the"
                f" tolerance of {values['tolerance_um']:.4g} um"
            )
    return lines


def run_listings(report: Mapping[str, Any]) -> list[Listing]:
    """`run` for people: meshes, contact, roll test, files."""
    listings = check_listings(report)
    listings.insert(1, figures("Contact", report["contact"]))
    return [*listings, Listing("Files", ("",), [(str(file),) for file in report["files"]])]


def settings_listing(rows: Sequence[Mapping[str, Any]]) -> Listing:
    """`settings` for people."""
    columns = ("key", "value_before", "value_after", "unit", "effect")
    heads = ("key", "before", "after", "unit", "effect")
    return Listing("Settings", heads, [[plain(row[name]) for name in columns] for row in rows])


def sheet_listings(sheet: Sheet) -> list[Listing]:
    """The settings sheet for people."""
    return [
        Listing(table.title, ("", "unit", *table.columns), [[plain(value) for value in row] for row in table.rows])
        for table in sheet.tables
    ]


def kinds_listing(kinds: Mapping[str, type[Design]]) -> Listing:
    """The kinds of design, one a line."""
    return Listing("", ("kind", "what"), [(name, kind.about) for name, kind in kinds.items()])


def keys_listing(kind: str, keys: Iterable[KeyLine]) -> Listing:
    """Every key of a kind."""
    rows = [(line.key, line.unit, line.range, line.default, line.about, line.source) for line in keys]
    return Listing(f'kind = "{kind}"', ("key", "unit", "allowed", "default", "what", "source"), rows)
