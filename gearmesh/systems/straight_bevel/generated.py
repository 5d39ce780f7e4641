"""One side of a straight bevel gear's tooth, as a side of the crown gear generates it.

The pitch cone of the blank rolls on the pitch plane of the crown gear. Their axes meet in the apex.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.kernel.envelope.envelope import Envelope
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.motion.rolling import CradleRoll
from gearmesh.kernel.numeric.algebra import rotation_about
from gearmesh.kernel.surface.levels import ConeLevel
from gearmesh.kernel.surface.surface import PlacedSurface
from gearmesh.records import dataclass
from gearmesh.systems.common.bevel.machine_frame import own_axes
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth_side import Bottom, ToothSide
from gearmesh.tools.crown_rack import CrownSpace, MeanSection
from gearmesh.tools.description import Dimension, HeightZero, ToolDescription
from gearmesh.tools.disc_cutter import DiscBlade
from gearmesh.tools.drawing import StraightDrawing, TurnedDrawing


@dataclass(frozen=True)
class CrownCut:
    """One side that the crown gear generates."""

    #: side of the crown gear's space
    space: CrownSpace
    #: pitch angle of the member, rad
    pitch_angle: float
    #: root cone of the member
    root_cone: ConeLevel
    #: depth of the tooth at the mean cone distance, mm
    depth: float
    #: name of the tool
    tool: str
    #: True where the edge radius may be reduced if it does not fit
    edge_free: bool
    #: the crown gear's tip leaves a cone
    cuts_cone: bool = True

    @property
    def flank(self) -> Side:
        return Side.RIGHT if self.space.side > 0 else Side.LEFT

    def with_edge(self, share: float) -> CrownCut:
        """Return the side with a share of its edge radius, or unchanged if the edge radius is not free."""
        if not self.edge_free:
            return self
        return replace(self, space=replace(self.space, edge_radius=share * self.space.edge_radius))

    def side(self, place: float) -> ToothSide:
        """Return flank and fillet, turned by a `place` (rad) about the member's axis. v = 0 is the mean cone distance."""
        motion = crown_roll(self.pitch_angle, place)
        flank, fillet = (Envelope(tool, motion, branch=1) for tool in (self.space.flank, self.space.tip))
        height = self.depth / np.cos(self.space.pressure_angle)
        return ToothSide(
            flank, fillet, (0.0, 0.0), 1.0, tip=float(height), tool=self.description, generation=(flank, fillet)
        )

    @property
    def description(self) -> ToolDescription:
        """The tool."""
        space = self.space
        dimensions = (
            Dimension("pressure angle", float(np.degrees(space.pressure_angle)), "deg", "alpha_0"),
            Dimension("tip radius", space.edge_radius, "mm", "rho_a0"),
        )
        flank, tip = (MeanSection(surface, space.depth, space.side) for surface in (space.flank, space.tip))
        zero = HeightZero.TIP_PLANE
        return ToolDescription(self.tool, StraightDrawing(), dimensions, flank, tip, space.edge_radius, zero)

    def common_root(self, other: CrownCut, turn: float, place: float) -> Bottom | None:
        """Return None: the root is the cone that the crown gear's tip leaves."""
        return None


@dataclass(frozen=True)
class DiscCut:
    """One side that a disc cutter on the cradle of the crown gear cuts: the plane of the octoid, hollowed lengthwise."""

    #: profile of the disc
    blade: DiscBlade
    #: disc in the machine frame: axes x from the axis to the mean point, z along the axis into the tooth
    place: Rigid
    #: +1 for right flanks of the blank (y < 0), -1 for left flanks
    sign: int
    #: pitch angle of the member, rad
    pitch_angle: float
    #: root cone of the blank, to which the disc cuts at toe and heel
    root_cone: ConeLevel
    #: depth of the land below the pitch plane at the mean cone distance, mm
    land_depth: float
    #: depth of the tooth at the mean cone distance, mm
    depth: float
    #: True where the edge radius may be reduced if it does not fit
    edge_free: bool
    #: the rim leaves no cone
    cuts_cone: bool = False

    @property
    def flank(self) -> Side:
        return Side.RIGHT if self.sign > 0 else Side.LEFT

    def with_edge(self, share: float) -> DiscCut:
        """Return the side with a share of its edge radius, or unchanged if the edge radius is not free."""
        if not self.edge_free:
            return self
        return replace(self, blade=replace(self.blade, edge_radius=share * self.blade.edge_radius))

    def side(self, place: float) -> ToothSide:
        """Return flank and fillet, turned by a `place` (rad) about the member's axis. v = 0 is the mean cone distance."""
        blade, axis = self.blade, self.place.rotation[:, 2]
        tilt, swivel = float(np.arccos(axis[2])), float(np.arctan2(axis[1], axis[0]))
        # the disc's x axis in the frame that tilt and swivel leave
        leaning = rotation_about("z", swivel) @ rotation_about("y", tilt)
        x, y, _ = leaning.T @ self.place.rotation[:, 0]
        start = float(np.arctan2(y, x))
        centre_x, centre_y, centre_z = (float(c) for c in self.place.translation)
        motion = replace(
            crown_roll(self.pitch_angle, place), centre=(centre_x, centre_y, centre_z), tilt=(tilt,), swivel=(swivel,)
        )
        flank, fillet = (
            Envelope(blade.surface(profile, start), motion, branch=1) for profile in (blade.flank, blade.tip)
        )
        height = self.depth / np.cos(blade.profile_angle)
        return ToothSide(
            flank,
            fillet,
            blade.form_point,
            blade.root,
            tip=float(height),
            tool=self.description,
            generation=(flank, fillet),
        )

    @property
    def description(self) -> ToolDescription:
        """The tool."""
        blade = self.blade
        flank, tip = (
            MeanSection(PlacedSurface(blade.surface(profile, 0.0), self.place), self.land_depth, self.sign)
            for profile in (blade.flank, blade.tip)
        )
        zero = HeightZero.TIP_PLANE
        return ToolDescription("disc cutter", TurnedDrawing(), blade.dimensions, flank, tip, blade.edge_radius, zero)

    def common_root(self, other: DiscCut, turn: float, place: float) -> Bottom | None:
        """Return None: each side of a space has a disc of its own."""
        return None


def disc_place(space: CrownSpace, blade: DiscBlade, face: tuple[float, float]) -> tuple[Rigid, float]:
    """Return the disc of a side in the machine frame, and the depth (mm) of its land at the mean cone distance.

    One edge lies in the flank's plane and passes through the mean point at right angles to the root line. The rim
    reaches the root line at both ends of the face, or beyond.

    - `space`: side of the crown gear, with flat flanks
    - `face`: lengths (mm) of the face from the mean cone distance to toe and heel
    """
    at, depth = space.curve.at(np.zeros(())), space.depth / np.cos(space.pressure_angle)
    along, upwards, normal = at.e, at.e_u, at.n
    # the root line in the flank's plane leans by its slope
    lean = np.arctan(space.slope / np.cos(space.pressure_angle))
    edge = np.cos(lean) * upwards + np.sin(lean) * along
    # the ends of the root line from the foot of the edge, and how much deeper the rim is between them
    foot = depth * np.sin(lean)
    reach = max(abs(foot - face[0] / np.cos(lean)), abs(foot + face[1] / np.cos(lean)))
    deeper = (blade.radius - np.sqrt(blade.radius**2 - reach**2)) * np.cos(blade.dish_angle)
    corner = space.mean * along - (depth * np.cos(lean) + deeper) * edge
    axis = np.cos(blade.dish_angle) * normal + np.sin(blade.dish_angle) * edge
    outwards = np.sin(blade.dish_angle) * normal - np.cos(blade.dish_angle) * edge
    centre = corner - blade.radius * outwards
    x, z = outwards * space.mirror, -axis * space.mirror
    return Rigid(np.stack((x, np.cross(z, x), z), axis=-1), centre * space.mirror), float(corner[2])


def land_angle(space: CrownSpace) -> float:
    """Return the angle (rad) between the edge of a disc and the direction across its land, which is level."""
    lean = np.arctan(space.slope / np.cos(space.pressure_angle))
    # the direction up, without its part along the root line
    return float(np.arctan(np.tan(space.pressure_angle) / np.cos(lean)))


def crown_roll(pitch_angle: float, place: float) -> CradleRoll:
    """Return the roll of the crown gear on the pitch cone of a blank.

    - `pitch_angle`: pitch angle of the blank, rad
    - `place`: rotation of the generated surface about the blank's axis, rad
    """
    base = Rigid(own_axes(pitch_angle), np.zeros(3))
    return CradleRoll((0.0, 0.0, 0.0), base, (place, -1.0 / float(np.sin(pitch_angle))))
