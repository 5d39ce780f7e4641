"""Pictures of gears by the name of their view: the answers that each picture needs, and the functions that draw it.

Pictures of a tooth load no module for whole solids, for their checks, or for diagrams.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.answers.contact.contact import Contact
from gearmesh.answers.gearset import position_list
from gearmesh.answers.questions import SolvedGears
from gearmesh.errors import ArgumentError, NoSolutionError
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.systems.system import ToolPart
from gearmesh.teeth.blank.features import BodyFeatures
from gearmesh.teeth.gear_train import GearPair, Member
from gearmesh.teeth.region import Side
from gearmesh.view import pictures
from gearmesh.view.picture import (
    COMPOUND_LOOK,
    COMPOUND_VIEWS,
    FIGURE_VIEWS,
    MAX_SIDE_PIXELS,
    MIN_SIDE_PIXELS,
    MOVING_VIEWS,
    PICTURE_LOOKS,
    PICTURE_VIEWS,
    PLAIN_LOOK,
    Animation,
    Diagram,
    Picture,
    refuse_member,
)

if TYPE_CHECKING:
    from gearmesh.answers.contact.rolling import RollingContact
    from gearmesh.answers.contact.zone import ZoneOfContact
    from gearmesh.view.mesh_section import MeshSection

#: views that need no mating gear
VIEWS_WITHOUT_MATE = ("pair", "tool", "contact_lines")
#: views that show no position of the mesh, by what they show
VIEWS_WITHOUT_POSITION = {
    "tool": "how a tooth is generated",
    "contact_lines": "how a tooth is generated",
    "backlash": "backlash over a whole pitch",
    "turns": "whole turns",
}
#: name of the worm that grinds a member, where names of members are given
WORM_NAME = "worm"

#: smallest resolution of diagrams, pixels per inch
MIN_DPI = 20
#: largest resolution of diagrams, pixels per inch
MAX_DPI = 1200


def picture(
    gears: SolvedGears,
    view: str,
    member: str | None,
    phi1: ArrayLike | None,
    size: tuple[int, int] | None,
    pair: int | str,
    dpi: int,
    note: str,
    look: str = PLAIN_LOOK,
) -> Picture | Diagram:
    """Return a picture of gears alone, as `Gears.picture` describes it."""
    if view not in PICTURE_VIEWS:
        raise ArgumentError("view", view, must_be=f"one of {', '.join(PICTURE_VIEWS)}")
    refuse_look(look, view)
    if size is not None:
        refuse_size(size)
    if not MIN_DPI <= dpi <= MAX_DPI:
        raise ArgumentError("dpi", dpi, must_be=f"a whole number from {MIN_DPI} to {MAX_DPI}")
    if phi1 is not None:
        position_list(phi1)
    if view in VIEWS_WITHOUT_MATE and not gears.names.pairs:
        shown = VIEWS_WITHOUT_POSITION.get(view, "gears that do not mesh")
        _refuse_position(view, phi1, shown)
        return _picture_alone(
            gears, view, member, size or pictures.PICTURE_SIZE, gears.title + (f", {note}" if note else "")
        )
    if not gears.names.pairs:
        lacking = gears.names.lacking
        raise ArgumentError(
            "view",
            view,
            reason=f"needs a mating gear: add the table [{lacking}]",
            allowed=", ".join(VIEWS_WITHOUT_MATE),
        )
    names = gears.names.pairs[gears.names.pair_number(pair)]
    grinding = view == "tool" and member == WORM_NAME and WORM_NAME not in names
    if member not in (None, *names) and not grinding:
        raise ArgumentError("member", member, must_be=f"one of {', '.join(names)}")
    mesh = gears.pair(pair)
    name = mesh.pinion.name if member is None else member
    worm = gears.part(name) if (view, name) == ("tool", WORM_NAME) and name not in mesh.members else None
    if worm is not None:
        name = worm.ground
    title = gears.title + (f", {note}" if note else "")
    if view in VIEWS_WITHOUT_POSITION:
        _refuse_position(view, phi1, VIEWS_WITHOUT_POSITION[view])
    refuse_member(view, member)
    if view in ("tool", "contact_lines"):
        tool_member, side = mesh.members[name], mesh.flanks[mesh.index(name)]
        return _tool_picture(gears, view, tool_member, side, worm, size or pictures.PICTURE_SIZE, title)
    contact = gears.contact(phi1, cycle=view in ("te", "backlash"), turns=view == "turns", pair=pair)
    path = contact.path
    if not path.touching.any():
        raise NoSolutionError(reason="no contact at any position shown", remedy="choose another phi1")
    if view in FIGURE_VIEWS:
        return _figure(view, contact, None if member is None else (name,), title, size, dpi)
    size = size or pictures.PICTURE_SIZE
    # if positions are given, only these are shown
    whole = contact.whole if phi1 is None and view in ("contact", "pattern", "gap") else None
    if view == "contact":
        return Picture(pictures.contact_picture(mesh, name, path, size, title=title, whole=whole))
    if view == "pattern":
        return Picture(pictures.pattern_picture(mesh, name, path, size, title=title, whole=whole, look=look))
    if view == "gap":
        from gearmesh.answers.check import roll_test

        patches = roll_test(mesh, path).patches(mesh, name)
        return Picture(pictures.gap_picture(mesh, name, path, patches, size, title=title, whole=whole, look=look))
    if view == "pair" and (len(gears.pairs) > 1 or gears.names.carried):
        from gearmesh.answers.bodies.solid import solids_of

        at = 0.0 if phi1 is None else float(position_list(phi1)[0])
        placed = {name: part.mesh for name, part in solids_of(gears, gears.within(None), phi1=at).parts.items()}
        return Picture(pictures.set_picture(mesh, placed, size, title))
    if view == "section":
        from gearmesh.answers.contact.rolling import rolling_contact

        return Picture(_section(gears, mesh, rolling_contact(mesh, path), size, title).scenes()[0])
    meshes = _meshes(gears, mesh)
    return Picture(pictures.pair_picture(mesh, meshes, path, size, title))


def animation(
    gears: SolvedGears,
    view: str,
    member: str | None,
    phi1: ArrayLike | None,
    size: tuple[int, int],
    pair: int | str,
    note: str,
    look: str = PLAIN_LOOK,
) -> Animation:
    """Return a mesh that rolls through one pitch, or contact that rolls over a tooth, as `Gears.animation` describes."""
    from gearmesh.answers.contact.rolling import rolling_contact
    from gearmesh.view import motion

    if view not in MOVING_VIEWS:
        raise ArgumentError("view", view, must_be=f"one of {', '.join(MOVING_VIEWS)}")
    refuse_look(look, view)
    refuse_size(size)
    if phi1 is not None:
        position_list(phi1)
    mesh = gears.pair(pair)
    if member not in (None, *mesh.members):
        raise ArgumentError("member", member, must_be=f"one of {', '.join(mesh.members)}")
    refuse_member(view, member)
    path = gears.contact(phi1, cycle=False, pair=pair).path
    title = gears.title + (f", {note}" if note else "")
    if view in ("section", "pair"):
        rolling = rolling_contact(mesh, path, np.arange(motion.FRAMES_PER_PITCH) / motion.FRAMES_PER_PITCH)
        if view == "section":
            return Animation(tuple(_section(gears, mesh, rolling, size, title).scenes()))
        # keyways and holes are not alike after one pitch
        meshes = _meshes(gears, mesh, featured=False)
        what = f"{title}: {' and '.join(mesh.members)}" if len(gears.pairs) > 1 else f"{title}: pair in mesh"
        return Animation(tuple(motion.turning_scenes(rolling, meshes, size, what)))
    rolling = rolling_contact(mesh, path, np.arange(motion.POSITIONS_PER_PITCH) / motion.POSITIONS_PER_PITCH)
    name = mesh.pinion.name if member is None else member
    scenes = pictures.rolling_scenes(mesh, name, rolling.contacts, view, size, title, look)
    return Animation(tuple(scenes), _hold=view == "pattern")


def refuse_look(look: str, view: str) -> None:
    """Raise ArgumentError for an unknown look, and for marking compound in a view that has no pattern."""
    if look not in PICTURE_LOOKS:
        raise ArgumentError("look", look, must_be=f"one of {', '.join(PICTURE_LOOKS)}")
    if look == COMPOUND_LOOK and view not in COMPOUND_VIEWS:
        reason = f"is for the views {', '.join(COMPOUND_VIEWS)}; the view is {view}"
        raise ArgumentError("look", look, reason=reason)


def refuse_size(size: tuple[int, int]) -> None:
    """Raise ArgumentError for a size (pixels) outside the limits of pictures."""
    if not all(MIN_SIDE_PIXELS <= side <= MAX_SIDE_PIXELS for side in size):
        must_be = f"width and height in pixels, each from {MIN_SIDE_PIXELS} to {MAX_SIDE_PIXELS}"
        raise ArgumentError("size", list(size), must_be=must_be)


def _refuse_position(view: str, phi1: ArrayLike | None, shown: str) -> None:
    """Raise ArgumentError for a position in a view that shows something else."""
    if phi1 is not None:
        raise ArgumentError(
            "phi1", phi1, reason=f"the view {view} shows {shown}, not a position of the mesh; leave phi1 out"
        )


def _picture_alone(gears: SolvedGears, view: str, member: str | None, size: tuple[int, int], title: str) -> Picture:
    """Return the picture of a member without a mating gear, or of its right flank with the generating tool."""
    shown_member = gears.member(next(iter(gears.members)) if member is None else member)
    if view == "pair":
        from gearmesh.answers.bodies.solid import mesh_within

        made, _, _ = mesh_within(shown_member, gears.within(None))
        placed = {shown_member.name: made.facets.whole().move(gears.places[shown_member.name])}
        return Picture(pictures.members_picture(placed, shown_member.mount.axis, size, title))
    return _tool_picture(gears, view, shown_member, Side.RIGHT, None, size, title)


def _tool_picture(
    gears: SolvedGears,
    view: str,
    member: Member,
    side: Side,
    worm: ToolPart | None,
    size: tuple[int, int],
    title: str,
) -> Picture:
    """Return the picture of a member with its generating tool or its `worm`, or of their lines of contact."""
    if view == "contact_lines":
        return Picture(pictures.tool_contact_picture(member, side, size, title))
    from gearmesh.mesh.solid import gear_solid
    from gearmesh.teeth.generation.tool_in_place import tool_in_place

    name, tooth = member.name, member.tooth if worm is None or worm.tooth is None else worm.tooth
    tool, part = tool_in_place(tooth, side), None
    if worm is not None and not tool.as_part:
        raise ArgumentError(
            "member",
            WORM_NAME,
            reason=f"the {name} is generated by a {tool.name}, not by a worm; give the member {name}",
        )
    if tool.as_part:
        worm = worm or gears.part(WORM_NAME)
        assert worm.own_to_tool is not None
        part = gear_solid(worm.member, pictures.WHOLE_TOLERANCE_MM).move(worm.own_to_tool)
    return Picture(pictures.tool_picture(member, side, tool, part, size, title))


def _section(
    gears: SolvedGears, mesh: GearPair, rolling: RollingContact, size: tuple[int, int], title: str
) -> MeshSection:
    """Return the section through a mesh, fine enough to hide facets; its title names the mesh if there are several."""
    from gearmesh.view.mesh_section import facet, mesh_section

    what = f"section of the mesh {mesh.name}" if len(gears.pairs) > 1 else "section"
    finest = min(gears.within(None), facet(mesh, size))
    return mesh_section(rolling, _meshes(gears, mesh, finest), size, f"{title}: {what}")


def _meshes(
    gears: SolvedGears, mesh: GearPair, tolerance: float | None = None, featured: bool = True
) -> dict[str, TriangleMesh]:
    """Return the meshes of both members of a pair, own frames, within a tolerance (mm; by default the design's).

    They have no shafts, hubs, keyways and holes unless they are `featured`.
    """
    from gearmesh.mesh.solid import gear_solid
    from gearmesh.teeth.micro_geometry.placed_teeth import placed_teeth

    within = gears.within(tolerance)
    members = {
        name: member if featured else replace(member, features=BodyFeatures()) for name, member in mesh.members.items()
    }
    return {name: gear_solid(placed_teeth(member), within, lean=False) for name, member in members.items()}


def _figure(
    view: str,
    contact: Contact,
    names: tuple[str, ...] | None,
    title: str,
    size: tuple[int, int] | None,
    dpi: int,
) -> Diagram:
    from gearmesh.view.diagrams.flank_diagrams import plot_flanks
    from gearmesh.view.diagrams.plots import plot_backlash, plot_transmission_error
    from gearmesh.view.diagrams.turns_plot import plot_turns

    unit, path = contact.pair.output.reading.error, contact.path
    if view == "te":
        what = f"{title}: transmission error"
        return Diagram(what, lambda file: plot_transmission_error(file, path, contact.cycle, what, unit, size, dpi))
    if view == "backlash":
        what = f"{title}: backlash"
        return Diagram(what, lambda file: plot_backlash(file, contact.backlash(), what, size, dpi))
    if view == "zone":
        from gearmesh.view.diagrams.zone_diagram import plot_zone

        what = f"{title}: zone of contact"
        return Diagram(what, lambda file: plot_zone(file, _zone(contact), what, size, dpi))
    if (turns := contact.turns) is not None:
        what = f"{title}:\ntransmission error over whole turns"
        return Diagram(what, lambda file: plot_turns(file, turns, what, unit, size, dpi))
    what = f"{title}: {'sliding' if view == 'sliding' else 'contact'} on the flanks"
    return Diagram(
        what, lambda file: plot_flanks(file, pictures.flank_rows(contact, names, view == "sliding"), what, size, dpi)
    )


def _zone(contact: Contact) -> ZoneOfContact:
    """Return the zone of contact of a pair, with all tooth pairs at the middle one of the positions with contact."""
    from gearmesh.answers.contact.rolling import rolling_contact
    from gearmesh.answers.contact.zone import zone_of_contact

    pair, whole = contact.pair, contact.whole
    if whole is None:
        raise NoSolutionError(reason="the flanks never meet", remedy="reduce the assembly errors")
    rolling = rolling_contact(pair, contact.path)
    return zone_of_contact(pair, whole, rolling.contacts, float(rolling.phi1[0]))
