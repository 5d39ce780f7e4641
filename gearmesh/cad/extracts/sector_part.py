"""A sector of a member for CAD: the whole solid, split by a spline surface through the middles of roots, in two positions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gearmesh.cad.brep import SplineTooth
from gearmesh.cad.nodes import SPLINE_DEGREE
from gearmesh.cad.occ import PRECISION_MM, collection, solids_in, spline_surface
from gearmesh.cad.solid_part import turn_about_z
from gearmesh.cad.step import NamedFace, Part, faces_after
from gearmesh.errors import DesignError
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.mesh.extracts.sector import CutSurface
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import CUT_REGIONS, Region

if TYPE_CHECKING:
    from scipy.interpolate import Akima1DInterpolator

#: overhang of the cut surface beyond the member, over the member's largest radius
OVERHANG_SHARE = 0.2
#: largest turn of the cut surface between nodes
MAX_TURN_RAD = 0.05
#: least number of nodes of the cut surface
MIN_NODES = 8


def sector_part(whole: Part, member: Member, teeth: SplineTooth, pitches: int) -> Part:
    """Cut the first `pitches` pitches from a whole member without keyway; the cut faces are cut_right and cut_left.

    Beyond the teeth the cut surface continues straight. Raises DesignError if OpenCASCADE makes no valid solid.
    """
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Splitter
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_Transform
    from OCP.BRepCheck import BRepCheck_Analyzer

    first = BRepBuilderAPI_MakeFace(_cut_surface(member, teeth), PRECISION_MM).Face()
    last = BRepBuilderAPI_Transform(first, turn_about_z(pitches * member.tooth.pitch_angle), True).Shape()
    solids, cuts = (collection("List_TopoDS_Shape")() for _ in range(2))
    solids.Append(whole.solid)
    for cut in (first, last):
        cuts.Append(cut)
    splitter = BRepAlgoAPI_Splitter()
    splitter.SetArguments(solids)
    splitter.SetTools(cuts)
    splitter.Build()
    tools = [NamedFace(cut, region, region) for cut, region in zip((first, last), CUT_REGIONS, strict=True)]
    for solid in solids_in(splitter.Shape()):
        faces = faces_after(splitter, solid, (*whole.faces, *tools))
        if any(face.name == f"{Region.LAND}_1" for face in faces) and BRepCheck_Analyzer(solid).IsValid():
            return Part(whole.name, solid, faces, (*whole.regions, *CUT_REGIONS))
    raise DesignError(
        member.name, reason=f"OpenCASCADE does not cut a sector of {pitches} pitches; choose a larger tolerance"
    )


def _cut_surface(member: Member, teeth: SplineTooth) -> Any:
    """Geom_BSplineSurface through the middles of the roots before tooth 0, ruled from the axis or from inside the bore."""
    from scipy.interpolate import make_interp_spline

    cut, (across, up) = CutSurface.of(member), station_normal(member.tooth.blank.axial)
    base = float(cut.level.value(np.zeros(3)))
    corners = teeth.corners.reshape(-1, 3)
    corners = np.concatenate([half.points(corners) for half in member.halves])
    # range of stations of the member with an overhang
    rho, z = np.concatenate(
        (np.array(member.body.profile), np.stack((np.hypot(*corners[:, :2].T), corners[:, 2]), 1))
    ).T
    margin = OVERHANG_SHARE * float(rho.max())
    value = across * rho + up * z + base
    low, high = value.min() - margin, value.max() + margin
    if up == 0.0:
        # cylinders as stations: the rows begin at the axis
        low, high = sorted((base, base + across * (rho.max() + margin)))
    # border curves at an inner and an outer radius, or at both ends; the surface is straight between them
    angle = _angles(cut, low, high)
    count = MIN_NODES + int(
        np.ceil(np.abs(np.diff(angle(np.linspace(low, high, cut.stations.size)))).sum() / MAX_TURN_RAD)
    )
    stations = np.linspace(low, high, count)
    sides = (z.min() - margin, z.max() + margin) if up == 0.0 else (0.5 * _inner(member), rho.max() + margin)
    borders = []
    for side in sides:
        rhos = (stations - base) / across if up == 0.0 else np.full(count, side)
        zs = np.full(count, side) if up == 0.0 else (stations - base - across * side) / up
        points = np.stack((rhos * np.cos(angle(stations)), rhos * np.sin(angle(stations)), zs), axis=-1)
        borders.append(make_interp_spline(np.linspace(0.0, 1.0, count), points, k=SPLINE_DEGREE))
    share = np.linspace(0.0, 1.0, SPLINE_DEGREE + 1)[:, None, None]
    control = (1.0 - share) * borders[0].c + share * borders[1].c
    return spline_surface(control, np.repeat([0.0, 1.0], SPLINE_DEGREE + 1), borders[0].t)


def _inner(member: Member) -> float:
    """Return the least radius (mm) of the body."""
    return min(rho for rho, _ in member.body.profile)


def _angles(cut: CutSurface, low: float, high: float) -> Akima1DInterpolator:
    """Return the polar angle (rad) as a function of the station coordinate from `low` to `high`, linear beyond the teeth."""
    from scipy.interpolate import Akima1DInterpolator

    stations, theta = cut.stations, cut.theta
    ends = [
        theta[at] + (theta[at] - theta[beside]) / (stations[at] - stations[beside]) * (np.array(places) - stations[at])
        for at, beside, places in ((0, 1, (low - 1.0, low)), (-1, -2, (high, high + 1.0)))
    ]
    places = np.concatenate(([low - 1.0, low], stations, [high, high + 1.0]))
    return Akima1DInterpolator(places, np.concatenate((ends[0], theta, ends[1])))
