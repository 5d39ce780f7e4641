"""The pictures and plots of a gear pair: which meshes a picture needs, and how finely; drawing is left to the renderer.

A flank picture meshes the tooth in contact finely and the rest coarsely.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.answers.contact.contact import Contact
from gearmesh.answers.contact.sides import SideContact
from gearmesh.contact.path import ContactPath
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.solid import gear_solid, teeth_mesh
from gearmesh.mesh.tessellate import tessellate
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.blank.body import end_names
from gearmesh.teeth.blank.features import BodyFeatures
from gearmesh.teeth.gear_train import GearPair, Member
from gearmesh.teeth.region import Side
from gearmesh.view.projection import flank_projection
from gearmesh.view.scene import Scene, ToothView, contact_on
from gearmesh.view.views import flank_pixel, gap_scene, member_scene, pair_scene, pattern_scene, set_scene

if TYPE_CHECKING:
    from gearmesh.answers.bodies.solid import Solid
    from gearmesh.teeth.generation.tool_in_place import ToolInPlace
    from gearmesh.view.diagrams.flank_diagrams import ContactPanel, FieldPanel, Panel

#: width and height of a picture in pixels
Size = tuple[int, int]
SIZE = (1600, 1200)
#: tolerances of the tooth looked at, and of what surrounds it, in pixels of a picture of the tooth
FINE, COARSE = 0.25, 1.5
#: tolerance in these pixels up to which a solid that is there is shown: a pixel as it is drawn, before four of them are one
SHOWN_AT = 0.5
#: tolerance (mm) of whole members and tools, and points across and along a flank to know where it looks
WHOLE, TOOL_GRID = 0.05, (3, 3)
#: exact points across and along a flank on which patterns are drawn
PATTERN_GRID = (81, 161)
#: least range of ease-offs (um), more than the error of the table, and of velocities (m/s) that is shown
LEAST_EASE_OFF, LEAST_SPEED = 1.0, 0.01
#: from mm/rad to m/s at 1000 turns a minute
AT_1000_RPM = 1e-3 * 1000.0 * 2.0 * np.pi / 60.0


def contact_picture(
    pair: GearPair,
    name: str,
    path: ContactPath,
    size: Size = SIZE,
    view: ToothView | None = None,
    title: str = "",
    whole: ContactPath | None = None,
) -> Scene:
    """A member's tooth with the path of contact, of the `whole` engagement if given, and the contact ellipses (or lines) on it.

    `view`, of `tooth_view`, saves meshing the tooth again, here and in the other pictures of a tooth.
    """
    contact = contact_on(pair.index(name), path, pair.mounts, whole)
    shown = _contact_words(path, len(contact.along_lines))
    view = replace(view or tooth_view(pair, name), title=_title(title, f"{name}, {shown}"), size=size)
    return member_scene(view, contact)


def _contact_words(path: ContactPath, lines: int) -> str:
    """What a picture shows of contact that is along lines at so many of its positions."""
    return "lines of contact" if 2 * lines > np.count_nonzero(path.touching) else "path of contact"


def pattern_picture(
    pair: GearPair,
    name: str,
    path: ContactPath,
    size: Size = SIZE,
    view: ToothView | None = None,
    title: str = "",
    whole: ContactPath | None = None,
) -> Scene:
    """A member's tooth with its contact pattern as the union of the ellipses, of the `whole` engagement if given.

    Raises NoSolutionError where contact is along lines or on edges, which have no ellipses.
    """
    contact = contact_on(pair.index(name), path if whole is None else whole, pair.mounts)
    if not contact.ellipses.size:
        raise NoSolutionError(
            reason="no position has an ellipse of contact",
            remedy="the pattern by the roll test (gap) shows the contact",
        )
    view = replace(
        view or tooth_view(pair, name),
        title=_title(title, f"{name}, contact pattern, union of the ellipses"),
        size=size,
    )
    return pattern_scene(view, contact, _pattern_grid(pair, name))


def gap_picture(
    pair: GearPair,
    name: str,
    path: ContactPath,
    patches: list[tuple[Array, Array]],
    size: Size = SIZE,
    view: ToothView | None = None,
    title: str = "",
    whole: ContactPath | None = None,
) -> Scene:
    """A member's tooth with the gaps that the roll test found: `patches` of points in its own frame and gaps, mm."""
    contact = contact_on(pair.index(name), path, pair.mounts, whole)
    view = replace(
        view or tooth_view(pair, name),
        title=_title(title, f"{name}, contact pattern, roll test of the meshes"),
        size=size,
    )
    return gap_scene(view, contact, _pattern_grid(pair, name), patches, pair.delta)


def pair_picture(
    pair: GearPair, meshes: dict[str, TriangleMesh], path: ContactPath, size: Size = SIZE, title: str = ""
) -> Scene:
    """Both members in mesh, at the middle position with contact."""
    k = _middle(path)
    first, second = (meshes[name] for name in pair.members)
    return pair_scene(
        first, second, pair, (float(path.rotation[k]), float(path.phi2[k])), _title(title, "pair in mesh"), size
    )


def set_picture(gears: GearPair, placed: dict[str, TriangleMesh], size: Size = SIZE, title: str = "") -> Scene:
    """All members of a gear set of several meshes, of which `gears` is the first, in the fixed frame."""
    return set_scene(placed, gears.pinion.mount.axis, _title(title, "gears in mesh"), size)


def members_picture(placed: dict[str, TriangleMesh], axis: Array, size: Size = SIZE, title: str = "") -> Scene:
    """Members that mesh with none, in the fixed frame, seen along an `axis` (3,)."""
    return set_scene(placed, axis, _title(title, ", ".join(placed)), size)


def tool_picture(
    member: Member, side: Side, tool: ToolInPlace, part: TriangleMesh | None, size: Size = SIZE, title: str = ""
) -> Scene:
    """A member with the tool that generates a flank of it, or the mesh `part` of that tool, in the tool's frame."""
    from gearmesh.view.tools.tool_scene import tool_scene

    s, t = (np.linspace(0.0, 1.0, n) for n in TOOL_GRID)
    plain = replace(member, features=BodyFeatures())
    shown = f"{member.name}, {side} flank, and its {tool.name}"
    grid = member.tooth.flank_grid(side, s, t).points
    return tool_scene(gear_solid(plain, WHOLE), tool, grid, part, _title(title, shown), size)


def tool_contact_picture(member: Member, side: Side, size: Size = SIZE, title: str = "") -> Scene:
    """The tool that generates a flank of a member and the tooth as it leaves it, with their lines of contact."""
    from gearmesh.teeth.generation.contact_lines import tool_contact
    from gearmesh.view.tools.tool_contact import tool_contact_scene

    name, tooth = member.name, member.tooth.unmodified_tooth
    contact = tool_contact(tooth, side)
    s, t = (np.linspace(0.0, 1.0, n) for n in TOOL_GRID)
    fine = FINE * flank_pixel(tooth.flank_grid(side, s, t).points, SIZE)
    mesh = teeth_mesh(tessellate(tooth, fine, lean=False), name, np.array([0]))
    shown = f"{name} and its {contact.name}, {side} flank: lines of contact"
    return tool_contact_scene(contact, mesh, _title(title, shown), size)


def _title(title: str, what: str) -> str:
    return f"{title}: {what}" if title else what


def all_pictures(
    pair: GearPair,
    path: ContactPath,
    patches: list[tuple[Array, Array]],
    meshes: dict[str, TriangleMesh],
    title: str = "",
    teeth: ToothViews | None = None,
    whole: ContactPath | None = None,
) -> dict[str, Scene]:
    """Scenes by file name: both members with their contact, the pinion's pattern by ellipses and by the roll test, the pair.

    Contact along lines or on edges has no ellipses, and no picture of their union; the roll test shows its pattern. `teeth` saves
    meshing teeth again that other pictures show; `whole` is the contact of the whole engagement.
    """
    first, teeth = pair.pinion.name, teeth or ToothViews()
    views = {name: teeth.of(pair, name) for name in pair.members}
    scenes = {
        f"{name}_contact.png": contact_picture(pair, name, path, view=view, title=title, whole=whole)
        for name, view in views.items()
    }
    if contact_on(0, path, pair.mounts).ellipses.size:
        scenes[f"{first}_pattern.png"] = pattern_picture(pair, first, path, view=views[first], title=title, whole=whole)
    if patches:
        scenes[f"{first}_gap.png"] = gap_picture(
            pair, first, path, patches, view=views[first], title=title, whole=whole
        )
    scenes["pair.png"] = pair_picture(pair, meshes, path, title=title)
    return scenes


def plots(contact: Contact, te_file: Path, path_file: Path, title: str = "") -> list[list[Panel]]:
    """TE over the positions with the whole mesh cycle, and the contact on both driving flanks.

    Returns the panels of both sides, to be drawn as they are; none where there is no cycle.
    """
    from gearmesh.view.diagrams.flank_diagrams import plot_flanks

    plot_errors(contact, te_file, title)
    rows = all_flank_rows(contact)
    plot_flanks(path_file, driving_flanks(contact, rows), f"{title}: path of contact" if title else "path of contact")
    return rows


def plot_errors(contact: Contact, file: Path, title: str = "") -> None:
    """TE over the positions with the whole mesh cycle."""
    from gearmesh.view.diagrams.plots import plot_transmission_error

    # the cycle of eccentric members is that of members that stay displaced: their path is another
    cycle, what = None if contact.pair.eccentric else contact.cycle, "transmission error"
    plot_transmission_error(
        file, contact.path, cycle, f"{title}: {what}" if title else what, contact.pair.output.reading.error
    )


def all_flank_rows(contact: Contact) -> list[list[Panel]]:
    """The panels of both sides; none where there is no cycle."""
    return flank_rows(contact) if contact.engagement is not None else []


def driving_flanks(contact: Contact, rows: list[list[Panel]]) -> list[list[Panel]]:
    """The panels of contact on the driving flanks of both members, those among the `rows` of both sides if there are any."""
    from gearmesh.view.diagrams.flank_diagrams import ContactPanel, beside

    gears = contact.pair
    driving = _first_side(rows) if rows else [flank_panel(gears, name, contact.path) for name in gears.members]
    return beside([panel for panel in driving if isinstance(panel, ContactPanel)])


def _first_side(rows: list[list[Panel]]) -> list[Panel]:
    """The panels of the driving side in what `flank_rows` gives."""
    from gearmesh.view.diagrams.flank_diagrams import is_long

    return [row[0] for row in rows] if is_long([rows[0][0].plane]) else rows[0]


def flank_panel(
    gears: GearPair,
    name: str,
    path: ContactPath,
    title: str | None = None,
    whole: ContactPath | None = None,
    nominal: Array | None = None,
) -> ContactPanel:
    """A member's flank in its plane with the contact of a path, and the pattern of a `whole` engagement, by default of the same.

    `nominal` (P, 3), own frame, is another path to compare with.
    """
    from gearmesh.view.diagrams.flank_diagrams import contact_panel
    from gearmesh.view.diagrams.flank_plane import FlankPlane

    index = gears.index(name)
    contact = contact_on(index, path, gears.mounts, whole)
    wholly = None if whole is None else contact_on(index, whole, gears.mounts)
    side = _side(gears, name)
    return contact_panel(
        FlankPlane.of(gears.members[name], side), contact, title or f"{name}, {side} flank", wholly, nominal
    )


def flank_rows(contact: Contact, names: tuple[str, ...] | None = None, sliding: bool = False) -> list[list[Panel]]:
    """Panels of both sides of a pair: contact on the flanks of members, and the ease-off or, `sliding`, the velocity of the pinion.

    Sides of long flanks are beside each other, of short ones above each other. Raises NoSolutionError where neither side meets.
    """
    from gearmesh.view.diagrams.flank_diagrams import is_long

    gears = contact.pair
    names = names or tuple(gears.members)
    sides = []
    for flanks_of_side in contact.sides:
        which = "driving" if flanks_of_side.driving else "coast side"
        panels: list[Panel] = [
            flank_panel(
                flanks_of_side.pair,
                name,
                flanks_of_side.path,
                f"{name}, {_side(flanks_of_side.pair, name)} flank: {which}",
                flanks_of_side.whole,
            )
            for name in names
        ]
        # a picture of sliding is one of whichever member
        if sliding or gears.pinion.name in names:
            panels.append(_field_panel(flanks_of_side, sliding))
        sides.append(panels)
    if not sides:
        raise NoSolutionError(reason="the flanks never meet", remedy="reduce the assembly errors")
    return [list(row) for row in zip(*sides, strict=True)] if is_long([sides[0][0].plane]) else sides


def _field_panel(side: SideContact, sliding: bool) -> FieldPanel:
    """Ease-off (um) or sliding velocity (m/s at 1000 rpm) over the pinion's flank."""
    from gearmesh.view.diagrams.flank_diagrams import FieldPanel
    from gearmesh.view.diagrams.flank_plane import FlankPlane

    pinion, ease_off = side.pair.pinion, side.ease_off
    name, plane = pinion.name, FlankPlane.of(pinion, side.pair.flanks[0])
    places = plane.frame.places(ease_off.points)
    if not sliding:
        return FieldPanel(
            f"{name}: ease-off (µm)",
            plane,
            places,
            1e3 * ease_off.distance,
            LEAST_EASE_OFF,
            continued=1e3 * ease_off.continued,
            beyond=ease_off.beyond,
            unit="µm",
        )
    velocity, further = (AT_1000_RPM * one for one in (side.sliding_velocity, side.continued_sliding_velocity))
    speed, arrows = np.linalg.norm(velocity, axis=-1), plane.frame.directions(ease_off.points, velocity)
    return FieldPanel(
        f"{name}: sliding velocity at 1000 rpm (m/s)",
        plane,
        places,
        speed,
        LEAST_SPEED,
        arrows,
        continued=np.linalg.norm(further, axis=-1),
        beyond=ease_off.beyond,
        unit="m/s",
        sense=f"velocity of the {name}'s flank relative to the {side.pair.gear.name}'s",
    )


def in_mesh(gears: GearPair, meshes: dict[str, TriangleMesh], path: ContactPath) -> dict[str, TriangleMesh]:
    """The members' meshes in the fixed frame at the middle position with contact."""
    k = _middle(path)
    turns = path.rotation[k], path.phi2[k]
    return {
        name: meshes[name].move(member.mount.at(turn))
        for (name, member), turn in zip(gears.members.items(), turns, strict=True)
    }


def _middle(path: ContactPath) -> int:
    touching = np.flatnonzero(path.touching)
    return int(touching[len(touching) // 2])


def _side(gears: GearPair, name: str) -> Side:
    return gears.flanks[gears.index(name)]


@dataclass(frozen=True)
class ToothViews:
    """Teeth of the members of a gear set to look at, each meshed once, however many pictures and meshes of the set show it.

    `solids`: those of members, by names, that are there already. One that is fine enough for pictures is not meshed again.
    """

    solids: Mapping[str, Solid] = field(default_factory=dict)
    meshes: dict[str, tuple[TriangleMesh, TriangleMesh]] = field(default_factory=dict)

    def of(self, gears: GearPair, name: str) -> ToothView:
        """A member's tooth, finely meshed, in front of the rest of its gear."""
        body = gears.members[name]
        grid, ends = _pattern_grid(gears, name), end_names(body.tooth.blank.axial)
        if name not in self.meshes:
            self.meshes[name] = _fine_and_rest(body, self.solids.get(name), flank_pixel(grid, SIZE))
        fine, rest = self.meshes[name]
        return ToothView(fine, flank_projection(body, _side(gears, name)), rest, grid, ends=ends)


def tooth_view(gears: GearPair, name: str) -> ToothView:
    """A member's tooth to look at, for one picture."""
    return ToothViews().of(gears, name)


def _fine_and_rest(body: Member, solid: Solid | None, pixel: float) -> tuple[TriangleMesh, TriangleMesh]:
    """The tooth on +x finely meshed, and the gear without it, coarsely: as a `solid` has them, or meshed for a picture whose pixels
    are so long (mm).

    Nobody keeps the triangles of a picture: they are not thinned.
    """
    if (
        solid is not None
        and solid.member is body
        and len(solid.teeth) == 1
        and solid.teeth[0].tolerance <= SHOWN_AT * pixel
    ):
        (tooth,) = solid.teeth
        fine, rough = tooth, tooth
    else:
        fine, rough = (tessellate(body.tooth, tolerance, lean=False) for tolerance in (FINE * pixel, COARSE * pixel))
    whole = gear_solid(replace(body, features=BodyFeatures()), rough.tolerance, rough)
    rest = replace(
        whole,
        triangles=whole.triangles[rough.triangles :],
        regions=whole.regions[rough.triangles :],
        normals=whole.normals[rough.triangles :],
    )
    return teeth_mesh(fine, body.name, np.array([0])), rest


def _pattern_grid(gears: GearPair, name: str) -> Array:
    s, t = (np.linspace(0.0, 1.0, n) for n in PATTERN_GRID)
    return gears.members[name].tooth.flank_grid(_side(gears, name), s, t).points
