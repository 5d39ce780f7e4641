"""The command `solid`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from gearmesh.app.options import Curves, DesignFile, Offset, Set, load_alone, load_gears, option, sector_option
from gearmesh.app.parts import ALL_MEMBERS, BOTH_MEMBERS, PartFile
from gearmesh.errors import ArgumentError

if TYPE_CHECKING:
    from gearmesh import Gears

#: value of --member for the grinding worm
WORM_MEMBER = "worm"


def solid(
    design_file: DesignFile,
    member: Annotated[
        str,
        option(
            "--member NAME|all|worm",
            "Which member, as pinion or gear; all (or both): all of them in mesh; worm: the grinding worm of the pinion or "
            "face gear.",
        ),
    ],
    output: Annotated[
        Path,
        option(
            "-o --output FILE",
            "File to write; its suffix is the format. With --member all, a folder: an STL file for each member.",
        ),
    ],
    tol: Annotated[
        str | None,
        option(
            "--tol LEN",
            "Largest distance from the exact surface: 10um, 0.01mm, 0.0004in; bare = mm. "
            "[default: the design's for a mesh, 0.1um for .step, .dxf, .svg]",
        ),
    ] = None,
    section: Annotated[
        str | None,
        option(
            "--section Z|axial",
            "Position of the section of .dxf and .svg along the axis: 5mm, -0.1in; bare = mm; axial: through the axis of a "
            "worm. [default: mid face]",
        ),
    ] = None,
    curves: Curves = None,
    dxf: Annotated[
        str | None,
        option(
            "--dxf VERSION",
            "Version of .dxf: R12, R2000, R2004, R2007, R2010, R2013, R2018; R12 has arcs or polylines. [default: R2000]",
        ),
    ] = None,
    offset: Offset = None,
    teeth: Annotated[int | None, option("--teeth K", "Only the first K teeth.")] = None,
    flank_only: Annotated[
        str | None,
        option(
            "--flank-only right|left|both",
            "Only these flanks, as open surfaces for metrology; .ply and .vtp have normals and parameters at every vertex.",
        ),
    ] = None,
    space: Annotated[
        bool,
        option(
            "--space",
            "The space between two teeth as a solid: for a broach or an electrode; double helical gears: the space of one half.",
        ),
    ] = False,
    blank: Annotated[
        bool,
        option(
            "--blank",
            "The blank before its teeth are cut: turned up to the tips, with hubs, bore and web, without keyway and holes; "
            ".dxf and .svg: its half section with the axis.",
        ),
    ] = False,
    phi1: Annotated[
        float | None, option("--phi1 DEG", "Rotation of the pinion at which --member all is in mesh. [default: 0]")
    ] = None,
    sector: Annotated[
        int | None,
        sector_option("Only the first K pitches, closed by two congruent cut faces through the middles of roots."),
    ] = None,
    names: Annotated[
        Path | None,
        option(
            "--names FILE",
            "With .step: write a table of its faces too, .csv or .json: number, member, name, region, side, tooth, for "
            "programs that number faces and drop their names, as gmsh.",
        ),
    ] = None,
    settings: Set = None,
) -> None:
    """One gear or its grinding worm, or both gears in mesh, as watertight meshes or CAD solids; or a section of one; or the space
    between two teeth, flanks alone, a sector, or the blank."""
    file = PartFile(output, tol, section, curves, offset, teeth, flank_only, space, phi1, sector, names, blank, dxf)
    file.refuse(member)
    together = member in (BOTH_MEMBERS, ALL_MEMBERS, WORM_MEMBER)

    def ask(gears: Gears) -> object:
        _refuse_member(gears, member)
        if teeth is not None:
            _refuse_teeth(gears, member, file.suffix, teeth, file.is_whole)
        return [own.make(gears, name) for name, own in file.files(gears, member).items()]

    gears = load_gears(design_file, settings, ask) if together else load_alone(design_file, settings, ask, member)
    file.write(gears, member)


def _refuse_member(gears: Gears, member: str) -> None:
    from gearmesh.systems.system import system_of

    ground = system_of(gears.design).worm is not None
    names = gears.names.members
    allowed = [
        *names,
        *gears.names.carried,
        BOTH_MEMBERS,
        ALL_MEMBERS,
        *([WORM_MEMBER] if ground and WORM_MEMBER not in names else []),
    ]
    if member not in allowed:
        raise ArgumentError("member", member, must_be=f"one of {', '.join(allowed)}")


def _refuse_teeth(gears: Gears, member: str, suffix: str, teeth: int, whole: bool) -> None:
    """Refuse --teeth for a part that is always whole, and more teeth than the part has."""
    if whole:
        raise ArgumentError("teeth", teeth, must_be=f"left out for {suffix}, which holds whole gears")
    if member not in gears.names.members:
        raise ArgumentError("teeth", teeth, must_be=f"left out for --member = {member}, which is always made whole")
    table = getattr(gears.design, gears.design.table_named(member), None)
    most = getattr(table, "threads", 0) or getattr(table, "teeth", 0) or gears.member(member).tooth.teeth
    if not 1 <= teeth <= most:
        raise ArgumentError("teeth", teeth, must_be=f"a whole number from 1 to {most}")
