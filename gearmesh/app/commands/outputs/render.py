"""The command `render`."""

from __future__ import annotations

import math
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from gearmesh.app.options import DesignFile, Pair, Set, chosen_pair, load_gears, option, torques_in_nm
from gearmesh.app.terminal import picture_size, refuse_unwritable, warn, working
from gearmesh.errors import ArgumentError
from gearmesh.formats import DIAGRAM_SUFFIXES, GIF_SUFFIX, MP4_SUFFIX, PNG_SUFFIX, refuse_suffix
from gearmesh.progress import Progress, part, silent
from gearmesh.view.opengl import begin_drawing

if TYPE_CHECKING:
    from gearmesh import Gears
    from gearmesh.view.picture import Animation, Diagram, Picture


class View(StrEnum):
    """View of a picture."""

    contact = "contact"
    pattern = "pattern"
    gap = "gap"
    pair = "pair"
    section = "section"
    tool = "tool"
    contact_lines = "contact_lines"
    flank = "flank"
    sliding = "sliding"
    zone = "zone"
    te = "te"
    backlash = "backlash"
    turns = "turns"
    toolpath = "toolpath"
    loaded = "loaded"
    loaded_flank = "loaded_flank"
    loaded_te = "loaded_te"
    loaded_share = "loaded_share"
    loaded_stress = "loaded_stress"
    loaded_pair = "loaded_pair"


class Look(StrEnum):
    """Look of a pattern."""

    plain = "plain"
    compound = "compound"


#: views of contact under torque
LOADED_VIEWS = (View.loaded, View.loaded_flank, View.loaded_te, View.loaded_share, View.loaded_stress, View.loaded_pair)
#: views that are diagrams
DIAGRAM_VIEWS = (View.flank, View.sliding, View.zone, View.te, View.backlash, View.turns, *LOADED_VIEWS[1:])
#: views that --look compound is for
COMPOUND_VIEWS = (View.pattern, View.gap)
#: views that --animate can show
MOVING_VIEWS = (View.section, View.pair, View.contact, View.pattern)
#: value of --member for the grinding worm
WORM_MEMBER = "worm"
#: default of --scallop
DEFAULT_SCALLOP = "10um"
#: share of the work on a picture of contact under load that solves the contact
LOADED_SHARE = 0.9
#: width and height of an animation, pixels
ANIMATION_SIZE = (640, 480)
#: suffixes of pictures (False) and of diagrams (True)
PICTURE_SUFFIXES = {False: (PNG_SUFFIX,), True: DIAGRAM_SUFFIXES}


def render(
    design_file: DesignFile,
    output: Annotated[
        Path | None,
        option(
            "-o --output FILE.(png|svg|pdf)",
            "Picture to write; svg and pdf of flank, sliding, zone, te, backlash, turns, loaded_*.",
            show_default=False,
        ),
    ] = None,
    view: Annotated[
        View | None,
        option(
            "--view",
            "contact: path and ellipses on a tooth; pattern: the union of the ellipses; gap: the pattern by the roll test; "
            "pair: the gears in mesh; section: a section across the teeth; tool: a member with its tool; contact_lines: contact "
            "lines of the tool on the tooth that it generates; flank, sliding: ease-off and sliding velocity on flank planes; "
            "zone: contact lines of all tooth pairs on the flanks and in the plane of action, with limit lines; te, turns: "
            "transmission error, over a mesh cycle and over whole turns of eccentric members; backlash: over a mesh cycle; "
            "toolpath: passes of the ball-end cutter --tool in a space of --member. With --torque: loaded: largest pressures on a "
            "tooth; loaded_*: pressures on flank planes, transmission error, load sharing, root stress. "
            "[default: contact; section for --animate alone]",
            show_default=False,
        ),
    ] = None,
    member: Annotated[
        str | None,
        option(
            "--member NAME",
            "Member whose tooth to show; worm, in the view tool: the grinding worm. [default: pinion; all on flank planes]",
            show_default=False,
        ),
    ] = None,
    phi1: Annotated[float | None, option("--phi1 DEG", "One position. [default: the design's]")] = None,
    torque: Annotated[
        str | None,
        option("--torque NM[,NM...]", "Torques on the pinion, for the views loaded_*; one torque for the view loaded."),
    ] = None,
    tool: Annotated[
        str | None,
        option("--tool ball:D[,L[,H]]", "Ball-end cutter of the view toolpath, as for `toolpath`."),
    ] = None,
    scallop: Annotated[
        str | None,
        option("--scallop LEN", "Height that the cutter may leave over the exact surfaces. [default: 10um]"),
    ] = None,
    pair: Pair = None,
    size: Annotated[
        str | None,
        option(
            "--size WxH", "Width and height in pixels. [default: 1600x1200, or what a figure needs]", show_default=False
        ),
    ] = None,
    dpi: Annotated[
        int,
        option(
            "--dpi", "Resolution of figures, in pixels per inch; less where --size has little room.", min=20, max=1200
        ),
    ] = 150,
    look: Annotated[
        Look,
        option(
            "--look",
            "Look of the views pattern and gap. compound: teeth painted with marking compound, rubbed off where they touch.",
        ),
    ] = Look.plain,
    animate: Annotated[
        Path | None,
        option(
            "--animate FILE.(gif|mp4)",
            "Animate the view section, pair, contact or pattern: the mesh through one pitch, or contact that rolls over a "
            "tooth; mp4 by the program ffmpeg.",
        ),
    ] = None,
    settings: Set = None,
) -> None:
    """A picture of the contact on a tooth, of the gears in mesh, of a member with its tool, or an animation of the mesh."""
    pixels = None if size is None else picture_size(size)
    if view is None:
        view = View.contact if output is not None or animate is None else View.section
    if output is None and animate is None:
        raise ArgumentError("output", reason="name a file for the picture, or for an animation with --animate")
    if output is not None:
        refuse_suffix(output, *PICTURE_SUFFIXES[view in DIAGRAM_VIEWS])
    if animate is not None:
        from gearmesh.view.animation import refuse_file

        refuse_suffix(animate, GIF_SUFFIX, MP4_SUFFIX)
        refuse_file(animate)
        _refuse_still(view, animate)
    for target in (output, animate):
        refuse_unwritable(target)
    if phi1 is not None and not math.isfinite(phi1):
        raise ArgumentError("phi1", phi1, must_be="a finite number of degrees")
    torques = _torques(view, torque)
    _refuse_for_path(view, tool, scallop)
    if look == Look.compound and view not in COMPOUND_VIEWS:
        raise ArgumentError("look", look, reason=f"is for the views {', '.join(COMPOUND_VIEWS)}; --view is {view}")
    if output is None or view not in DIAGRAM_VIEWS:
        begin_drawing()
    # the note leaves out settings of meshes, which change nothing visible, and the name, which the picture shows anyway
    note = ", ".join(text for text in settings or () if not text.startswith(("mesh.", "name=")))

    def mesh_and_names(gears: Gears) -> tuple[str | int, tuple[str, ...]]:
        """Return the pair and its members, or all members of a design without pairs."""
        if not gears.names.pairs:
            return 0, gears.names.members
        return chosen_pair(gears, pair), gears.names.pairs[gears.names.pair_number(chosen_pair(gears, pair))]

    def picture(gears: Gears, told: Progress = silent) -> tuple[Picture | Diagram, tuple[str, ...]]:
        """Return the picture and its warnings; the stages of contact under load are told."""
        mesh, names = mesh_and_names(gears)
        if torques:
            loaded = gears.loaded_contact(
                torques, phi1, pair=mesh, progress=lambda done, doing: told(LOADED_SHARE * done, doing)
            )
            told(LOADED_SHARE, "picture")
            shown = gears.picture(view.value, member, of=loaded, size=pixels, dpi=dpi, note=note)
            return shown, loaded.warnings
        if tool is not None:
            path = gears.toolpath(member or names[0], tool, scallop or DEFAULT_SCALLOP)
            return gears.picture(view.value, of=path, size=pixels, note=note), gears.warnings
        shown = gears.picture(
            view.value, member, phi1=phi1, size=pixels, pair=mesh, dpi=dpi, note=note, look=look.value
        )
        return shown, gears.warnings

    def animation(gears: Gears) -> Animation:
        return gears.animation(
            view.value,
            member,
            phi1=phi1,
            size=pixels or ANIMATION_SIZE,
            pair=mesh_and_names(gears)[0],
            note=note,
            look=look.value,
        )

    def ask(gears: Gears) -> object:
        _refuse_member(gears, view, member, mesh_and_names(gears)[1])
        return animation(gears) if output is None else picture(gears)

    gears = load_gears(design_file, settings, ask)
    told = gears.warnings
    with working("picture") as progress:
        if output is not None:
            with part(0.0, 0.4 if not torques and tool is None else 1.0):
                shown, told = picture(gears, progress)
            with part(0.4, 1.0):
                shown.save(output)
    if animate is not None:
        with working("animation"):
            with part(0.0, 0.2):
                moving = animation(gears)
            with part(0.2, 1.0):
                moving.save(animate)
    warn(told)


def _refuse_still(view: View, animate: Path) -> None:
    """Refuse an animation of a view that does not move."""
    if view not in MOVING_VIEWS:
        raise ArgumentError(
            "animate", animate, reason=f"is not for the view {view}; it is for {', '.join(MOVING_VIEWS)}"
        )


def _refuse_member(gears: Gears, view: View, member: str | None, names: tuple[str, ...]) -> None:
    """Refuse a member that is not in the pair, except for the grinding worm in the view of tools."""
    if member is not None and member not in (*names, *((WORM_MEMBER,) if view == View.tool else ())):
        raise ArgumentError("member", member, must_be=f"one of {', '.join(names)}")


def _refuse_for_path(view: View, tool: str | None, scallop: str | None) -> None:
    """Refuse options that exclude the view of tool paths, and options that need it."""
    if view == View.toolpath and tool is None:
        raise ArgumentError("tool", reason="missing; the view toolpath needs a cutter, as ball:3mm")
    for name, value in (("tool", tool), ("scallop", scallop)):
        if value is not None and view != View.toolpath:
            raise ArgumentError(name, value, reason=f"is for the view {View.toolpath}; --view is {view}")


def _torques(view: View, text: str | None) -> list[float]:
    """Return the torques of a view of loaded contact, none for other views. Raises ArgumentError for wrong combinations."""
    if view not in LOADED_VIEWS:
        if text is not None:
            raise ArgumentError("torque", text, reason=f"is for the views {', '.join(LOADED_VIEWS)}; --view is {view}")
        return []
    if text is None:
        raise ArgumentError("torque", reason=f"missing; the view {view} needs NM[,NM...] on the pinion")
    torques = torques_in_nm(text)
    if view == View.loaded and len(torques) > 1:
        raise ArgumentError("torque", text, must_be="one torque for the view loaded; loaded_flank takes several")
    return torques
