"""Flanks of any kind with deviations along their normals, known at the points of a grid and smooth between them.

The grid's rows run along the tooth, its columns from root to tip. In the axial half plane it is a band between two
curves, and the band's own coordinates make it a square. A bicubic spline over the square interpolates all deviations.
It is collocated at the moved points, because `Offset` evaluates the amount there. So every point moves by exactly its
value, along the exact normal. Beyond the outermost rows and columns the spline continues straight.

The field is a field of space. It continues over the form point and also moves the surface that the tool's tip
generates. It fades from the form point to the end of the fillet, where it is 0 and the root begins as cut. Where flank
and fillet are tangent, they share points and normals, which move by the same amount, so that they stay tangent. Where
they meet in an edge, they end at their intersection. A very low fillet is too short for that: deviations begin to fade
on the flank, at MIN_FADE_SHARE of its height. Chamfers that the tool generates at the tip stay as cut, and end at their
intersection with the flank.

         land
        .-----
         |  flank: 1
         |
         +  form point
          \
           `--.____
       fillet: 10 q^3 - 15 q^4 + 6 q^5, q = 1 at the height of the form point, 0 at the height of the root
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.errors import ArgumentError
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.numeric.grid_spline import GridSpline
from gearmesh.kernel.surface.levels import Level
from gearmesh.kernel.surface.offset import Offset
from gearmesh.kernel.surface.stations import TrimError, along
from gearmesh.kernel.surface.surface import area_normal
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.micro_geometry.flank_field import Band, BandSpline, Fade, LevelField
from gearmesh.teeth.micro_geometry.modification import MAX_AMOUNT_SLOPE
from gearmesh.teeth.offset import smooth_at_form_point
from gearmesh.teeth.region import FILLET_REGIONS, FLANK_REGIONS, Side
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import ToothSide

#: key that a refusal names
DEVIATIONS_KEY = "deviations"
#: share of a flank along its edges without points, by default
EDGE_MARGIN = 0.1
#: smallest share of the flank's height over which deviations fade
MIN_FADE_SHARE = 0.08
#: largest error (mm, or share) of a deviation due to fading
MAX_FADE_ERROR = 1e-9
#: stations at which the ends of the fading are found
FADE_STATIONS = 17
#: points across flank and fillet at which a side is proved
PROOF_POINTS_ACROSS = 17


@dataclass(frozen=True)
class DeviationGrid:
    """Deviations of a flank at points of it, in its member's frame; positive: more material than nominal.

    `points`: (I, J, 3), mm, at least 2 by 2; rows from root to tip and columns from toe to heel, or back. `normals`:
    unit normals (I, J, 3). `values`: deviations (I, J), mm, along the normals.
    """

    points: Array
    normals: Array
    values: Array

    @staticmethod
    def of(
        tooth: Tooth, which: Side, values: ArrayLike, s: ArrayLike | None = None, t: ArrayLike | None = None
    ) -> DeviationGrid:
        """Return deviations of a flank at shares of the way along its profile and its face.

        `tooth`: whose flank is meant. `which`: the flank. `values`: deviations, mm: rows from root to tip, columns
        from toe to heel. `s`: shares of the way from form point to tip, ascending in 0..1; by default evenly spaced,
        0.1 from the edges. `t`: the same from toe to heel. Raises DesignError for values that are no table of numbers,
        and for other shares. Raises NoSolutionError for a tooth that cannot be trimmed.
        """
        values = np.asarray(values, dtype=float)
        if values.ndim != 2 or min(values.shape) < 2 or not np.isfinite(values).all():
            raise ArgumentError(
                DEVIATIONS_KEY, str(values.shape), allowed="finite numbers, mm, in 2 or more rows and columns"
            )
        places = [
            np.linspace(EDGE_MARGIN, 1.0 - EDGE_MARGIN, count) if given is None else np.asarray(given, dtype=float)
            for given, count in zip((s, t), values.shape, strict=True)
        ]
        for name, place, count in zip("st", places, values.shape, strict=True):
            inside = place.shape == (count,) and place[0] >= 0.0 and place[-1] <= 1.0
            if not (inside and (np.diff(place) > 0.0).all()):
                raise ArgumentError(name, str(place.tolist()), allowed=f"{count} ascending numbers from 0 to 1")
        grid = tooth.flank_grid(which, *places)
        return DeviationGrid(grid.points, grid.normals, values)

    def _spline(self, levels: tuple[Level, Level]) -> BandSpline:
        """Return the deviations as a function of the flank coordinates of two levels. Raises DesignError if the points
        are no grid.
        """

        def places(points: Array) -> Array:
            """Return the flank coordinates (..., 2), mm, of points (..., 3)."""
            return np.stack([level.value(points) for level in levels], axis=-1)

        nominal, moved = places(self.points), places(self.points + self.values[..., None] * self.normals)
        try:
            # the first coordinate from toe to heel, the second from root to tip
            band = Band.of(nominal)
            at, wanted = (
                np.stack([jet.f for jet in band.jets(place[..., 0], place[..., 1])], axis=-1)
                for place in (nominal, moved)
            )
            columns, rows = at[..., 0].mean(axis=0), at[..., 1].mean(axis=1)
            spline = GridSpline.near(columns, rows, np.swapaxes(wanted, 0, 1), self.values.T)
        except ValueError as error:
            raise ArgumentError(DEVIATIONS_KEY, reason=f"their points are no grid on the flank: {error}") from error
        return BandSpline(band, spline)


def with_deviations(member: Member, grids: Mapping[Side, DeviationGrid]) -> Member:
    """Return the member with deviations on one or both flanks of its teeth, the same on all teeth.

    Raises DesignError like `deviating_tooth`, and if its teeth differ.
    """
    return replace(member, tooth=deviating_tooth(member.one_tooth, grids))


def with_deviations_of_teeth(
    member: Member,
    which: Side,
    values: ArrayLike,
    teeth: Sequence[int],
    places: tuple[ArrayLike | None, ArrayLike | None] = (None, None),
) -> Member:
    """Return the member with deviations on one flank of some of its teeth.

    - `values`: deviations (I, J), mm, or (K, I, J), one grid for each tooth.
    - `teeth`: numbers (K,) of the teeth.
    - `places`: shares s and t as in `DeviationGrid.of`, on the present tooth with that number.

    Raises DesignError like `DeviationGrid.of` and `deviating_tooth`, and for numbers that no tooth has.
    """
    numbers = list(teeth)
    member.check_teeth(numbers)
    if not numbers or len(set(numbers)) < len(numbers):
        raise ArgumentError("teeth", numbers, allowed="one or more different numbers")
    given = np.asarray(values, dtype=float)
    if given.ndim == 3 and len(given) != len(numbers):
        raise ArgumentError(
            DEVIATIONS_KEY, str(given.shape), allowed=f"a grid for each of {len(numbers)} teeth, or one for all"
        )
    grids = given if given.ndim == 3 else [given] * len(numbers)
    made: dict[int, Tooth] = {}
    moved_teeth: dict[tuple[int, int], Tooth] = {}
    for number, grid in zip(numbers, grids, strict=True):
        tooth = member.tooth_at(number)
        # teeth that were alike and have the same grid stay alike
        key = id(tooth), -1 if given.ndim == 2 else number
        if key not in moved_teeth:
            moved_teeth[key] = deviating_tooth(tooth, {which: DeviationGrid.of(tooth, which, grid, *places)})
        made[number] = moved_teeth[key]
    return member.with_teeth(made)


def deviating_tooth(tooth: Tooth, grids: Mapping[Side, DeviationGrid]) -> Tooth:
    """Return the tooth with deviations on one or both of its flanks; parameters of its surfaces do not change, nor does
    its root.

    Raises DesignError in three cases:

    - the flank has corners.
    - the amounts are so steep or so large that the flank would lean or have cusps.
    - the tooth with deviations cannot be closed.
    """
    sides = {which: _side(tooth, which, grid) for which, grid in grids.items()}
    made = replace(tooth, right=sides.get(Side.RIGHT, tooth.right), left=sides.get(Side.LEFT, tooth.left))
    try:
        made.prove()
        for which in grids:
            _prove(made, which, tooth.side(which))
    except TrimError as error:
        raise ArgumentError(DEVIATIONS_KEY, reason=f"with them the tooth cannot be closed: {error}") from error
    return made


def _side(tooth: Tooth, which: Side, grid: DeviationGrid) -> ToothSide:
    """Return one side of a tooth with deviations of its flank."""
    side, levels = tooth.side(which), (tooth.blank.axial, tooth.blank.across)
    if side.creases or side.ridges:
        raise ArgumentError(
            DEVIATIONS_KEY,
            reason="a linear relief gives the flank a corner, over which deviations along its normals would tear it",
            allowed="flanks with parabolic or circular reliefs",
        )
    field = LevelField(levels, (grid._spline(levels), _fade(tooth, which, levels)))
    reached = field.jet(grid.points + grid.values[..., None] * grid.normals).value
    if np.abs(reached - grid.values).max() > MAX_FADE_ERROR:
        raise ArgumentError(
            DEVIATIONS_KEY,
            reason="points are where deviations fade towards the root",
            allowed=f"points farther from the root, as {EDGE_MARGIN:g} of the flank",
        )
    return replace(
        side,
        flank=Offset(side.flank, field),
        fillet=Offset(side.fillet, field),
        tip_corner=None if side.tip_corner is None else replace(side.tip_corner, crossed=True),
        tabulated=True,
        generated=side.generated or side,
        crossed=side.crossed or side.sharp or not smooth_at_form_point(side, tooth.blank),
        generation=None,
    )


def _fade(tooth: Tooth, which: Side, levels: tuple[Level, Level]) -> Fade:
    """Return the fading of a field over the fillet of a side, or over MIN_FADE_SHARE of the flank's height if that is
    more.
    """
    side, t = tooth.side(which), np.linspace(0.0, 1.0, FADE_STATIONS)
    stations = tooth.stations(t)
    form, tip = (levels[1].value(r) for r in tooth.flank_grid(which, [0.0, 1.0], t).points)
    root = levels[1].value(along(side.fillet, np.full_like(stations, side.root), stations, levels[0])[1].r)
    up = np.sign(tip - form)
    return Fade.between(stations, root + up * np.maximum(up * (form - root), MIN_FADE_SHARE * np.abs(tip - form)), root)


def lowest_share(tooth: Tooth, which: Side) -> float:
    """Share of the way from form point to tip above which deviations do not fade, to a hundredth.

    It is 0 unless the fading must begin on the flank.
    """
    levels, s = (tooth.blank.axial, tooth.blank.across), np.linspace(0.0, EDGE_MARGIN, round(100 * EDGE_MARGIN) + 1)
    r = tooth.flank_grid(which, s, np.linspace(0.0, 1.0, FADE_STATIONS)).points
    whole = (_fade(tooth, which, levels).jet(*(level.value(r) for level in levels)).f >= 1.0 - MAX_FADE_ERROR).all(
        axis=1
    )
    return float(s[whole.argmax()]) if whole.any() else EDGE_MARGIN


def _prove(tooth: Tooth, which: Side, before: ToothSide) -> None:
    """Refuse a side that leans or has cusps, compared with the side `before`."""
    sections, s = tooth.sections(np.linspace(0.0, 1.0, FADE_STATIONS)), np.linspace(0.0, 1.0, PROOF_POINTS_ACROSS)
    for region, surface in ((FLANK_REGIONS[which], before.flank), (FILLET_REGIONS[which], before.fillet)):
        grid = tooth.grid(region, s, sections)
        assert grid.jet is not None
        base = surface.jet(*np.moveaxis(grid.parameters, -1, 0))
        area_signs = [dot(area_normal(jet), jet.n) for jet in (grid.jet, base)]
        if (area_signs[0] * area_signs[1] <= 0.0).any():
            raise ArgumentError(
                DEVIATIONS_KEY, reason=f"{region} would have a cusp: they are larger than its radius of curvature"
            )
        if region.is_flank:
            cosine = float(dot(grid.jet.n, base.n).min())
            lean = float(np.sqrt(max(0.0, 1.0 - cosine**2))) / cosine
            if not 0.0 <= lean <= MAX_AMOUNT_SLOPE:
                raise ArgumentError(
                    DEVIATIONS_KEY,
                    reason=f"the flank would lean by {lean:.3g} mm/mm",
                    allowed=f"at most {MAX_AMOUNT_SLOPE:g} mm/mm, by smaller deviations or ones farther apart",
                )
