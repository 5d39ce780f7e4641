"""Contours of a section for machines: as tangent arcs, splines or chords, or as parallels at an offset."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.cad.contours.curves import Contour
from gearmesh.cad.contours.parallel import parallels, points_along
from gearmesh.cad.contours.redrawn import Curves, redraw
from gearmesh.cad.section import MemberSection
from gearmesh.errors import ArgumentError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass

#: tolerance of a section whose normals are used, as a share of the tolerance of the drawn contours
BASE_TOLERANCE_SHARE = 0.25
#: largest tolerance of such a section
MAX_BASE_TOLERANCE_MM = 2.5e-5
#: smallest offset
MIN_OFFSET_MM = 0.01
#: spacing of the points that measure the stock left in corners
STOCK_SPACING_MM = 0.01
#: halvings in the search for the largest offset for which a contour has room
ROOM_HALVINGS = 14
#: parameters of the points of a curve that measure the extent of a contour
EXTENT_PLACES = np.linspace(0.0, 1.0, 9)


@dataclass(frozen=True)
class DrawnSection:
    """A section as written to a file, with its offset and the largest height (mm) of stock that a tool with this offset leaves."""

    cut: MemberSection
    offset: float
    stock: float = 0.0


def base_tolerance(kind: Curves, offset: float, tolerance: float) -> float:
    """Return the tolerance (mm) of the section that is drawn with curves of a kind at an offset within `tolerance`."""
    return (
        tolerance
        if kind is Curves.SPLINES and not offset
        else min(BASE_TOLERANCE_SHARE * tolerance, MAX_BASE_TOLERANCE_MM)
    )


def drawn_section(section: MemberSection, kind: Curves, offset: float, tolerance: float) -> DrawnSection:
    """Draw the contours of a section, or their parallels, with curves of a kind within `tolerance` (mm) of the exact ones.

    - `section`: known within `base_tolerance`
    - `offset`: mm, positive away from the material

    Raises ArgumentError if there is no room for the offset, NoSolutionError if the tolerance is not met.
    """
    if offset and abs(offset) < MIN_OFFSET_MM:
        raise ArgumentError("offset", offset, unit="mm", must_be=f"0, or at least {MIN_OFFSET_MM:g} mm either way")
    allowed = tolerance - section.deviation
    if not offset:
        if kind is Curves.SPLINES:
            return DrawnSection(section, 0.0)
        redrawings = [_redraw_contour(contour, kind, allowed) for contour in section.contours]
        contours, largest = tuple(contour for contour, _ in redrawings), max(miss for _, miss in redrawings)
        return DrawnSection(replace(section, contours=contours, deviation=section.deviation + largest), 0.0)
    _refuse_thin(section, offset)
    _refuse_large(section, offset)
    paths = [parallels(contour, offset, kind, allowed) for contour in section.contours]
    full = [contour for contour, (room, _) in zip(section.contours, paths, strict=True) if not room]
    if full:
        _refuse(section, full, offset, offset)
    contours = tuple(contour for drawn, _ in paths for contour in drawn)
    largest = max(miss for _, miss in paths)
    cut = replace(section, contours=contours, deviation=section.deviation + largest)
    return DrawnSection(cut, offset, _stock(section, cut, abs(offset)))


def _redraw_contour(contour: Contour, kind: Curves, tolerance: float) -> tuple[Contour, float]:
    pieces = [redraw(curve, kind, tolerance) for curve in contour.curves]
    curves = tuple(curve for redrawn, _ in pieces for curve in redrawn)
    return replace(contour, curves=curves), max(miss for _, miss in pieces)


def _refuse_large(section: MemberSection, offset: float) -> None:
    """Raise for an offset without room in the extent of a contour, and for an offset larger than the section."""
    extents = [_extent(contour) for contour in section.contours]
    full = [
        contour
        for contour, extent in zip(section.contours, extents, strict=True)
        if contour.material == (offset < 0.0) and 0.5 * extent.min() <= abs(offset)
    ]
    if full:
        least = min(0.5 * float(_extent(contour).min()) for contour in full)
        _refuse(section, full, float(np.copysign(least, offset)), offset)
    size = max(float(extent.max()) for extent in extents)
    if abs(offset) > size:
        # parallels at a larger distance are nearly circles
        raise ArgumentError(
            "offset",
            offset,
            unit="mm",
            reason=f"is more than the size of the {section.name}",
            allowed=f"{'at most' if offset > 0.0 else 'at least'} {_floor(float(np.copysign(size, offset))):g} mm",
        )


def _extent(contour: Contour) -> Array:
    """Return width and height (2,) of a contour, mm."""
    return np.asarray(np.ptp(np.concatenate([curve.at(EXTENT_PLACES) for curve in contour.curves]), axis=0))


def _refuse(section: MemberSection, full: list[Contour], high: float, offset: float) -> None:
    """Raise for contours without room for an offset up to `high`, with the largest offset for which all have room."""
    low, contour = 0.0, full[0]
    for _ in range(ROOM_HALVINGS):
        middle = 0.5 * (low + high)
        without = next((c for c in full if not parallels(c, middle, Curves.ARCS, 0.1 * abs(high))[0]), None)
        low, high = (middle, high) if without is None else (low, middle)
        contour = without or contour
    what = f"the {contour.name.replace('_', ' ')} of the {section.name}"
    raise ArgumentError(
        "offset",
        offset,
        unit="mm",
        reason=f"{what} has no room for it",
        allowed=f"{'less than' if offset > 0.0 else 'more than'} {_floor(low):g} mm",
    )


def _refuse_thin(section: MemberSection, offset: float) -> None:
    """Raise if two contours are closer to each other than twice an offset into the material between them."""
    from scipy.spatial import cKDTree

    if offset > 0.0 or len(section.contours) < 2:
        return
    apart = 0.1 * min(abs(offset), 0.01 * max(float(_extent(contour).max()) for contour in section.contours))
    points = [points_along(contour.curves, apart) for contour in section.contours]
    for k, contour_points in enumerate(points):
        for j in range(k):
            thick = float(cKDTree(contour_points).query(points[j])[0].min())
            if thick <= 2.0 * abs(offset):
                names = [section.contours[i].name for i in (j, k)]
                raise ArgumentError(
                    "offset",
                    offset,
                    unit="mm",
                    reason=f"between {names[0]} and {names[1]} of the {section.name} are {thick:.4g} mm",
                    allowed=f"more than {-_floor(0.5 * thick):g} mm",
                )


def _floor(value: float) -> float:
    """Round a value to three digits, towards 0."""
    scale = 10.0 ** (np.floor(np.log10(abs(value))) - 2.0) if value else 1.0
    return float(np.trunc(value / scale) * scale)


def _stock(section: MemberSection, cut: MemberSection, distance: float) -> float:
    """Return a bound of the height (mm) of left stock: the distance of the section from the tool's path beyond `distance`."""
    from scipy.spatial import cKDTree

    points, path = (
        points_along([c for contour in of.contours for c in contour.curves], STOCK_SPACING_MM) for of in (section, cut)
    )
    near, _ = cKDTree(path).query(points)
    # subtract the error of the distance between points of the path
    return max(0.0, float(near.max()) - distance - 0.5 * STOCK_SPACING_MM**2 / distance)
