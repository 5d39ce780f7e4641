"""Flanks of any kind with deviations along their normals, known at the points of a grid and smooth between them.

The grid's rows run along the tooth, its columns from root to tip. Laid into the axial half plane it is a band between two curves,
whose own coordinates make it a square; over that a bicubic spline goes through all deviations, at the places to which they move the
points, for `Offset` asks for the amount there. So the points are moved by exactly what the grid says, along the exact normals.
Beyond the outermost rows and columns the deviations go on straight, as the spline leaves them.

The field is one of space and goes on over the form point: what the tool's tip generates is moved by it, too. There it fades, from
the form point to the end of the fillet, where nothing is left and the root begins as cut. Flank and fillet that pass into each
other smoothly have points and normals in common, which are moved by the same amount: they still do. Where they meet in an edge,
they end where they cross. Of a fillet that is hardly higher than nothing the way is too short: deviations begin to fade on the
flank, at SHORTEST of its height over the root. Chamfers that the tool generates at the tip stay as cut, and meet the flank where
they cross it.

         land
        .-----
         |  flank: 1
         |
         +  form point
          \
           `--.____
       fillet: 10 q^3 - 15 q^4 + 6 q^5, q = 1 at the height of the form point, 0 at that of the root
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.errors import ArgumentError
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.numeric.grid_spline import GridSpline
from gearmesh.kernel.surface.levels import Level
from gearmesh.kernel.surface.offset import Offset
from gearmesh.kernel.surface.stations import TrimError, along
from gearmesh.kernel.surface.surface import area_normal
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.micro_geometry.flank_field import Band, BandSpline, Fade, LevelField
from gearmesh.teeth.micro_geometry.modification import STEEPEST
from gearmesh.teeth.region import FILLETS, FLANKS, Side
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import ToothSide

#: name under which arguments are refused
KEY = "deviations"
#: shares of a flank beside its edges in which no points are, by default
MARGIN = 0.1
#: part of the flank's height over which deviations fade at least, and by how much (mm) a point may miss its own for that
SHORTEST, FADED = 0.08, 1e-9
#: stations at which the ends of what fades are found, and points across flank and fillet at which a side is proved
STATIONS, ACROSS = 17, 17


@dataclass(frozen=True)
class DeviationGrid:
    """Deviations `values` (I, J), mm, of a flank at `points` of it, along its `normals` (I, J, 3), in its member's frame.

    Rows go from root to tip, columns from toe to heel, or back; I and J are 2 at least. Positive: more material than nominal.
    """

    points: Array
    normals: Array
    values: Array

    @staticmethod
    def of(
        tooth: Tooth, which: Side, values: ArrayLike, s: ArrayLike | None = None, t: ArrayLike | None = None
    ) -> DeviationGrid:
        """Deviations of a flank at shares of the way along its profile and along its face.

        Parameters
        ----------
        tooth : Tooth
            Whose flank is meant.
        which : Side
            The flank.
        values : array of float (I, J)
            Deviations, mm: rows from root to tip, columns from toe to heel.
        s : array of float (I,), optional
            Shares of the way from form point to tip, ascending in 0..1; by default evenly spaced, 0.1 from the edges.
        t : array of float (J,), optional
            The same from toe to heel.

        Returns
        -------
        DeviationGrid
            In the frame of the tooth's member.

        Raises
        ------
        DesignError
            For values that are no table of numbers, and for other shares.
        NoSolutionError
            For a tooth that cannot be trimmed.

        Examples
        --------
        >>> gm.DeviationGrid.of(gears.members["pinion"].one_tooth, gm.Side.RIGHT, np.zeros((5, 9))).points.shape
        (5, 9, 3)
        """
        values = np.asarray(values, dtype=float)
        if values.ndim != 2 or min(values.shape) < 2 or not np.isfinite(values).all():
            raise ArgumentError(KEY, str(values.shape), allowed="finite numbers, mm, in 2 or more rows and columns")
        places = [
            np.linspace(MARGIN, 1.0 - MARGIN, count) if given is None else np.asarray(given, dtype=float)
            for given, count in zip((s, t), values.shape, strict=True)
        ]
        for name, place, count in zip("st", places, values.shape, strict=True):
            inside = place.shape == (count,) and place[0] >= 0.0 and place[-1] <= 1.0
            if not (inside and (np.diff(place) > 0.0).all()):
                raise ArgumentError(name, str(place.tolist()), allowed=f"{count} ascending numbers from 0 to 1")
        grid = tooth.flank_grid(which, *places)
        return DeviationGrid(grid.points, grid.normals, values)

    def _spline(self, levels: tuple[Level, Level]) -> BandSpline:
        """The deviations over the flank coordinates that two levels are. Raises DesignError where the points are no grid."""

        def places(points: Array) -> Array:
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
            raise ArgumentError(KEY, reason=f"their points are no grid on the flank: {error}") from error
        return BandSpline(band, spline)


def with_deviations(member: Member, grids: Mapping[Side, DeviationGrid]) -> Member:
    """The member with deviations on one of the flanks of its teeth or on both, of all alike.

    Raises DesignError as `deviating_tooth`, and where its teeth differ.
    """
    return replace(member, tooth=deviating_tooth(member.one_tooth, grids))


def with_deviations_of_teeth(
    member: Member,
    which: Side,
    values: ArrayLike,
    teeth: Sequence[int],
    places: tuple[ArrayLike | None, ArrayLike | None] = (None, None),
) -> Member:
    """The member with deviations `values` (I, J), mm, on one flank of the `teeth` of these numbers, or (K, I, J) for each its own.

    `places`: the shares s and t of `DeviationGrid.of`, on the tooth of that number as it is. Raises DesignError as that and
    `deviating_tooth`, and for other numbers.
    """
    numbers = list(teeth)
    member.check_teeth(numbers)
    if not numbers or len(set(numbers)) < len(numbers):
        raise ArgumentError("teeth", numbers, allowed="one or more different numbers")
    given = np.asarray(values, dtype=float)
    if given.ndim == 3 and len(given) != len(numbers):
        raise ArgumentError(KEY, str(given.shape), allowed=f"a grid for each of {len(numbers)} teeth, or one for all")
    grids = given if given.ndim == 3 else [given] * len(numbers)
    made: dict[int, Tooth] = {}
    alike: dict[tuple[int, int], Tooth] = {}
    for number, grid in zip(numbers, grids, strict=True):
        tooth = member.tooth_at(number)
        # teeth that were alike and have the same grid stay alike
        key = id(tooth), -1 if given.ndim == 2 else number
        if key not in alike:
            alike[key] = deviating_tooth(tooth, {which: DeviationGrid.of(tooth, which, grid, *places)})
        made[number] = alike[key]
    return member.with_teeth(made)


def deviating_tooth(tooth: Tooth, grids: Mapping[Side, DeviationGrid]) -> Tooth:
    """The tooth with deviations on one of its flanks or on both; parameters of its surfaces stay what they are, its root too.

    Raises DesignError where a flank has corners, where its amounts are so steep or so large that it would lean or have cusps, and
    where the tooth that has them cannot be closed.
    """
    sides = {which: _side(tooth, which, grid) for which, grid in grids.items()}
    made = replace(tooth, right=sides.get(Side.RIGHT, tooth.right), left=sides.get(Side.LEFT, tooth.left))
    try:
        made.prove()
        for which in grids:
            _prove(made, which, tooth.side(which))
    except TrimError as error:
        raise ArgumentError(KEY, reason=f"with them the tooth cannot be closed: {error}") from error
    return made


def _side(tooth: Tooth, which: Side, grid: DeviationGrid) -> ToothSide:
    """One side of a tooth with deviations of its flank."""
    side, levels = tooth.side(which), (tooth.blank.axial, tooth.blank.across)
    if side.creases or side.ridges:
        raise ArgumentError(
            KEY,
            reason="a linear relief gives the flank a corner, over which deviations along its normals would tear it",
            allowed="flanks with parabolic or circular reliefs",
        )
    field = LevelField(levels, (grid._spline(levels), _fade(tooth, which, levels)))
    reached = field.jet(grid.points + grid.values[..., None] * grid.normals).value
    if np.abs(reached - grid.values).max() > FADED:
        raise ArgumentError(
            KEY,
            reason="points are where deviations fade towards the root",
            allowed=f"points farther from the root, as {MARGIN:g} of the flank",
        )
    return replace(
        side,
        flank=Offset(side.flank, field),
        fillet=Offset(side.fillet, field),
        tip_corner=None if side.tip_corner is None else replace(side.tip_corner, crossed=True),
        tabulated=True,
        generated=side.generated or side,
        crossed=side.sharp,
        generation=None,
    )


def _fade(tooth: Tooth, which: Side, levels: tuple[Level, Level]) -> Fade:
    """What lets a field fade over the fillet of a side, or over the part SHORTEST of the flank's height where that is more."""
    side, t = tooth.side(which), np.linspace(0.0, 1.0, STATIONS)
    stations = tooth.stations(t)
    form, tip = (levels[1].value(r) for r in tooth.flank_grid(which, [0.0, 1.0], t).points)
    root = levels[1].value(along(side.fillet, np.full_like(stations, side.root), stations, levels[0])[1].r)
    up = np.sign(tip - form)
    return Fade.between(stations, root + up * np.maximum(up * (form - root), SHORTEST * np.abs(tip - form)), root)


def lowest_share(tooth: Tooth, which: Side) -> float:
    """The share of the way from form point to tip from which on deviations are whole, to a hundredth: 0, but where they have to
    begin to fade on the flank."""
    levels, s = (tooth.blank.axial, tooth.blank.across), np.linspace(0.0, MARGIN, round(100 * MARGIN) + 1)
    r = tooth.flank_grid(which, s, np.linspace(0.0, 1.0, STATIONS)).points
    whole = (_fade(tooth, which, levels).jet(*(level.value(r) for level in levels)).f >= 1.0 - FADED).all(axis=1)
    return float(s[whole.argmax()]) if whole.any() else MARGIN


def _prove(tooth: Tooth, which: Side, before: ToothSide) -> None:
    """Refuse a side of a tooth that leans, or has cusps, against what it was `before`."""
    sections, s = tooth.sections(np.linspace(0.0, 1.0, STATIONS)), np.linspace(0.0, 1.0, ACROSS)
    for region, surface in ((FLANKS[which], before.flank), (FILLETS[which], before.fillet)):
        grid = tooth.grid(region, s, sections)
        assert grid.jet is not None
        base = surface.jet(*np.moveaxis(grid.parameters, -1, 0))
        sense = [dot(area_normal(jet), jet.n) for jet in (grid.jet, base)]
        if (sense[0] * sense[1] <= 0.0).any():
            raise ArgumentError(KEY, reason=f"{region} would have a cusp: they are larger than its radius of curvature")
        if region.is_flank:
            cosine = float(dot(grid.jet.n, base.n).min())
            lean = float(np.sqrt(max(0.0, 1.0 - cosine**2))) / cosine
            if not 0.0 <= lean <= STEEPEST:
                raise ArgumentError(
                    KEY,
                    reason=f"the flank would lean by {lean:.3g} mm/mm",
                    allowed=f"at most {STEEPEST:g} mm/mm, by smaller deviations or ones farther apart",
                )
