"""The root between two teeth: a cone enveloped by the cutter's tip plane, or another surface.

A tilted cutter, a helical motion and a machine without roll leave no surface of revolution. If one cutter cuts both
sides of the space at once, the root is exactly the surface that its tip plane leaves. If two cutters with a machine
each cut the sides, the root is drawn straight from fillet to fillet at every station.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol, Self

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import ConeLevel, Level
from gearmesh.kernel.surface.stations import along
from gearmesh.kernel.surface.strip import Strip
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth_side import Bottom, ToothSide

#: number of stations along the face at which the ends of the fillets are computed
FILLET_STATIONS = 9


class CutSide(Protocol):
    """One side of a bevel gear's tooth, as its tool cuts it."""

    @property
    def flank(self) -> Side:
        """Side of the tooth."""

    @property
    def cuts_cone(self) -> bool:
        """True where the tool's tip leaves a cone about the member's axis."""

    @property
    def root_cone(self) -> ConeLevel:
        """Root cone, which the tool's tip leaves."""

    def side(self, place: float) -> ToothSide:
        """Return flank and fillet, turned by a `place` (rad) about the member's axis."""

    def with_edge(self, share: float) -> Self:
        """Return the side with a share of its edge radius, or unchanged if the edge radius is not free."""

    def common_root(self, other: Self, turn: float, place: float) -> Bottom | None:
        """Return the root between this right flank and the left flank of the tooth before, if one tool cuts both.

        - `other`: the left side of a tooth
        - `turn`: rotation (rad) between the places of both sides of a space
        - `place`: index position of this side, rad
        """


def root_cone(name: str, sides: Mapping[Side, CutSide], axial: Level, extent: tuple[float, float]) -> ConeLevel:
    """Return the root cone of a member.

    Upright cutters with roll cut both sides to one cone. Other cutters leave none; the result is then a cone with the
    mean slope of the fillets' ends, nowhere below them.

    Raises DesignError for sides that are cut to different depths or not from toe to heel.
    """
    if all(side.cuts_cone for side in sides.values()):
        return _common(name, sides)
    ends = [_fillet_end(side.side(0.0), axial, np.linspace(*extent, FILLET_STATIONS)) for side in sides.values()]
    rho, z = (
        np.concatenate(coordinate)
        for coordinate in zip(*((np.hypot(r[:, 0], r[:, 1]), r[:, 2]) for r in ends), strict=True)
    )
    slope = float(np.polyfit(z, rho, 1)[0])
    return ConeLevel.of(float((rho - slope * z).max()), slope)


def _common(name: str, sides: Mapping[Side, CutSide]) -> ConeLevel:
    """Return the cone to which both sides are cut. Raises DesignError for sides that are cut to different depths."""
    right_cone, left_cone = sides[Side.RIGHT].root_cone, sides[Side.LEFT].root_cone
    if not np.allclose((right_cone.angle, right_cone.offset), (left_cone.angle, left_cone.offset), rtol=0.0, atol=1e-9):
        raise DesignError(
            f"{name}.convex.sliding_base",
            reason="the sides would be cut to different depths",
            allowed=f"the same sliding_base and machine_root_angle as {name}.concave",
        )
    return right_cone


def bottom(
    sides: Mapping[Side, CutSide],
    cut: dict[Side, ToothSide],
    places: dict[Side, float],
    pitch_angle: float,
    face: tuple[Level, tuple[float, float]],
) -> Bottom | None:
    """Return the surface of the root if it is no cone, else None.

    - `sides`: both sides with their machines
    - `cut`: both sides as they are cut
    - `places`: index angles of the sides, rad
    - `pitch_angle`: angular pitch, rad
    - `face`: station level and its extent from toe to heel

    Raises ValueError where the fillets do not end in smooth curves.
    """
    if all(side.cuts_cone for side in sides.values()):
        return None
    together = sides[Side.RIGHT].common_root(
        sides[Side.LEFT], places[Side.LEFT] - places[Side.RIGHT] - pitch_angle, places[Side.RIGHT]
    )
    if together is not None:
        return together
    # two cutters: a ruled strip between the ends of the fillets of neighbouring teeth
    axial, extent = face
    back = Rigid.about_z(-pitch_angle)
    return Bottom(
        Strip.through(
            axial,
            extent,
            lambda a: back.point(_fillet_end(cut[Side.LEFT], axial, a)),
            lambda a: _fillet_end(cut[Side.RIGHT], axial, a),
        ),
        (0.0, 1.0),
    )


def _fillet_end(side: ToothSide, axial: Level, stations: Array) -> Array:
    """Return the points (T, 3) at which the fillet passes into the root, at stations (T,)."""
    return along(side.fillet, np.full_like(stations, side.root), stations, axial)[1].r
