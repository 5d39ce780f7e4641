"""The command line. Commands load what they need when they run, so that `--help` and `describe` answer at once.

Exit statuses: 0 done, 2 bad input or output, 3 no solution; failures are one line on standard error.
"""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from gearmesh import __version__
from gearmesh.app.fe_command import fe
from gearmesh.app.limits_command import limits
from gearmesh.app.options import DesignFile, Json, PartName, Set, Tolerance, load_design
from gearmesh.app.terminal import (
    one_line,
    output_folder,
    picture_size,
    refuse_suffix,
    refuse_unwritable,
    require_contact,
    tolerance_in_mm,
    warn,
    without_contact,
    working,
    write_text,
)
from gearmesh.errors import DesignError, GearmeshError, OutputError

if TYPE_CHECKING:
    from gearmesh.design import Design

#: Parent of every complaint about the command line itself, wherever the installed typer keeps it.
_UsageError: Any = typer.BadParameter.__mro__[1]

app = typer.Typer(
    name="gearmesh",
    help="Exact gear tooth surfaces, their contact, and meshes proved against both.",
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit status; expected failures become one line on standard error."""
    try:
        status = typer.main.get_command(app).main(
            args=None if arguments is None else list(arguments), prog_name="gearmesh", standalone_mode=False
        )
        sys.stdout.flush()
    except GearmeshError as error:
        return _fail(str(error), error.exit_status)
    except _UsageError as error:
        where = error.ctx.command_path if error.ctx else "gearmesh"
        return _fail(f"{error.format_message().rstrip('.')} (see {where} --help)", 2)
    except typer.Abort:
        return _fail("stopped", 130)
    except BrokenPipeError:
        _drop_output()
        return 1
    except OSError as error:
        _drop_output()
        return _fail(f"{error.filename or 'standard output'}: {error.strerror or error}", 2)
    except MemoryError:
        return _fail("out of memory: ask for a larger --tol, fewer positions or a smaller picture", 2)
    return status if isinstance(status, int) else 0


def _fail(message: str, status: int) -> int:
    print(f"gearmesh: error: {one_line(message)}", file=sys.stderr)
    return status


def _drop_output() -> None:
    """Let nothing more be written to a standard output that is closed or full: Python tries once more on exit."""
    try:
        descriptor = sys.stdout.fileno()
    except (OSError, ValueError):  # not a file
        return
    os.dup2(os.open(os.devnull, os.O_WRONLY), descriptor)


def _print_version(wanted: bool) -> None:
    if wanted:
        print(f"gearmesh {__version__}")
        raise typer.Exit


@app.callback()
def _program(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Show the version and exit.")
    ] = False,
) -> None:
    pass


@app.command()
def run(
    design_file: DesignFile,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Folder for the results. [default: out/DESIGN]")
    ] = None,
    tol: Tolerance = None,
    settings: Set = None,
) -> None:
    """The main job: solids, contact, check and pictures in a folder."""
    design = load_design(design_file, settings)
    tolerance = tolerance_in_mm(tol, design)
    folder = Path("out") / design_file.stem if output is None else output
    from gearmesh.app import job, report

    with output_folder(folder), working("starting") as progress:
        result = job.run(design, folder, tolerance, progress)
    report.show(report.run_listings(result), sys.stdout)
    skipped = [result["skipped"]] if result["skipped"] else []
    warn(result["warnings"], report.check_warnings(result), skipped)


@app.command()
def tca(
    design_file: DesignFile,
    json_file: Json = None,
    csv_file: Annotated[
        str | None, typer.Option("--csv", metavar="FILE|-", help="Write a table; - is standard output.")
    ] = None,
    torque: Annotated[
        float | None,
        typer.Option(
            "--torque",
            metavar="NM",
            help="Torque on the pinion: adds the Hertz pressure, with all of it on one pair of teeth.",
        ),
    ] = None,
    settings: Set = None,
) -> None:
    """Tooth contact: path, transmission error, ellipses."""
    if json_file == csv_file == "-":
        raise DesignError("--csv = -: standard output is taken by --json")
    if torque is not None and not 0.0 < torque < math.inf:
        raise DesignError(f"--torque = {torque:g}: must be a finite number of Nm above 0")
    design = load_design(design_file, settings)
    for file in (json_file, csv_file):
        refuse_unwritable(file)
    from gearmesh.app import job, report

    with working("tooth contact"):
        result = job.tca(design, torque)
    require_contact(result.path)
    write_text(json_file, lambda: report.json_text(report.tca_document(design, result)))
    write_text(csv_file, lambda: report.tca_csv(result))
    if "-" not in (json_file, csv_file):
        report.show(report.tca_listings(result), sys.stdout)
    warn(result.warnings, without_contact(result.path))


@app.command()
def solid(
    design_file: DesignFile,
    member: Annotated[
        PartName,
        typer.Option(
            "--member",
            help="Which gear; both in mesh go into a .step; the worm is the one that grinds the pinion.",
            show_default=False,
        ),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FILE", help="File; its suffix is the format.")],
    tol: Annotated[
        str | None,
        typer.Option(
            "--tol",
            metavar="LEN",
            help="Largest distance from the exact surface: 10um, 0.01mm, 0.0004in; bare = mm. "
            "[default: the design's for a mesh, 0.1um for .step]",
        ),
    ] = None,
    teeth: Annotated[int | None, typer.Option("--teeth", metavar="K", help="Only the first K teeth.")] = None,
    settings: Set = None,
) -> None:
    """One gear or its grinding worm as a watertight mesh, or as CAD solids."""
    design = load_design(design_file, settings)
    from gearmesh import io
    from gearmesh.app import job, report
    from gearmesh.cad.step import SUFFIXES

    suffix, allowed = output.suffix.lower(), [*io.formats(), *SUFFIXES]
    if suffix in SUFFIXES:
        _solid_bodies(design, member.value, output, tol, teeth)
        return
    if member is PartName.both:
        raise DesignError(
            f"--member = both: must be pinion or gear for {suffix or 'a mesh'}; both go into {SUFFIXES[0]}"
        )
    tolerance = tolerance_in_mm(tol, design)
    few = teeth is not None and _are_few(design, member, teeth)
    if suffix not in allowed:
        raise OutputError(f"cannot write {output}: its suffix must be one of {', '.join(allowed)}")
    refuse_unwritable(output)
    with working(f"solid of the {member.value}"):
        result = job.solid(design, member.value, tolerance, teeth, output)
        io.write(result.mesh, output)
    report.show([report.figures("", result.figures)], sys.stdout)
    # a few teeth are open by nature
    found = [] if few else report.check_warnings({"mesh": {member.value: result.figures}})
    warn(result.warnings, found)


def _are_few(design: Design, member: PartName, teeth: int) -> bool:
    """Whether --teeth asks for fewer than all teeth."""
    if member is PartName.worm:
        raise DesignError(f"--teeth = {teeth}: must be left out for --member = worm, which is made whole")
    all_teeth = getattr(design, member.value).teeth
    if not 1 <= teeth <= all_teeth:
        raise DesignError(f"--teeth = {teeth}: must be a whole number from 1 to {all_teeth}")
    return bool(teeth < all_teeth)


def _solid_bodies(design: Design, member: str, output: Path, tol: str | None, teeth: int | None) -> None:
    """`solid` to a STEP file."""
    from gearmesh.app import job, report
    from gearmesh.cad.brep import TOLERANCE
    from gearmesh.cad.step import write_step

    if teeth is not None:
        raise DesignError(f"--teeth = {teeth}: must be left out for {output.suffix}, which holds whole gears")
    tolerance = TOLERANCE if tol is None else tolerance_in_mm(tol, design)
    refuse_unwritable(output)
    with working("CAD solids" if member == "both" else f"CAD solid of the {member}"):
        result = job.bodies(design, member, tolerance)
        write_step(result.parts, output, result.description, result.placements)
    titles = {name: name if member == "both" else "" for name in result.figures}
    report.show([report.figures(titles[name], values) for name, values in result.figures.items()], sys.stdout)
    warn(result.warnings)


@app.command()
def render(
    design_file: DesignFile,
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FILE.png", help="Picture to write.")],
    size: Annotated[str, typer.Option("--size", metavar="WxH", help="Width and height in pixels.")] = "1600x1200",
    settings: Set = None,
) -> None:
    """A picture of the pair in mesh with its contact."""
    design = load_design(design_file, settings)
    pixels = picture_size(size)
    refuse_suffix(output, ".png")
    refuse_unwritable(output)
    from gearmesh.app import job

    with working("picture"):
        job.render(design, output, pixels)
    warn(job.pair(design).warnings)


@app.command()
def check(design_file: DesignFile, json_file: Json = None, tol: Tolerance = None, settings: Set = None) -> None:
    """Meshes against exact surfaces, roll test against solver."""
    design = load_design(design_file, settings)
    tolerance = None if tol is None else tolerance_in_mm(tol, design)
    refuse_unwritable(json_file)
    from gearmesh.app import job, report

    with working("check"):
        result = job.check(design, tolerance)
    write_text(json_file, lambda: report.json_text(report.check_document(design, result)))
    if json_file != "-":
        report.show(report.check_listings(result), sys.stdout)
    warn(result["warnings"], report.check_warnings(result))


app.command()(fe)
app.command()(limits)


@app.command()
def settings(
    design_file: DesignFile,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="NEW.toml", help="Write the design with these settings.")
    ] = None,
    compensate: Annotated[
        bool,
        typer.Option("--compensate", help="Restore path and transmission error under the design's assembly errors."),
    ] = False,
    settings: Set = None,
) -> None:
    """Machine settings that give the contact asked for.

    For spiral bevel gears the settings sheet, or with --compensate the settings that make good the assembly errors of the
    design; for circular-arc gears always the latter.
    """
    design = load_design(design_file, settings)
    if output is not None:
        refuse_suffix(output, ".toml")
        refuse_unwritable(output)
    from gearmesh.app import job, report
    from gearmesh.design import toml
    from gearmesh.systems.spiral_bevel.sheet import KINDS

    with working("settings"):
        if design.kind in KINDS and not compensate:
            sheet = job.sheet(design)
            values, listings = sheet.values, report.sheet_listings(sheet)
        else:
            rows = job.settings(design)
            values, listings = {row["key"]: row["value_after"] for row in rows}, [report.settings_listing(rows)]
    if output is not None:
        write_text(str(output), lambda: toml(job.apply_settings(design, values)))
    report.show(listings, sys.stdout)
    warn(job.pair(design).warnings)


@app.command()
def describe(
    kind: Annotated[str | None, typer.Argument(metavar="[KIND|DESIGN]", show_default=False)] = None,
) -> None:
    """The gear systems, every key of one of them, or of a spiral bevel design file its settings sheet."""
    from gearmesh.app import report
    from gearmesh.design import KINDS, kind_of

    if kind is not None and Path(kind).suffix in (".toml", ".json"):
        from gearmesh.app import job

        report.show(report.sheet_listings(job.sheet(load_design(Path(kind), None))), sys.stdout)
        return
    listing = report.kinds_listing(KINDS) if kind is None else report.keys_listing(kind, kind_of(kind).key_lines())
    report.show([listing], sys.stdout)
