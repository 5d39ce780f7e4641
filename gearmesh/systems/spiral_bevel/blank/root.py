"""The root between two teeth: a cone enveloped by the cutter's tip plane, or another surface.

A tilted cutter, a helical motion and a machine without roll leave no surface of revolution. If one cutter cuts both
sides of the space at once, the root is exactly the surface that its tip plane leaves. If two cutters with a machine
each cut the sides, the root is drawn straight from fillet to fillet at every station.
"""

from __future__ import annotations

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import ConeLevel, Level
from gearmesh.kernel.surface.stations import along
from gearmesh.kernel.surface.strip import Strip
from gearmesh.systems.spiral_bevel.machine.generated import Generated
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth_side import Bottom, ToothSide
from gearmesh.tools.rack import RackLine

#: number of stations along the face at which the ends of the fillets are computed
FILLET_STATIONS = 9
#: tip plane of the cutter as a blade that lies in it; the parameter is the radius on the cutter
TIP_PLANE = RackLine(0.5 * np.pi, 0.0, 0.0)


def root_cone(name: str, sides: dict[Side, Generated], axial: Level, extent: tuple[float, float]) -> ConeLevel:
    """Return the root cone of a member.

    Upright cutters with roll cut both sides to one cone. Other cutters leave none; the result is then a cone with the
    mean slope of the fillets' ends, nowhere below them.

    Raises DesignError for sides that are cut to different depths or not from toe to heel.
    """
    if all(side.settings.cuts_cone for side in sides.values()):
        return _common(name, sides)
    ends = [_fillet_end(side.side(0.0), axial, np.linspace(*extent, FILLET_STATIONS)) for side in sides.values()]
    rho, z = (
        np.concatenate(coordinate)
        for coordinate in zip(*((np.hypot(r[:, 0], r[:, 1]), r[:, 2]) for r in ends), strict=True)
    )
    slope = float(np.polyfit(z, rho, 1)[0])
    return ConeLevel.of(float((rho - slope * z).max()), slope)


def _common(name: str, sides: dict[Side, Generated]) -> ConeLevel:
    """Return the cone to which both sides are cut. Raises DesignError for sides that are cut to different depths."""
    by_name = {("concave" if side.concave else "convex"): side.settings.tip_cone() for side in sides.values()}
    concave_cone, convex_cone = by_name["concave"], by_name["convex"]
    if not np.allclose(
        (concave_cone.angle, concave_cone.offset), (convex_cone.angle, convex_cone.offset), rtol=0.0, atol=1e-9
    ):
        raise DesignError(
            f"{name}.convex.sliding_base",
            reason="the sides would be cut to different depths",
            allowed=f"the same sliding_base and machine_root_angle as {name}.concave",
        )
    return concave_cone


def bottom(
    sides: dict[Side, Generated],
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
    if all(side.settings.cuts_cone for side in sides.values()):
        return None
    right, left = sides[Side.RIGHT], sides[Side.LEFT]
    in_one = right.settings == left.settings and abs(places[Side.LEFT] - places[Side.RIGHT] - pitch_angle) < 1e-9
    # one cutter cuts both sides: the root is the envelope of its tip plane between the ends of both blades
    if in_one:
        outside = right if right.concave else left
        surface = outside.cut(TIP_PLANE, places[Side.RIGHT])
        return Bottom(surface, (left.blade.land_radius, right.blade.land_radius))
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
