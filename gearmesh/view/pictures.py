"""Pictures and plots of a gear pair: the meshes that a picture needs, and their tolerances.

A flank picture meshes the tooth in contact finely and the rest coarsely. The renderer draws the scenes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import numpy as np

from gearmesh.answers.contact.contact import Contact
from gearmesh.answers.contact.sides import SideContact
from gearmesh.contact.path import ContactPath
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.solid import gear_solid, teeth_mesh
from gearmesh.mesh.tessellate import tessellate
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.records import dataclass
from gearmesh.teeth.blank.body import end_names
from gearmesh.teeth.blank.features import BodyFeatures
from gearmesh.teeth.gear_train import GearPair, Member
from gearmesh.teeth.kept_by_tooth import KeptByTooth
from gearmesh.teeth.region import Side
from gearmesh.view.on_tooth import closest_gap, union_level
from gearmesh.view.picture import COMPOUND_LOOK, PLAIN_LOOK
from gearmesh.view.projection import flank_projection
from gearmesh.view.scene import MemberContact, Scene, ToothView, contact_on
from gearmesh.view.views import (
    compound_scene,
    compound_share,
    flank_pixel,
    gap_scene,
    member_scene,
    pair_scene,
    pattern_scene,
    set_scene,
)

if TYPE_CHECKING:
    from gearmesh.mesh.tessellate import ToothMesh
    from gearmesh.teeth.generation.tool_in_place import ToolInPlace
    from gearmesh.view.diagrams.flank_diagrams import ContactPanel, FieldPanel, Panel

#: width and height of a picture in pixels
Size = tuple[int, int]
#: width and height of a picture, pixels
PICTURE_SIZE = (1600, 1200)
#: tolerance of the tooth in the middle of the picture, in pixels
FINE_TOLERANCE_PIXELS = 0.25
#: tolerance of the rest of the gear, in pixels
COARSE_TOLERANCE_PIXELS = 1.5
#: largest tolerance of an existing solid that is shown without meshing again; a drawn pixel, four of which make one of
#: the picture
REUSED_TOLERANCE_PIXELS = 0.5
#: tolerance of whole members and tools
WHOLE_TOLERANCE_MM = 0.05
#: points across and along a flank, from which its direction is found
TOOL_GRID = (3, 3)
#: words for a pattern of ellipses in titles, by its look
_PATTERN_WORDS = {PLAIN_LOOK: "union of the ellipses", COMPOUND_LOOK: "marking compound"}
#: words for a pattern of the roll test in titles, by its look
_GAP_WORDS = {PLAIN_LOOK: "roll test of the meshes", COMPOUND_LOOK: "marking compound at positions of the roll test"}
#: exact points across and along a flank on which patterns are drawn
PATTERN_GRID = (81, 161)
#: smallest range of an ease-off scale, larger than the error of the table
MIN_EASE_OFF_RANGE_UM = 1.0
#: smallest range of a scale of sliding velocity
MIN_SPEED_RANGE_M_S = 0.01
#: factor from mm/rad to m/s at 1000 rpm
AT_1000_RPM = 1e-3 * 1000.0 * 2.0 * np.pi / 60.0


def contact_picture(
    pair: GearPair,
    name: str,
    path: ContactPath,
    size: Size = PICTURE_SIZE,
    view: ToothView | None = None,
    title: str = "",
    whole: ContactPath | None = None,
) -> Scene:
    """Scene of a member's tooth with the path of contact and its contact ellipses or contact lines.

    `whole` is the path over the whole engagement, if it shall be drawn. `view`, of `tooth_view`, saves meshing the
    tooth again.
    """
    contact = contact_on(pair.index(name), path, pair.mounts, whole)
    shown = _contact_words(path, len(contact.along_lines))
    view = replace(view or tooth_view(pair, name), title=_title(title, f"{name}, {shown}"), size=size)
    return member_scene(view, contact)


def _contact_words(path: ContactPath, lines: int) -> str:
    """Name of the contact in a picture's title; `lines` is the number of positions with line contact."""
    return "lines of contact" if 2 * lines > np.count_nonzero(path.touching) else "path of contact"


def pattern_picture(
    pair: GearPair,
    name: str,
    path: ContactPath,
    size: Size = PICTURE_SIZE,
    view: ToothView | None = None,
    title: str = "",
    whole: ContactPath | None = None,
    look: str = PLAIN_LOOK,
) -> Scene:
    """Scene of a member's tooth with its contact pattern: the union of the ellipses, of the `whole` engagement if
    given.

    `look` is one of PICTURE_LOOKS. Raises NoSolutionError for contact along lines or on edges, which has no ellipses.
    """
    contact = contact_on(pair.index(name), path if whole is None else whole, pair.mounts)
    _refuse_lines(contact)
    view = replace(
        view or tooth_view(pair, name),
        title=_title(title, f"{name}, contact pattern, {_PATTERN_WORDS[look]}"),
        size=size,
    )
    grid = _pattern_grid(pair, name)
    if look == COMPOUND_LOOK:
        # the gap grows with the square of the distance from the contact, to the thickness of the compound on the ellipse
        share = compound_share(union_level(contact, grid) ** 2)
        return compound_scene(view, contact, grid, share, _rubbed(pair))
    return pattern_scene(view, contact, grid)


def rolling_scenes(
    pair: GearPair, name: str, path: ContactPath, view: str, size: Size, title: str, look: str = PLAIN_LOOK
) -> list[Scene]:
    """Scenes of a member's tooth over which the contact of a path rolls: of the views contact and pattern.

    Raises NoSolutionError for a pattern of contact along lines or on edges.
    """
    from gearmesh.view import motion

    touching = np.flatnonzero(path.touching)
    in_order = touching[np.argsort(path.rotation[touching], kind="stable")]
    contact = contact_on(pair.index(name), path, pair.mounts).at(in_order)
    if view == "contact":
        shown = replace(tooth_view(pair, name), title=_title(title, f"{name}, contact"), size=size)
        return motion.rolling_contact_scenes(shown, contact)
    _refuse_lines(contact)
    what = f"{name}, contact pattern, {_PATTERN_WORDS[look]}"
    shown = replace(tooth_view(pair, name), title=_title(title, what), size=size)
    rubbed = _rubbed(pair) if look == COMPOUND_LOOK else None
    return motion.growing_pattern_scenes(shown, contact, _pattern_grid(pair, name), rubbed)


def _refuse_lines(contact: MemberContact) -> None:
    """Raise NoSolutionError for contact along lines or on edges, which has no ellipses."""
    if not contact.ellipses.size:
        raise NoSolutionError(
            reason="no position has an ellipse of contact",
            remedy="the pattern by the roll test (gap) shows the contact",
        )


def _rubbed(pair: GearPair) -> str:
    return f"rubbed off: gap below {1e3 * pair.delta:.3g} µm"


def gap_picture(
    pair: GearPair,
    name: str,
    path: ContactPath,
    patches: list[tuple[Array, Array]],
    size: Size = PICTURE_SIZE,
    view: ToothView | None = None,
    title: str = "",
    whole: ContactPath | None = None,
    look: str = PLAIN_LOOK,
) -> Scene:
    """Scene of a member's tooth with the gaps of the roll test: `patches` of points, own frame, and gaps, mm.

    `look` is one of PICTURE_LOOKS.
    """
    contact = contact_on(pair.index(name), path, pair.mounts, whole)
    view = replace(
        view or tooth_view(pair, name),
        title=_title(title, f"{name}, contact pattern, {_GAP_WORDS[look]}"),
        size=size,
    )
    grid = _pattern_grid(pair, name)
    if look == COMPOUND_LOOK:
        share = compound_share(closest_gap(grid, patches) / pair.delta)
        return compound_scene(view, contact, grid, share, _rubbed(pair))
    return gap_scene(view, contact, grid, patches, pair.delta)


def pair_picture(
    pair: GearPair, meshes: dict[str, TriangleMesh], path: ContactPath, size: Size = PICTURE_SIZE, title: str = ""
) -> Scene:
    """Scene of both members in mesh, at the middle position with contact."""
    k = _middle(path)
    first, second = (meshes[name] for name in pair.members)
    return pair_scene(
        first, second, pair, (float(path.rotation[k]), float(path.phi2[k])), _title(title, "pair in mesh"), size
    )


def set_picture(gears: GearPair, placed: dict[str, TriangleMesh], size: Size = PICTURE_SIZE, title: str = "") -> Scene:
    """Scene of all members of a gear set in the fixed frame; `gears` is its first mesh."""
    return set_scene(placed, gears.pinion.mount.axis, _title(title, "gears in mesh"), size)


def members_picture(placed: dict[str, TriangleMesh], axis: Array, size: Size = PICTURE_SIZE, title: str = "") -> Scene:
    """Scene of members that mesh with no other, in the fixed frame, seen along an `axis` (3,)."""
    return set_scene(placed, axis, _title(title, ", ".join(placed)), size)


def tool_picture(
    member: Member, side: Side, tool: ToolInPlace, part: TriangleMesh | None, size: Size = PICTURE_SIZE, title: str = ""
) -> Scene:
    """Scene of a member with the tool that generates one of its flanks.

    `part`, a mesh in the tool's frame, is drawn instead of the tool's working surfaces.
    """
    from gearmesh.view.tools.tool_scene import tool_scene

    s, t = (np.linspace(0.0, 1.0, n) for n in TOOL_GRID)
    plain = replace(member, features=BodyFeatures())
    shown = f"{member.name}, {side} flank, and its {tool.name}"
    grid = member.tooth.flank_grid(side, s, t).points
    return tool_scene(gear_solid(plain, WHOLE_TOLERANCE_MM), tool, grid, part, _title(title, shown), size)


def tool_contact_picture(member: Member, side: Side, size: Size = PICTURE_SIZE, title: str = "") -> Scene:
    """Scene of a tool and the tooth that it generates on one side, with their lines of contact."""
    from gearmesh.teeth.generation.contact_lines import tool_contact
    from gearmesh.view.tools.tool_contact import tool_contact_scene

    name, tooth = member.name, member.tooth.unmodified_tooth
    contact = tool_contact(tooth, side)
    s, t = (np.linspace(0.0, 1.0, n) for n in TOOL_GRID)
    fine = FINE_TOLERANCE_PIXELS * flank_pixel(tooth.flank_grid(side, s, t).points, PICTURE_SIZE)
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
    """Scenes by file name: both members with their contact, the pinion's pattern and roll-test gaps, and the pair.

    Contact along lines or on edges has no ellipses; its pattern is shown by the roll test alone. `teeth` are views
    meshed for other pictures; `whole` is the contact of the whole engagement.
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
    """Draw the TE with the whole mesh cycle, and the contact on both driving flanks.

    Returns the panels of both sides for other figures; an empty list without a cycle.
    """
    from gearmesh.view.diagrams.flank_diagrams import plot_flanks

    plot_errors(contact, te_file, title)
    rows = all_flank_rows(contact)
    plot_flanks(path_file, driving_flanks(contact, rows), f"{title}: path of contact" if title else "path of contact")
    return rows


def plot_errors(contact: Contact, file: Path, title: str = "") -> None:
    """Plot the TE over the positions with the whole mesh cycle."""
    from gearmesh.view.diagrams.plots import plot_transmission_error

    # the mesh cycle is computed for members that stay displaced; eccentric members follow another path
    cycle, what = None if contact.pair.eccentric else contact.cycle, "transmission error"
    plot_transmission_error(
        file, contact.path, cycle, f"{title}: {what}" if title else what, contact.pair.output.reading.error
    )


def all_flank_rows(contact: Contact) -> list[list[Panel]]:
    """Panels of both sides; an empty list without a cycle."""
    return flank_rows(contact) if contact.engagement is not None else []


def driving_flanks(contact: Contact, rows: list[list[Panel]]) -> list[list[Panel]]:
    """Panels of contact on the driving flanks of both members, taken from the `rows` of both sides if there are any."""
    from gearmesh.view.diagrams.flank_diagrams import ContactPanel, beside

    gears = contact.pair
    driving = _first_side(rows) if rows else [flank_panel(gears, name, contact.path) for name in gears.members]
    return beside([panel for panel in driving if isinstance(panel, ContactPanel)])


def _first_side(rows: list[list[Panel]]) -> list[Panel]:
    """Panels of the driving side in the rows of `flank_rows`."""
    from gearmesh.view.diagrams.flank_diagrams import is_long

    return [row[0] for row in rows] if is_long([rows[0][0].plane]) else rows[0]


def flank_panel(
    gears: GearPair,
    name: str,
    path: ContactPath,
    title: str | None = None,
    whole: ContactPath | None = None,
    nominal: Array | None = None,
    exchange: Array | None = None,
) -> ContactPanel:
    """Panel of a member's flank in its plane: the contact of a path, and its pattern.

    `whole` is the path of the whole engagement, which gives the pattern if present. `nominal` (P, 3), own frame, is
    another path to compare with. With `exchange` (3,) both paths are those of the other flank, of which this flank is
    the image by the map of the own frame with that diagonal.
    """
    from gearmesh.view.diagrams.flank_diagrams import contact_panel
    from gearmesh.view.diagrams.flank_plane import FlankPlane

    index = gears.index(name)
    contact = contact_on(index, path, gears.mounts, whole)
    wholly = None if whole is None else contact_on(index, whole, gears.mounts)
    if exchange is not None:
        contact, wholly = contact.image(exchange), None if wholly is None else wholly.image(exchange)
    side = _side(gears, name)
    return contact_panel(
        FlankPlane.of(gears.members[name], side), contact, title or f"{name}, {side} flank", wholly, nominal
    )


def flank_rows(contact: Contact, names: tuple[str, ...] | None = None, sliding: bool = False) -> list[list[Panel]]:
    """Panels of both sides of a pair: contact on the flanks of members, and the pinion's ease-off or sliding velocity.

    The sides of long flanks are beside each other, the sides of short flanks above each other. `sliding` selects the
    velocity. Raises NoSolutionError if neither side meets.
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
                exchange=flanks_of_side.exchange,
            )
            for name in names
        ]
        # the sliding velocity is the same for either member
        if sliding or gears.pinion.name in names:
            panels.append(_field_panel(flanks_of_side, sliding))
        sides.append(panels)
    if not sides:
        raise NoSolutionError(reason="the flanks never meet", remedy="reduce the assembly errors")
    return [list(row) for row in zip(*sides, strict=True)] if is_long([sides[0][0].plane]) else sides


def _field_panel(side: SideContact, sliding: bool) -> FieldPanel:
    """Panel of the ease-off (um) or the sliding velocity (m/s at 1000 rpm) over the pinion's flank."""
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
            MIN_EASE_OFF_RANGE_UM,
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
        MIN_SPEED_RANGE_M_S,
        arrows,
        continued=np.linalg.norm(further, axis=-1),
        beyond=ease_off.beyond,
        unit="m/s",
        sense=f"velocity of the {name}'s flank relative to the {side.pair.gear.name}'s",
    )


def in_mesh(gears: GearPair, meshes: dict[str, TriangleMesh], path: ContactPath) -> dict[str, TriangleMesh]:
    """Meshes of the members in the fixed frame at the middle position with contact."""
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


class Meshed(Protocol):
    """A member that is meshed."""

    @property
    def member(self) -> Member | None:
        """The member, None if it is not known."""

    @property
    def teeth(self) -> Sequence[ToothMesh]:
        """Meshes of its teeth, one where all are alike."""


@dataclass(frozen=True)
class ToothViews:
    """Views of the members' teeth; each tooth is meshed once, however many pictures and meshes show it.

    `solids`: members, by name, that are meshed already. A member that is fine enough is not meshed again.
    """

    solids: Mapping[str, Meshed] = field(default_factory=dict)
    meshes: dict[str, tuple[TriangleMesh, TriangleMesh]] = field(default_factory=dict)
    #: width and height of the pictures, pixels
    size: Size = PICTURE_SIZE

    def of(self, gears: GearPair, name: str) -> ToothView:
        """View of a member's tooth, finely meshed, in front of the rest of its gear."""
        body = gears.members[name]
        grid, ends = _pattern_grid(gears, name), end_names(body.tooth.blank.axial)
        if name not in self.meshes:
            self.meshes[name] = _fine_and_rest(body, self.solids.get(name), flank_pixel(grid, self.size))
        fine, rest = self.meshes[name]
        return ToothView(fine, flank_projection(body, _side(gears, name)), rest, grid, ends=ends)


def tooth_view(gears: GearPair, name: str) -> ToothView:
    """View of a member's tooth for one picture."""
    return ToothViews().of(gears, name)


def _fine_and_rest(body: Member, solid: Meshed | None, pixel: float) -> tuple[TriangleMesh, TriangleMesh]:
    """Meshes of the tooth on +x, fine, and of the gear without it, coarse, for pixels of this length (mm).

    They are taken from `solid` if it is fine enough. Triangles of a picture are not kept, so they are not thinned.
    """
    if (
        solid is not None
        and solid.member is body
        and len(solid.teeth) == 1
        and solid.teeth[0].tolerance <= REUSED_TOLERANCE_PIXELS * pixel
    ):
        (tooth,) = solid.teeth
        fine, rough = tooth, tooth
    else:
        fine, rough = (
            tessellate(body.tooth, tolerance, lean=False)
            for tolerance in (FINE_TOLERANCE_PIXELS * pixel, COARSE_TOLERANCE_PIXELS * pixel)
        )
    whole = gear_solid(replace(body, features=BodyFeatures()), rough.tolerance, rough)
    rest = replace(
        whole,
        triangles=whole.triangles[rough.triangles :],
        regions=whole.regions[rough.triangles :],
        normals=whole.normals[rough.triangles :],
    )
    return teeth_mesh(fine, body.name, np.array([0])), rest


#: points of the last flanks, on which patterns are drawn
_KEPT_GRIDS = KeptByTooth[Array]()


def _pattern_grid(gears: GearPair, name: str) -> Array:
    tooth, side = gears.members[name].tooth, _side(gears, name)
    places = [np.linspace(0.0, 1.0, n) for n in PATTERN_GRID]
    return _KEPT_GRIDS.get(tooth, side, lambda: tooth.flank_grid(side, *places).points)
