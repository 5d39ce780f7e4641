"""The tool that generates a flank, where it stands while it generates the flank's middle.

What generates a flank is told by its surface: an `Envelope` has a tool and a motion, which stands at the parameter that belongs
to the point; a `PlacedSurface` is a tool that cut its own shape; a `FeedEnvelope` is ground by a worm, or by a disk if
nothing but the disk turns. The other side of a tooth or of a space is cut by the same tool if that stands at the same place.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gearmesh.errors import ArgumentError, DesignError
from gearmesh.kernel.envelope.envelope import Envelope
from gearmesh.kernel.envelope.feed_envelope import FeedEnvelope
from gearmesh.kernel.motion.feed_motion import FeedMotion
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.motion.rolling import CradleRoll, RackRoll
from gearmesh.kernel.numeric.algebra import AXIS, Array
from gearmesh.kernel.surface.surface import Jet, PlacedSurface, Surface
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import ToothSide
from gearmesh.tools.head_cutter import Revolved
from gearmesh.tools.rack import RackSurface

#: points across a tool's flank and its tip rounding, round a surface of revolution, along a rack
ACROSS, TIP, AROUND, ALONG = 25, 17, 361, 61
#: how far a head cutter's blades and a disk are shown, in heights of the flank that they generate, and a rack beyond the face
SHOWN, BEYOND = 1.5, 0.1
#: spaces of a rack that are shown on either side of the middle one
SPACES = 2
#: what tools are called
WORM, DISK, HEAD_CUTTER = "grinding worm", "grinding disk", "head cutter"
RACK, SHAPER = "rack cutter", "shaper"
#: distance (mm), and angle (rad), within which tools stand at the same place
SAME = 1e-9


@dataclass(frozen=True)
class MachineAxis:
    """An axis of the tool or its machine, own frame of the member: a point (3,), mm, and a unit direction (3,)."""

    name: str
    point: Array
    direction: Array


@dataclass(frozen=True)
class ToolSheet:
    """A part of a tool's surface as a grid of points and unit normals, into the tool, (M, N, 3), in the tool's frame, mm."""

    region: str
    points: Array
    normals: Array


@dataclass(frozen=True)
class ToolInPlace:
    """A tool in its place over a member, of which it generates the point `touching`.

    `tool_to_own` takes the tool's frame to the member's own; `touching`: the tool's jet at the point, in the own frame, its normal
    out of the member; `place` (p, v): the flank's parameters there. `sheets` are what is known of its surface, none of a worm,
    which is a part of its own, and `outlines` (K, 3) its section through the point, all in the tool's frame.
    """

    name: str
    tool_to_own: Rigid
    touching: Jet
    place: tuple[float, float]
    sheets: tuple[ToolSheet, ...]
    outlines: tuple[Array, ...]
    axes: tuple[MachineAxis, ...]

    @property
    def is_worm(self) -> bool:
        return self.name == WORM


@dataclass(frozen=True)
class _Standing:
    """A tool's surface, its frame over the own one, its parameters (u, v) at the point, and the motion's parameters there."""

    tool: Surface
    tool_to_own: Rigid
    at: tuple[Array, Array]
    motion: tuple[Array, ...]


def tool_in_place(tooth: Tooth, which: Side) -> ToolInPlace:
    """The tool that generates one flank of a tooth, over the tooth as it leaves it.

    Raises DesignError where the flank's surface does not tell its tool.
    """
    tooth = tooth.unmodified
    side = tooth.side(which)
    middle = tooth.flank_grid(which, [0.5], [0.5]).parameters[0, 0]
    standing = _standing(side.flank, middle)
    tool = standing.tool
    name = tool_name(side.flank)
    sides = [side, *_others(tooth, which, standing)]
    sheets: tuple[ToolSheet, ...] = ()
    outlines: tuple[Array, ...] = ()
    if name in (RACK, SHAPER):
        sheets = tuple(_rack_sheets(tooth, sides, side.flank))
    elif name != WORM:
        sheets, outlines = _turned(sides, standing, middle)
    return ToolInPlace(
        name,
        standing.tool_to_own,
        tool.jet(*standing.at).moved(standing.tool_to_own),
        (float(middle[0]), float(middle[1])),
        sheets,
        outlines,
        tuple(_axes(name, side.flank, standing)),
    )


def tool_name(flank: Surface, view: str = "tool") -> str:
    """What the tool that generates a flank is called. Raises DesignError for a flank that does not tell, naming the `view`."""
    if isinstance(flank, FeedEnvelope):
        assert isinstance(flank.motion, FeedMotion)
        return DISK if flank.motion.turn == 0.0 else WORM
    if isinstance(flank, Envelope | PlacedSurface):
        tool = tool_surface(flank)
        if isinstance(tool, Revolved):
            return HEAD_CUTTER
        if isinstance(flank, Envelope) and isinstance(tool, RackSurface):
            return RACK if isinstance(flank.motion, RackRoll) else SHAPER
    raise unknown_tool(flank, view)


def unknown_tool(flank: Surface, view: str) -> DesignError:
    """For a flank whose surface does not tell its tool, which a `view` cannot show."""
    return ArgumentError(
        "view",
        view,
        reason=f"the tool of this flank ({type(flank).__name__}) cannot be shown",
        allowed="a flank of head cutters, rack cutters, shapers, grinding worms or disks",
    )


def _standing(flank: Surface, place: Array) -> _Standing:
    u, v = place
    if isinstance(flank, Envelope):
        g = flank.generation(u, v)
        return _Standing(flank.tool, g.state.tool_to_blank, (u, v), (g.phi,))
    if isinstance(flank, FeedEnvelope):
        fed = flank.generation(u, v)
        return _Standing(flank.tool, fed.state.tool_to_blank, (u, fed.v), (fed.psi, v))
    if isinstance(flank, PlacedSurface):
        return _Standing(flank.surface, flank.place, (u, v), ())
    raise unknown_tool(flank, "tool")


def _placed(flank: Surface, motion: tuple[Array, ...]) -> Rigid | None:
    """The tool's frame over the own one at the parameters of a motion; None for another kind of flank."""
    if isinstance(flank, Envelope) and len(motion) == 1:
        return flank.motion.at(motion[0]).tool_to_blank
    if isinstance(flank, FeedEnvelope) and len(motion) == 2:
        return flank.motion.at_several(*motion).tool_to_blank
    if isinstance(flank, PlacedSurface) and not motion:
        return flank.place
    return None


def _others(tooth: Tooth, which: Side, standing: _Standing) -> list[ToothSide]:
    """The other side, if the same tool cuts it at the same time: of this tooth, or of the next one beyond the space."""
    other = tooth.side(Side.LEFT if which is Side.RIGHT else Side.RIGHT)
    place = _placed(other.flank, standing.motion)
    if place is None:
        return []
    here = standing.tool_to_own
    for number in (0, -which.sign, which.sign):
        there = Rigid.about_z(number * tooth.pitch_angle) @ place
        apart = np.abs(there.rotation - here.rotation).max(), np.abs(there.translation - here.translation).max()
        if max(apart) < SAME:
            return [other]
    return []


def tool_surface(surface: Surface) -> Surface:
    """The tool's surface of one that it generates."""
    if isinstance(surface, PlacedSurface):
        return surface.surface
    assert isinstance(surface, Envelope | FeedEnvelope)
    return surface.tool


def _sheet(region: str, jet: Jet) -> ToolSheet:
    return ToolSheet(region, jet.r, jet.n)


# --- tools that are surfaces of revolution ---


def _turned(
    sides: list[ToothSide], standing: _Standing, middle: Array
) -> tuple[tuple[ToolSheet, ...], tuple[Array, ...]]:
    """Head cutter and disk: flank and tip of all sides, the tip plane or rim between two, and their section at the point."""
    r = standing.tool.jet(*standing.at).r
    through = float(np.arctan2(r[1], r[0]))
    sheets, sections = [], []
    for side in sides:
        section = []
        for region, surface, p in _meridians(side):
            jet = _meridian(surface, p, middle)
            sheets.append(_sheet(region, _revolved(jet, np.linspace(0.0, 2.0 * np.pi, AROUND))))
            section.append(_revolved(jet, np.array([through])).r[:, 0])
        sections.append(np.concatenate(section))
    if len(sections) == 2:
        first, second = sections
        ring = np.linspace(first[-1], second[-1], 2)
        flat = Jet(ring, np.broadcast_to(AXIS, ring.shape), *(np.zeros_like(ring),) * 4)
        sheets.append(_sheet("land", _revolved(flat, np.linspace(0.0, 2.0 * np.pi, AROUND) - through)))
        sections = [np.concatenate((first, second[::-1]))]
    return tuple(sheets), tuple(sections)


def _meridians(side: ToothSide) -> Iterable[tuple[str, Surface, Array]]:
    top = side.joint[0] + SHOWN * (side.tip - side.joint[0])
    yield "flank", side.flank, np.linspace(top, side.joint[0], ACROSS)
    yield "fillet", side.fillet, np.linspace(side.joint[1], side.root, TIP)


def _meridian(surface: Surface, p: Array, middle: Array) -> Jet:
    """A line across the tool's surface, one point (P, 3) at each p."""
    tool = tool_surface(surface)
    if isinstance(surface, FeedEnvelope):
        return tool.jet(p, surface.generation(p, np.full_like(p, middle[1])).v)
    return tool.jet(p, np.zeros_like(p))


def _revolved(line: Jet, angles: Array) -> Jet:
    """A line (P,) turned about the z axis, each of its points to the angles (A,), rad: (P, A)."""
    at = np.arctan2(line.r[:, 1], line.r[:, 0])
    turned = Rigid.about_z(angles - at[:, None])
    r, n = turned.point(line.r[:, None]), turned.vector(line.n[:, None])
    return Jet(r, n, *(np.zeros_like(r),) * 4)


# --- racks and shapers ---


def _rack_sheets(tooth: Tooth, sides: list[ToothSide], flank: Surface) -> Iterable[ToolSheet]:
    """Flanks and tips of a few spaces of a rack, or of one of a shaper, and the tip planes between them, as long as the face."""
    assert isinstance(flank, Envelope)
    motion, shifts = flank.motion, np.zeros((1, 3))
    if isinstance(motion, RackRoll):
        shifts = np.arange(-SPACES, SPACES + 1)[:, None] * [0.0, motion.radius * tooth.pitch_angle, 0.0]
    reach = [tooth.flank_grid(which, [0.0, 1.0], [0.0, 1.0]).parameters[..., 1] for which in Side]
    low, high = float(np.min(reach)), float(np.max(reach))
    v = np.linspace(low - BEYOND * (high - low), high + BEYOND * (high - low), ALONG)
    ends = []
    for side in sides:
        for region, surface, p in (
            ("flank", side.flank, np.linspace(side.tip, side.joint[0], ACROSS)),
            ("fillet", side.fillet, np.linspace(side.joint[1], side.root, TIP)),
        ):
            jet = tool_surface(surface).jet(p[:, None], v)
            yield from (ToolSheet(region, jet.r + shift, jet.n) for shift in shifts)
        ends.append((jet.r[-1], jet.n[-1]))
    if len(ends) == 2:
        # the tip plane of a cutter's tooth, from the end of one space to the beginning of the next
        (low_end, normal), (high_end, _) = sorted(ends, key=lambda end: float(end[0][:, 1].mean()))
        for before, after in pairwise(shifts):
            points = np.stack((high_end + before, low_end + after))
            yield ToolSheet("land", points, np.broadcast_to(normal, points.shape))


# --- axes ---


def _axes(name: str, flank: Surface, standing: _Standing) -> Iterable[MachineAxis]:
    if name not in (RACK, SHAPER):
        place = standing.tool_to_own
        yield MachineAxis(f"axis of the {name}", place.translation, place.vector(AXIS))
    if isinstance(flank, Envelope) and isinstance(flank.motion, CradleRoll):
        machine = flank.motion.machine_to_blank(standing.motion[0])
        yield MachineAxis("cradle axis", machine.translation, machine.vector(AXIS))
