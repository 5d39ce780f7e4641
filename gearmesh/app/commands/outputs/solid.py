"""The command `solid`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gearmesh.app.options import DesignFile, Set, load_alone, load_gears
from gearmesh.app.terminal import refuse_unwritable, show, tolerance_in_mm, warn, working
from gearmesh.errors import ArgumentError, OutputError
from gearmesh.lengths import in_mm

if TYPE_CHECKING:
    from gearmesh import Gears
    from gearmesh.answers.bodies.cad import Cad
    from gearmesh.answers.bodies.section import Section
    from gearmesh.answers.bodies.solid import Solid, Solids

#: what --member takes beside the names of the members
BOTH, WORM = "both", "worm"


def solid(
    design_file: DesignFile,
    member: Annotated[
        str,
        typer.Option(
            "--member",
            metavar="pinion|gear|both|worm",
            help="Which gear, or both in mesh; worm: the grinding worm of the pinion or face gear.",
            show_default=False,
        ),
    ],
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="FILE", help="File to write; its suffix is the format.")
    ],
    tol: Annotated[
        str | None,
        typer.Option(
            "--tol",
            metavar="LEN",
            help="Largest distance from the exact surface: 10um, 0.01mm, 0.0004in; bare = mm. "
            "[default: the design's for a mesh, 0.1um for .step, .dxf, .svg]",
        ),
    ] = None,
    section: Annotated[
        str | None,
        typer.Option(
            "--section",
            metavar="Z",
            help="Position of the section of .dxf and .svg along the axis: 5mm, -0.1in; bare = mm. [default: mid face]",
        ),
    ] = None,
    curves: Annotated[
        str | None,
        typer.Option(
            "--curves",
            metavar="splines|arcs|polyline",
            help="What flanks and fillets of .dxf and .svg are drawn with; with arcs and polyline a .dxf has one closed polyline "
            "for every contour. [default: splines]",
        ),
    ] = None,
    offset: Annotated[
        str | None,
        typer.Option(
            "--offset",
            metavar="LEN",
            help="Distance of the contours of .dxf and .svg from the section, positive away from the material: wire radius and "
            "spark gap, 0.135mm; bare = mm. [default: 0]",
        ),
    ] = None,
    teeth: Annotated[int | None, typer.Option("--teeth", metavar="K", help="Only the first K teeth.")] = None,
    settings: Set = None,
) -> None:
    """One gear or its grinding worm, or both gears in mesh, as watertight meshes or CAD solids; or a section of one."""
    from gearmesh import io
    from gearmesh.answers.bodies.section import SUFFIXES as SECTIONS
    from gearmesh.cad.dxf import SUFFIX as DXF
    from gearmesh.cad.dxf import require_ezdxf
    from gearmesh.cad.step import SUFFIXES

    suffix = output.suffix.lower()
    known = (*io.formats(), *SUFFIXES, *SECTIONS)
    if suffix not in known:
        raise OutputError("cannot write", output, reason=f"its suffix must be one of {', '.join(known)}")
    if member == BOTH and suffix not in (*io.formats(several=True), *SUFFIXES):
        raise ArgumentError(
            "member",
            "both",
            reason=f"{suffix} holds one part; for both use {', '.join((*io.formats(several=True), *SUFFIXES))}",
        )
    for name, value in (("section", section), ("curves", curves), ("offset", offset)):
        if value is not None and suffix not in SECTIONS:
            raise ArgumentError(
                name, value, must_be=f"left out for {suffix}; formats of sections are {', '.join(SECTIONS)}"
            )
    if suffix == DXF:
        require_ezdxf()
    refuse_unwritable(output)
    tolerance, z = tolerance_in_mm(tol), _place_in_mm(section)
    away = 0.0 if offset is None else in_mm("--offset", offset)
    gears = load_alone(design_file, settings) if member not in (BOTH, WORM) else load_gears(design_file, settings)
    _refuse_member(gears, member)
    if teeth is not None:
        _refuse_teeth(gears, member, suffix, teeth, suffix in (*SUFFIXES, *SECTIONS))
    with working(f"solid of the {member}" if member != BOTH else "solids"):
        made: Cad | Section | Solid | Solids
        if suffix in SECTIONS:
            made = gears.section(member, z, tolerance, curves=curves or "splines", offset=away)
        elif suffix in SUFFIXES:
            made = gears.cad(None if member == BOTH else member, tolerance)
        else:
            made = (
                gears.solids(tolerance, file=output)
                if member == BOTH
                else gears.solid(member, tolerance, teeth=teeth, file=output)
            )
        made.save(output)
    show(made.listings)
    warn(made.warnings, made.complaints)


def _place_in_mm(text: str | None) -> float | None:
    """Where a section is asked for, in mm, None where it is not said."""
    return None if text is None else in_mm("--section", text)


def _refuse_member(gears: Gears, member: str) -> None:
    allowed = [*gears.members, BOTH, *([] if WORM in gears.members else [WORM])]
    if member not in allowed:
        raise ArgumentError("member", member, must_be=f"one of {', '.join(allowed)}")


def _refuse_teeth(gears: Gears, member: str, suffix: str, teeth: int, whole: bool) -> None:
    """Refuse --teeth where the part is made whole, or has not so many."""
    if whole:
        raise ArgumentError("teeth", teeth, must_be=f"left out for {suffix}, which holds whole gears")
    if member not in gears.members:
        raise ArgumentError("teeth", teeth, must_be=f"left out for --member = {member}, which is always made whole")
    most = gears.members[member].tooth.teeth
    if not 1 <= teeth <= most:
        raise ArgumentError("teeth", teeth, must_be=f"a whole number from 1 to {most}")
