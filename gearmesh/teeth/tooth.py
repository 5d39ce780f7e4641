"""A tooth: flanks, fillets and lands trimmed against each other and by the blank, on grids (s, t).

t in [0, 1] runs from toe to heel, s along each link of the section (see `section`). "right" is y < 0 of a tooth centred on
+x (ISO 21771). Fillets are what the tool's tip generates; where they undercut the flank, both end at their true intersection.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.kernel.envelope.limiting_line import area_density
from gearmesh.kernel.motion.joint import REVOLUTE_JOINT, Joint
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.numeric.roots import last_true
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.kernel.surface.stations import TrimError, along, follow
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.teeth.blank.blank import Blank
from gearmesh.teeth.blank.development import Development
from gearmesh.teeth.blank.end_edge import SHARP
from gearmesh.teeth.blank.tip_edge import TipEdge
from gearmesh.teeth.end_strip import EndStrip, SharpOutline, StripPiece
from gearmesh.teeth.region import EDGES, FILLETS, FLANKS, Region, Side
from gearmesh.teeth.section import (
    BottomLink,
    DrawnLink,
    Ends,
    GeneratedLink,
    Grid,
    Link,
    Sections,
    TurnedLink,
    parameter,
)
from gearmesh.teeth.tip_surface import drawn_edge_surface
from gearmesh.teeth.tooth_side import Bottom, TipCorner, ToothSide
from gearmesh.teeth.undercut import Undercut, cut_off, form_point, intersection, singular_stations, trim_tolerance

#: stations at which the beginning of undercut is looked for
BREAK_SAMPLES = 17
#: nodes of Gauss's rule along a generatrix, on which products of three coordinates are polynomials of degree 4
ACROSS = 3
#: stations at which a flank is searched for loops with two cusps
FOLD_STATIONS = 5
#: distance from where undercut begins or ends at which a flank with such a loop is tried
BESIDE = 1e-6
#: stations, evenly spaced, whose sections are kept
EVEN_STATIONS = 25
#: heights of the tooth that a face counts as wide, at most
MOST_HEIGHTS = 64
#: stations in a turn of a tooth that winds round its axis
TURN_STATIONS = 24
#: threads go round so many times as far as along their axis, at the tip; places at which it is asked each way whether flanks are
#: screw surfaces, and by what share of itself their advance may differ
STEEP, SCREW_PLACES, SAME_SCREW = 1.8, 3, 1e-6
#: share of their mean by which the advances of both sides may differ, of threads of two leads
MOST_APART = 0.5
#: samples of a flank in which its tip is looked for, and how far from the form point, over what it is nominally
TIP_SAMPLES, FARTHEST_TIP = 33, 1.5
#: radius of a tip, over that of the form point, from which on the tooth is followed up to it, at so many points of its flanks
FAR_TIP, WAY_STATIONS = 2.0, 65
#: fewest teeth of which this is done: threads of worms are wider than half a turn at their form point
FEWEST_TEETH = 3
#: stations of a stretch of the face along which the width of a land is followed
LAND_STATIONS = 9
#: stations at which a tooth is tried before anything else is made of it
PROOF_STATIONS = 9
#: share of the tooth's height by which a flank that is followed along the face may miss its tip
TIP_OFF_SHARE = 1e-6
#: share of a link from its ends within which a break is none of its seams
CLOSEST = 1e-3
#: parts of the way to a tip that are left, one after the other, where Newton does not go there at once
TOWARDS_TIP = (0.75, 0.5, 0.25, 0.0)
#: half the step of s over which drawn curves are differentiated
HALF_STEP = 1e-6
#: rounds, and parts in each, in which the interval between two of them is divided: places cost less than rounds
BREAK_ROUNDS, BREAK_PARTS = 5, 256

#: flank parameters (T,) and jets of the tips of the right and the left side
Tips = tuple[tuple[Array, Jet], tuple[Array, Jet]]


@dataclass(frozen=True)
class Tooth:
    """One tooth of a member with `teeth` teeth, centred on +x at the middle station.

    `bottom`: the root where it is no surface of revolution; the blank's is then the one through its middle. `joint`: in which
    the teeth follow each other.

    Raises TrimError from its methods where the chain cannot be closed.
    """

    teeth: int
    right: ToothSide
    left: ToothSide
    blank: Blank
    tip_edge: TipEdge | None = None
    bottom: Bottom | None = None
    joint: Joint = REVOLUTE_JOINT

    @property
    def pitch_angle(self) -> float:
        return self.joint.pitch(self.teeth)

    def side(self, side: Side) -> ToothSide:
        """The generated surfaces of one side.

        Parameters
        ----------
        side : Side
            "right" or "left".

        Returns
        -------
        ToothSide

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> tooth.side("right") is tooth.right
        True
        """
        return self.right if Side(side) is Side.RIGHT else self.left

    @cached_property
    def chain(self) -> dict[Region, Link]:
        """Links of the chain in order."""
        blank = self.blank
        right, left = (self._links(side) for side in Side)
        pitch = self.pitch_angle

        def root(sections: Sections) -> tuple[Array, Array]:
            return sections.left.root_angle - pitch, sections.right.root_angle

        links: list[Link] = [TurnedLink(Region.ROOT, blank.root.surface, blank.axial, root), *right]
        if self.bottom is not None:
            links[0] = BottomLink(Region.ROOT, self.bottom.surface, blank.axial, self.bottom.ends)
        links += [self._top(), *left[::-1]]
        return {link.region: link for link in links}

    @cached_property
    def tip_edges(self) -> dict[Side, Surface]:
        """Surfaces of chamfers or roundings of the tip by sides, none where the tip is sharp: the tool's envelope with its own
        parameters, or a drawn edge with parameters (s, z), s from 0 at the flank to 1 at the land."""
        surfaces: dict[Side, Surface] = {}
        for side in Side:
            link = self.chain.get(EDGES[side])
            if isinstance(link, DrawnLink):
                surfaces[side] = drawn_edge_surface(link, self.sections, self.smooth_stretches)
            elif link is not None and link.surface is not None:
                surfaces[side] = link.surface
        return surfaces

    def tip_edge_grid(self, which: Side, s: Array) -> Grid | None:
        """Points of the tip edge of one side at even stations, with the parameters of its surface.

        Parameters
        ----------
        which : Side
            "right" or "left".
        s : numpy.ndarray
            Shares (S,) of the way from the flank to the land, ascending.

        Returns
        -------
        Grid or None
            Points and normals (S, T, 3), own frame, mm; None where the tip is sharp.

        Examples
        --------
        >>> gears.members["pinion"].tooth.tip_edge_grid(gm.Side.RIGHT, np.array([0.0, 1.0])) is None
        True
        """
        link = self.chain.get(EDGES[which])
        if link is None:
            return None
        if not isinstance(link, DrawnLink):
            return link.grid(s if which is Side.RIGHT else 1.0 - s, self.even)
        p, v = np.broadcast_arrays(s[:, None], self.even.stations)
        jet = self.tip_edges[which].jet(p, v)
        return Grid(jet.r, jet.n, jet, p, v)

    def _top(self) -> TurnedLink:
        """The link between the tips of both sides."""

        def land(sections: Sections) -> tuple[Array, Array]:
            return sections.right.tip_angle, sections.left.tip_angle

        return TurnedLink(Region.LAND, self.blank.tip.surface, self.blank.axial, land)

    def _links(self, which: Side) -> list[Link]:
        """Links of one side, from the root to the land."""
        side, axial = self.side(which), self.blank.axial

        def fillet(ends: Ends) -> tuple[Array, Array]:
            return np.full_like(ends.form_point_fillet, side.root), ends.form_point_fillet

        links: list[Link] = [
            self._add_seams(GeneratedLink(FILLETS[which], which, side.fillet, axial, fillet), side.fillet_breaks),
            self._flank(which),
        ]
        if side.tip_corner is not None:
            end = side.tip_corner.end

            def tip_corner(ends: Ends) -> tuple[Array, Array]:
                return ends.tip_corner, np.full_like(ends.tip_corner, end)

            links.append(GeneratedLink(EDGES[which], which, side.tip_corner.surface, axial, tip_corner))
        elif self.tip_edge is not None:
            links.append(DrawnLink(EDGES[which], which, self.tip_edge, axial))
        return links

    def _flank(self, which: Side) -> GeneratedLink:
        side = self.side(which)
        flank = GeneratedLink(
            FLANKS[which], which, side.flank, self.blank.axial, lambda ends: (ends.form_point_flank, ends.tip)
        )
        return self._add_seams(flank, side.flank_breaks)

    def _add_seams(self, link: GeneratedLink, breaks: tuple[float, ...]) -> GeneratedLink:
        """The link with seams at those of its breaks that it has all along the face."""
        if not breaks:
            return link
        first, last = (end[:, None] for end in link.ends(self._coarse_ends(link.side)))
        share = (np.sort(breaks) - first) / (last - first)
        inside = ((share > CLOSEST) & (share < 1.0 - CLOSEST)).all(axis=0)
        seams = [(float(s), float(p)) for s, p in zip(share[0, inside], np.sort(breaks)[inside], strict=True)]
        if link.side is Side.LEFT:
            seams = [(1.0 - s, p) for s, p in seams]
        return replace(link, seams=tuple(sorted(seams)))

    def _coarse_ends(self, which: Side) -> Ends:
        """Where the links of one side end at a few stations from the middle, the first of them, outwards."""
        return self.ends(which, np.array([0.5, 0.0, 0.25, 0.75, 1.0]))

    @cached_property
    def sharp_ends(self) -> Tooth:
        """The tooth whose links go on to the end faces."""
        return self if self.blank.ends == SHARP else replace(self, blank=self.blank.sharp)

    @cached_property
    def end_strips(self) -> tuple[EndStrip | None, EndStrip | None]:
        """The broken edges of its end faces at toe and heel, None where there is none. Raises TrimError where one has no room."""
        toe, heel = (self._end_strip(end) for end in (0, 1))
        return toe, heel

    def _end_strip(self, end: int) -> EndStrip | None:
        chamfer, at = self.blank.ends[end], np.array([float(end)])
        if chamfer is None:
            return None
        both = self, self.sharp_ends
        chains, sections = (self.chain, both[1].chain), (self.sections(at), both[1].sections(at))
        step = self.joint.to(self.pitch_angle)
        return EndStrip(chains, sections, Development(self.blank.axial, self.joint), chamfer, step)

    @cached_property
    def sharp_outlines(self) -> tuple[SharpOutline, SharpOutline]:
        """The outlines of its end faces at toe and heel with sharp edges."""
        sharp, plane = self.sharp_ends, Development(self.blank.axial, self.joint)
        step = self.joint.to(self.pitch_angle)
        toe, heel = (SharpOutline(sharp.chain, sharp.sections([end]), plane, step) for end in (0.0, 1.0))
        return toe, heel

    @property
    def regions(self) -> tuple[Region, ...]:
        """Regions of the links in order."""
        return tuple(self.chain)

    @cached_property
    def breaks(self) -> Array:
        """Stations t inside (0, 1) that are lines of every grid: where undercut begins or ends, so that the form point of flank and
        fillet has a corner, and where the flanks are not smooth along the face."""
        return np.unique(np.concatenate([*(self.breaks_of(side) for side in Side), self.face_breaks]))

    @cached_property
    def face_breaks(self) -> Array:
        """Stations t inside (0, 1) where the flanks, or their tips, are not smooth along the face."""
        return self._inner([*self.right.face_breaks, *self.left.face_breaks, *self.blank.corners])

    def creases(self, region: Region) -> Array:
        """Stations where the surface of a link has a corner along the face.

        Parameters
        ----------
        region : Region
            Of the link: a flank, a fillet, the land or the root.

        Returns
        -------
        numpy.ndarray
            t (K,) inside (0, 1), ascending.

        Examples
        --------
        >>> gears.members["pinion"].tooth.creases("land").size
        0
        """
        blank, sides = self.blank, (*self.right.face_breaks, *self.left.face_breaks)
        ends = {Region.LAND: blank.tip.corners(blank.axial), Region.ROOT: blank.root.corners(blank.axial)}
        return self._inner([*sides, *ends.get(region, ())])

    def _inner(self, places: list[float]) -> Array:
        """t inside (0, 1), ascending, of station coordinates (mm)."""
        toe, heel = self.blank.extent
        t = (np.array(places) - toe) / (heel - toe)
        return np.unique(t[(t > 0.0) & (t < 1.0)])

    @property
    def smooth_stretches(self) -> tuple[float, ...]:
        """t from 0 to 1 between which quadrature of sections is exact: breaks of the face, and where higher derivatives jump."""
        return (0.0, *np.union1d(self.face_breaks, self._bends).tolist(), 1.0)

    @property
    def _bends(self) -> Array:
        """t inside (0, 1), ascending, where higher derivatives jump along the face."""
        return self._inner([*self.right.face_bends, *self.left.face_bends])

    @cached_property
    def unmodified_tooth(self) -> Tooth:
        """The tooth as its tools leave it."""
        right, left = (side.generated or side for side in (self.right, self.left))
        return self if (right, left) == (self.right, self.left) else replace(self, right=right, left=left)

    def breaks_of(self, which: Side) -> Array:
        """Stations where undercut of one side begins or ends.

        Parameters
        ----------
        which : Side
            "right" or "left".

        Returns
        -------
        numpy.ndarray
            t (K,) inside (0, 1), ascending.

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> tooth.breaks_of("right").size
        0
        """
        side = self.side(which)
        return _changes(lambda t: self._cut_off(side, t))

    def _cut_off(self, side: ToothSide, t: Array) -> NDArray[np.bool_]:
        """Stations t (T,) where the flank is undercut, at the tool's form point or before it."""
        cut, odd = self._cut_off_at_form_point(side, t)
        if not self._folds(side):
            return cut
        stations, axial = self.stations(t), self.blank.axial
        folded = singular_stations(side, stations, axial)
        if odd.any():
            folded[odd] = singular_stations(side, stations[odd], axial, self._tip(side, stations[odd], t[odd])[0])
        return cut | folded

    def _cut_off_at_form_point(self, side: ToothSide, t: Array) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Where the flank is undercut at the tool's form point, and where its nominal tip says nothing of that, at t (T,)."""
        stations, axial = self.stations(t), self.blank.axial
        sound, odd = self._nominal_tip(side, t)
        cut = cut_off(side, sound, stations, axial)
        if odd.any():
            cut[odd] = cut_off(side, self._tip(side, stations[odd], t[odd])[1], stations[odd], axial)
        return cut, odd

    def _nominal_tip(self, side: ToothSide, t: Array) -> tuple[Jet, NDArray[np.bool_]]:
        """The flank's jet at its nominal tip at t (T,), and where that is none, or turned inside out against mid face: steep flanks
        reach the tip far from there."""
        which = Side.RIGHT if side is self.right else Side.LEFT
        if which not in self._senses and 0.5 not in t:
            self._nominal_tip(side, np.array([0.5]))
        stations = self.stations(t)
        nominal = follow(side.flank, np.full_like(stations, side.tip), stations, self.blank.axial)
        density = area_density(nominal.jet)
        sense = self._senses.setdefault(which, float(density[np.abs(t - 0.5).argmin()]))
        odd: NDArray[np.bool_] = ~(nominal.converged & (density * sense > 0.0))
        return nominal.jet, odd

    def find_undercut(self) -> None:
        """Find out where flanks are undercut, unless it is known; sections go by it from then on, which changes their rounding.

        Raises
        ------
        TrimError
            Where the tooth cannot be trimmed.

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> tooth.find_undercut()
        """
        for which in Side:
            if which not in self._undercut:
                self.ends(which, np.linspace(0.0, 1.0, PROOF_STATIONS))

    def near_tips(self, which: Side, t: Array) -> Array:
        """Where on the flank's profile points near the tip are sound.

        The nominal tip, or where that says nothing, as of steep flanks, the true one.

        Parameters
        ----------
        which : Side
            "right" or "left".
        t : numpy.ndarray
            Stations (T,) from 0 at the toe to 1 at the heel.

        Returns
        -------
        numpy.ndarray
            Profile parameters (T,).

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> tooth.near_tips("right", np.array([0.5])).shape
        (1,)
        """
        side, odd = self.side(which), self._nominal_tip(self.side(which), t)[1]
        p = np.full(t.shape, side.tip)
        if odd.any():
            p[odd] = self._tip(side, self.stations(t[odd]), t[odd])[0]
        return p

    @cached_property
    def _senses(self) -> dict[Side, float]:
        """Area densities of flanks at their nominal tip at mid face, as soon as they were asked for."""
        return {}

    def _folds(self, side: ToothSide) -> bool:
        """Whether the flank of a side turns back and forth again anywhere before its form point.

        A loop with two cusps is wide, or narrow and next to where the form point itself is cut off no longer.
        """
        which = Side.RIGHT if side is self.right else Side.LEFT
        if which not in self._folded_sides:
            t = np.linspace(0.0, 1.0, FOLD_STATIONS)
            sound = t[~self._cut_off_at_form_point(side, t)[0]]
            if sound.size < t.size:
                sound = np.append(sound, _changes(lambda t: self._cut_off_at_form_point(side, t)[0]))
            self._folded_sides[which] = bool(
                sound.size and singular_stations(side, self.stations(sound), self.blank.axial).any()
            )
        return self._folded_sides[which]

    def stations(self, t: ArrayLike) -> Array:
        """Coordinates of stations between toe and heel.

        Parameters
        ----------
        t : array_like
            Stations (T,) from 0 at the toe to 1 at the heel.

        Returns
        -------
        numpy.ndarray
            (T,), mm: z, of conical teeth the distance along the cone.

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> tooth.stations([0.0, 0.5, 1.0]).round(6).tolist()
        [-5.0, 0.0, 5.0]
        """
        toe, heel = self.blank.extent
        return toe + (heel - toe) * np.asarray(t, dtype=float)

    def sections(self, t: ArrayLike) -> Sections:
        """Both sides, trimmed at stations.

        Parameters
        ----------
        t : array_like
            Stations (T,) from 0 at the toe to 1 at the heel.

        Returns
        -------
        Sections
            Where fillets, flanks and tips end, and the polar angles of tips and roots, rad.

        Raises
        ------
        TrimError
            Where the tooth cannot be trimmed there.

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> tooth.sections([0.5]).right.tip_angle.shape
        (1,)
        """
        t = np.atleast_1d(np.asarray(t, dtype=float))
        return self._sections(t, self._tips(t))

    def _sections(self, t: Array, tips: Tips) -> Sections:
        """The same where the flanks' tips are known."""
        stations = self.stations(t)
        right, left = (self._ends(side, t, tip) for side, tip in zip(Side, tips, strict=True))
        # threads go round the axis many times: their angles run on; lands are less than half a turn wide, but of the run-outs of a
        # single thread, roots less than three quarters
        right = replace(right, tip_angle=self.joint.running(right.tip_angle))
        left = replace(left, root_angle=self.joint.running(left.root_angle))
        width = self._width_of_land(right.tip_angle, left.tip_angle, t)
        before = left.root_angle - self.pitch_angle
        root = self._width_of_root(right.root_angle, before, t)
        right, left = replace(right, root_angle=before + root), replace(left, tip_angle=right.tip_angle + width)
        return Sections(t, stations, right, left)

    def ends(self, which: Side, t: Array) -> Ends:
        """Where fillet and flank of one side end; the other side is not asked.

        Parameters
        ----------
        which : Side
            "right" or "left".
        t : numpy.ndarray
            Stations (T,) from 0 at the toe to 1 at the heel.

        Returns
        -------
        Ends
            Without the angle of the root (NaN).

        Raises
        ------
        TrimError
            Where the tooth cannot be trimmed there.

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> tooth.ends("right", np.array([0.5])).tip_angle.shape
        (1,)
        """
        return self._ends(which, t, self._tip(self.side(which), self.stations(t), t), root=False)

    @cached_property
    def even(self) -> Sections:
        """Sections at EVEN_STATIONS from toe to heel, made once: what contact, clearance and the like start from.

        There are more, two for every tooth's height, where the face is wide: contact is about as long as teeth are high; and so
        many for every turn of a thread.
        """
        toe, heel = self.blank.extent
        wide = 2 * int(np.ceil(min(abs(heel - toe) / self.height, MOST_HEIGHTS))) + 1
        wound = int(np.ceil(TURN_STATIONS * self.windings)) + 1
        return self.sections(np.linspace(0.0, 1.0, max(wide, wound, EVEN_STATIONS)))

    @cached_property
    def height(self) -> float:
        """Height (mm) of the tip over the root, at mid face."""
        return abs(float(self.blank.root.value(self._middle_tip.r)[0]))

    @cached_property
    def windings(self) -> float:
        """How often it goes round its axis along the face, by its slope at mid face; 0 of what slides."""
        tip, (toe, heel) = self._middle_tip, self.blank.extent
        along_axis, around = self.blank.axial.gradient(tip.r), self.joint.velocity(Rigid.identity(), tip.r)
        spin = float(np.linalg.norm(self.joint.spin(Rigid.identity())))
        turning = float((dot(tip.n, along_axis) / dot(tip.n, around))[0])
        return spin * abs((heel - toe) * turning) / (2.0 * np.pi)

    @cached_property
    def screw(self) -> float | None:
        """Axial advance (mm/rad, negative of left-hand threads) of a thread; None of other teeth.

        Threads are screw surfaces, as their tools leave them, whose way along the helix is `STEEP` times that along the axis; with
        a screw parameter for either side it is their mean. Run-outs at their ends are none: the middle between bends counts.
        """
        if self.joint.travel is not None or self.windings == 0.0:
            return None
        tooth, screws = self.unmodified_tooth, []
        ends = np.array([0.0, *self._bends, 1.0])
        along = np.linspace(ends[ends < 0.5].max(), ends[ends > 0.5].min(), SCREW_PLACES)
        for side in Side:
            grid = tooth.flank_grid(side, np.linspace(0.0, 1.0, SCREW_PLACES), along)
            # of a screw surface the motion along the helix is at right angles to all normals
            around = grid.points[..., 1] * grid.normals[..., 0] - grid.points[..., 0] * grid.normals[..., 1]
            own = around / grid.normals[..., 2]
            if not np.ptp(own) <= SAME_SCREW * abs(own.mean()):
                return None
            screws.append(float(own.mean()))
        screw, apart = 0.5 * sum(screws), abs(screws[0] - screws[1])
        reach = float(self.joint.radius(self._middle_tip.r)[0])
        # teeth that taper, as beveloids do, wind to either side
        return screw if reach > STEEP * abs(screw) and apart < MOST_APART * abs(screw) else None

    @property
    def sharp_tip(self) -> Tooth:
        """The tooth without what is drawn at its tip: rounding or chamfer."""
        return self if self.tip_edge is None else replace(self, tip_edge=None)

    @cached_property
    def _middle_tip(self) -> Jet:
        """The right side's tip at mid face (1,)."""
        return self._tip(self.right, self.stations([0.5]), np.array([0.5]))[1]

    @cached_property
    def _folded_sides(self) -> dict[Side, bool]:
        return {}

    @cached_property
    def _undercut(self) -> dict[Side, Undercut]:
        """Where sides are undercut, as soon as one was trimmed from toe to heel: to look for it anew costs most of a trimming."""
        return {}

    def prove(self) -> None:
        """Trim the tooth at many stations from toe to heel, and where loops of flanks with two cusps end.

        Raises
        ------
        TrimError
            Where it cannot be trimmed, naming the station.

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> tooth.prove()
        """
        t = np.linspace(0.0, 1.0, PROOF_STATIONS)
        tips = self._tips(t)
        self._prove_land(t, tips)
        looped = [self.breaks_of(which) for which in Side if self._folds(self.side(which))]
        if looped:
            beside = np.concatenate(looped)[:, None] + np.array([-BESIDE, BESIDE])
            t = np.append(t, np.clip(beside, 0.0, 1.0))
            tips = self._tips(t)
        self._sections(t, tips)

    @property
    def has_loops(self) -> bool:
        """Whether a flank has a loop with two cusps before its form point, whose ends take `prove` a hundred times the work of a
        section to find."""
        return any(self._folds(self.side(which)) for which in Side)

    def prove_land(self, t: Array) -> None:
        """Trim the flanks at the tip alone, a fiftieth of the work.

        Tip roundings and chamfers are known to `sections` alone.

        Parameters
        ----------
        t : numpy.ndarray
            Stations (T,) from 0 at the toe to 1 at the heel.

        Raises
        ------
        TrimError
            Where the tooth is pointed, or a flank turns back along the face near its tip.

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> tooth.prove_land(np.array([0.0, 1.0]))
        """
        self._prove_land(t, self._tips(t))

    def _prove_tips(self, t: Array, tips: Tips) -> None:
        """Raise TrimError where a flank, followed along the face as grids do it, misses its tip."""
        stations = self.stations(t)
        for which, (p, jet) in zip(Side, tips, strict=True):
            followed = follow(self.side(which).flank, p, stations, self.blank.axial)
            apart = np.linalg.norm(followed.jet.r - jet.r, axis=-1)
            off = ~(apart <= TIP_OFF_SHARE * self.height)
            if off.any():
                worst = float(t[int(np.argmax(off))])
                raise TrimError("tip", worst, "the flank turns back along the face near its tip")

    def _prove_land(self, t: Array, tips: Tips) -> None:
        if self.tip_edge is None and self.right.tip_corner is None:
            right, left = (self.joint.angle(jet.r) for _, jet in tips)
            self._width_of_land(right, left, t)
        self._prove_tips(t, tips)

    def prove_root(self, t: Array) -> None:
        """Follow the fillets' ends at the root alone, a tenth of the work.

        Parameters
        ----------
        t : numpy.ndarray
            Stations (T,) from 0 at the toe to 1 at the heel.

        Raises
        ------
        TrimError
            Where the fillets of a space overlap.

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> tooth.prove_root(np.array([0.0, 1.0]))
        """
        right, left = (self._root_angle(self.side(side), self.stations(t)) for side in Side)
        self._width_of_root(right, self.joint.running(left) - self.pitch_angle, t)

    @cached_property
    def root_ends(self) -> Array:
        """Where the fillets of its right and left side begin at the root, (2, PROOF_STATIONS, 3), mm."""
        stations = self.stations(np.linspace(0.0, 1.0, PROOF_STATIONS))
        sides = (self.side(which) for which in Side)
        return np.array([self._root_jet(side, stations).r for side in sides])

    def root_middle(self, z: Array) -> Array:
        """The middle of the root before a rack's tooth, as its tools leave it: where bars end.

        Parameters
        ----------
        z : numpy.ndarray
            Places (...,) along the face, mm.

        Returns
        -------
        numpy.ndarray
            y (...,), mm.

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> tooth.root_middle(np.zeros(1)).shape
        (1,)
        """
        right, left = self.unmodified_tooth.sharp_ends.root_ends
        middle = 0.5 * (right + left - self.joint.to(self.pitch_angle).translation)
        return np.asarray(np.interp(z, middle[:, 2], middle[:, 1]))

    def grid(self, region: Region, s: ArrayLike, sections: Sections) -> Grid:
        """Exact points and normals of one link of the tooth's outline.

        Parameters
        ----------
        region : Region
            Which link, as "flank_right".
        s : array_like
            Share (S,), or (S, T), of the way along it.
        sections : Sections
            Where links end at T stations.

        Returns
        -------
        Grid
            Points and normals (S, T, 3), own frame, mm.

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> tooth.grid(next(iter(tooth.chain)), [0.0, 1.0], tooth.sections([0.5])).points.shape
        (2, 1, 3)
        """
        return self.chain[region].grid(s, sections)

    def flank_grid(self, which: Side, s: ArrayLike, t: ArrayLike) -> Grid:
        """Exact points and normals of a trimmed flank; the other side is not asked.

        Parameters
        ----------
        which : Side
            "right" or "left".
        s : array_like
            Shares (S,) of the way from the form point to the tip.
        t : array_like
            Stations (T,) from 0 at the toe to 1 at the heel.

        Returns
        -------
        Grid
            Points and normals (S, T, 3), own frame, mm.

        Raises
        ------
        TrimError
            Where the tooth cannot be trimmed there.

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> tip = tooth.flank_grid("right", [1.0], [0.5]).points[0, 0]
        >>> print(f"{np.hypot(*tip[:2]):.3f}")
        20.000
        """
        which = Side(which)
        t, s = np.atleast_1d(np.asarray(t, dtype=float)), np.asarray(s, dtype=float)[:, None]
        ends = self.ends(which, t)
        return self._flank(which).between(s if which is Side.RIGHT else 1.0 - s, ends, self.stations(t))

    def volume(self, order: int = 24) -> float:
        """Volume of all teeth and the body, by Gauss quadrature of exact section areas.

        A section is a cone, plane or cylinder of a constant station down to a floor, the straight line between the ends of
        the body's profile. With u along its generatrix its area is the integral of rho du over the polar angle, and the
        volume that of the areas over the station. Floor and profile enclose the rest, a solid of revolution.

        Parameters
        ----------
        order : int
            Points of a rule.

        Returns
        -------
        float
            mm^3.

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> volume = tooth.volume()
        >>> abs(volume - tooth.volume(order=32)) < 1e-6 * volume
        True
        """
        return self.teeth * self._swept(order) - self.blank.body.enclosed_volume()

    def _swept(self, order: int) -> float:
        """Volume (mm^3) between the links of one tooth and the floor under them."""
        nodes, weights = np.polynomial.legendre.leggauss(order)
        nodes, weights = 0.5 * (nodes + 1.0), 0.5 * weights
        total = 0.0
        for low, high in pairwise(self.smooth_stretches):
            sections = self.sections(low + (high - low) * nodes)
            area = np.zeros(order)
            for link in self.chain.values():
                for first, last in pairwise((0.0, *(s for s, _ in link.seams), 1.0)):
                    width = last - first
                    area += width * weights @ self._area_density(link, first + width * nodes, sections)
            total += (high - low) * float(weights @ area)
        toe, heel = self.blank.extent
        return float((heel - toe) * total) + sum(self._strip_volume(end, nodes, weights) for end in (0, 1))

    def _strip_volume(self, end: int, nodes: Array, weights: Array) -> float:
        """Volume (mm^3) of a tooth over the floor within the depth of the chamfer at an end, 0 where there is none."""
        strip = self.end_strips[end]
        if strip is None:
            return 0.0
        way, (depth, rate) = self.blank.extent[end] - self.blank.faces[end], strip.depth(nodes)
        stations = self.blank.faces[end] + depth * way
        total = 0.0
        for piece in strip.pieces:
            total += float(weights @ self._density(*_strip_outline(strip, piece, nodes), stations) @ (rate * weights))
        return abs(way) * float(np.sign(self.blank.extent[1] - self.blank.extent[0])) * total

    def quadrature(self, order: int = 24) -> tuple[Array, Array]:
        """Gauss's rule over one tooth down to its floor, as `volume` has it.

        Along the generatrices it is exact for products of up to three coordinates.

        Parameters
        ----------
        order : int
            Points of a rule.

        Returns
        -------
        points : numpy.ndarray
            (N, 3), mm.
        weights : numpy.ndarray
            (N,), mm^3.

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> points, weights = tooth.quadrature()
        >>> bool(weights.sum() > 0.0)
        True
        """
        (nodes, weights), (places, shares) = (np.polynomial.legendre.leggauss(n) for n in (order, ACROSS))
        nodes, weights, places, shares = 0.5 * (nodes + 1.0), 0.5 * weights, 0.5 * (places + 1.0), 0.5 * shares
        points, amounts = [], []
        for outline, along_s, stations, size in self._outlines(nodes):
            foot, rate = self._generatrices(outline, along_s, stations)
            there = foot + places[:, None, None, None] * (outline - foot)
            wide = 1.0 if self.joint.travel is not None else np.hypot(there[..., 0], there[..., 1])
            points.append(there.reshape(-1, 3))
            amounts.append((size * shares[:, None, None] * weights[:, None] * weights * rate * wide).ravel())
        return np.concatenate(points), np.concatenate(amounts)

    def _outlines(self, nodes: Array) -> Iterator[tuple[Array, Array, Array, float | Array]]:
        """Points (S, T, 3) of all smooth pieces of a tooth's surface at nodes of both directions, their derivatives by s, their
        stations (T,), mm, and what the square from 0 to 1 is in s and station, of a strip at each node, signed from toe to heel."""
        toe, heel = self.blank.extent
        for low, high in pairwise(self.smooth_stretches):
            sections = self.sections(low + (high - low) * nodes)
            for link in self.chain.values():
                for first, last in pairwise((0.0, *(s for s, _ in link.seams), 1.0)):
                    points, along_s = self._outline(link, first + (last - first) * nodes, sections)
                    yield points, along_s, sections.stations, (heel - toe) * (high - low) * (last - first)
        for end, strip in enumerate(self.end_strips):
            way = self.blank.extent[end] - self.blank.faces[end]
            if strip is None:
                continue
            depth, rate = strip.depth(nodes)
            for piece in strip.pieces:
                points, along_s = _strip_outline(strip, piece, nodes)
                yield points, along_s, self.blank.faces[end] + depth * way, abs(way) * np.sign(heel - toe) * rate

    def _generatrices(self, points: Array, along_s: Array, stations: Array) -> tuple[Array, Array]:
        """Where the generatrices of sections to points (S, T, 3) leave the floor, (S, T, 3), and what they sweep per ds, (S, T):
        their length by the polar angle, of a bar by y."""
        x, y, z = np.moveaxis(points, -1, 0)
        foot = np.array(points)
        if self.joint.travel is not None:
            foot[..., 0] = self.blank.body.profile[0][0]
            return foot, (x - foot[..., 0]) * along_s[..., 1]
        rho, (floor, floor_z) = np.hypot(x, y), self._floor(stations)
        foot[..., :2] *= (floor / rho)[..., None]
        foot[..., 2] = floor_z
        across, up = station_normal(self.blank.axial)
        turning = (x * along_s[..., 1] - y * along_s[..., 0]) / rho**2
        return foot, (up * (rho - floor) - across * (z - floor_z)) * turning

    def _area_density(self, link: Link, s: Array, sections: Sections) -> Array:
        """d(area over the floor)/ds on an (S, T) grid: the area between generatrices is the integral of rho du."""
        return self._density(*self._outline(link, s, sections), sections.stations)

    def _density(self, points: Array, along_s: Array, stations: Array) -> Array:
        """The same of points (S, T, 3) at stations (T,), mm, and their derivatives by s."""
        x, y, z = np.moveaxis(points, -1, 0)
        if self.joint.travel is not None:
            # of a bar: between the section and the bar's back
            bar: Array = (x - self.blank.body.profile[0][0]) * along_s[..., 1]
            return bar
        rho = np.hypot(x, y)
        turning = (x * along_s[..., 1] - y * along_s[..., 0]) / rho**2
        across, up = station_normal(self.blank.axial)
        floor, floor_z = self._floor(stations)
        # rho is linear in u
        density: Array = 0.5 * (rho + floor) * (up * (rho - floor) - across * (z - floor_z)) * turning
        return density

    def _floor(self, stations: Array) -> tuple[Array, Array]:
        """The floor at stations (T,), mm, (T,) each: rho and z."""
        first, last = (np.array(self.blank.body.profile[k]) for k in (0, -1))
        toe, heel = self.blank.faces
        floor, floor_z = (first + ((stations - toe) / (heel - toe))[:, None] * (last - first)).T
        return floor, floor_z

    def _outline(self, link: Link, s: Array, sections: Sections) -> tuple[Array, Array]:
        """Points of a link and their derivatives by s at constant stations, (S, T, 3) each."""
        grid = link.grid(s, sections)
        if grid.jet is None:
            ahead = link.grid(s + HALF_STEP, sections).points
            behind = link.grid(s - HALF_STEP, sections).points
            return grid.points, (ahead - behind) / (2.0 * HALF_STEP)
        rate = parameter(s[:, None], link.span(sections), link.seams)[1]
        gradient = self.blank.axial.gradient(grid.points)
        dv = -dot(gradient, grid.jet.r_u) / dot(gradient, grid.jet.r_v)
        return grid.points, (grid.jet.r_u + grid.jet.r_v * dv[..., None]) * rate[..., None]

    def _ends(self, which: Side, t: Array, at_tip: tuple[Array, Jet], *, root: bool = True) -> Ends:
        """Where the links of one side end, from its tip; without `root` the root's angle is left out (NaN)."""
        side, stations, (tip, tip_jet) = self.side(which), self.stations(t), at_tip
        tip_point, tip_corner = tip_jet.r, np.full_like(stations, np.nan)
        form_point_flank, form_point_fillet, undercut = form_point(
            side,
            (tip, tip_jet),
            (t, stations),
            self.blank.axial,
            self.blank.root,
            self._undercut.get(which),
            folds=self._folds(side),
        )
        self._demand_flank(side, (form_point_flank, tip), (stations, t), tip_jet)
        if t.size >= PROOF_STATIONS and t.min() <= 0.0 and t.max() >= 1.0:
            self._undercut.setdefault(which, undercut)
        root_angle = np.full_like(stations, np.nan)
        if root:
            root_angle = self._root_angle(side, stations)
        edge = None
        if side.tip_corner is not None:
            tip_corner = self._tip_corner(side, side.tip_corner, stations, t)[1]
            land = np.full_like(stations, side.tip_corner.end)
            tip_point = along(side.tip_corner.surface, land, stations, self.blank.axial)[1].r
        if self.tip_edge is not None:
            tip, edge = self.tip_edge._between(side.flank, self.blank, which.sign, (form_point_flank, tip), stations)
            tip_point = edge[1]
        return Ends(form_point_flank, form_point_fillet, tip, tip_corner, self.joint.angle(tip_point), root_angle, edge)

    def _demand_flank(self, side: ToothSide, ends: tuple[Array, Array], at: tuple[Array, Array], tip: Jet) -> None:
        """Raise TrimError where the form point lies beyond the tip, both flank parameters `ends` (T,) at stations and t (T,)."""
        height = (ends[1] - ends[0]) * np.sign(side.tip - side.form_point[0])
        if (height > 0.0).all():
            return
        k, (stations, t) = int(np.argmin(height)), at
        begins = along(side.flank, ends[0][[k]], stations[[k]], self.blank.axial)[1].r
        radii = (float(self.joint.radius(r)[0]) for r in (begins, tip.r[[k]]))
        lost = "no flank is left between the form point (radius {:.6g} mm) and the tip ({:.6g} mm)".format(*radii)
        raise TrimError("flank", float(t[k]), lost)

    def _tips(self, t: Array) -> Tips:
        """Where the flanks of both sides have their tip at t (T,), as `_tip`."""
        right, left = (self._tip(self.side(which), self.stations(t), t) for which in Side)
        return right, left

    def _tip(self, side: ToothSide, stations: Array, t: Array) -> tuple[Array, Jet]:
        """Flank parameter p (T,) and the flank's jet on the tip's level, or where its tip chamfer or rounding begins, at each
        station."""
        axial, tip = self.blank.axial, self.blank.tip
        if side.tip_corner is not None:
            begins, _ = self._tip_corner(side, side.tip_corner, stations, t)
            return begins, along(side.flank, begins, stations, axial)[1]

        def at_tip(which: NDArray[np.intp], level: Array) -> Callable[[Array, NDArray[np.intp]], tuple[Array, Array]]:
            """Residuals of the points of some stations on levels (N,), mm, of the tip."""

            def residual(x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
                jet = jet_at(x)
                f = np.stack((axial.value(jet.r) - stations[which[index]], tip.value(jet.r) - level[index]), axis=-1)
                rows = [[dot(g, d) for d in (jet.r_u, jet.r_v)] for g in (axial.gradient(jet.r), tip.gradient(jet.r))]
                return f, np.moveaxis(np.array(rows), -1, 0)

            return residual

        near = follow(side.flank, np.full_like(stations, side.tip), stations, axial)
        start = np.stack((np.full_like(stations, side.tip), near.values), axis=-1)
        last = start, near.jet

        def jet_at(x: Array) -> Jet:
            """At parameters (N, 2); the last one is kept, as each solution begins and ends with what was evaluated before."""
            nonlocal last
            if not np.array_equal(x, last[0]):
                last = x.copy(), side.flank.jet(x[:, 0], x[:, 1])
            return last[1]

        tolerance = trim_tolerance(near.jet.r[near.converged])
        solution = newton.solve(at_tip(np.arange(stations.size), np.zeros_like(stations)), start, tolerance=tolerance)
        values, converged = solution.values, solution.converged
        share = (values[:, 0] - side.form_point[0]) / (side.tip - side.form_point[0])
        odd = np.flatnonzero(~(converged & (share > 0.0) & (share < FARTHEST_TIP)))
        if odd.size:
            # steep flanks throw Newton's method far off, to other roots
            first = newton.solve(
                at_tip(odd, np.zeros(odd.size)), self._near_tip(side, stations[odd]), tolerance=tolerance
            )
            values[odd[first.converged]] = first.values[first.converged]
            converged[odd] |= first.converged
        if not converged.all():
            lost = np.flatnonzero(~converged)
            x = start[lost]
            # a tip far from that of the tool, as of a throat: towards it by and by
            for left in TOWARDS_TIP:
                solution = newton.solve(at_tip(lost, left * tip.value(near.jet.r[lost])), x, tolerance=tolerance)
                x = solution.values
            values[lost], converged[lost] = x, solution.converged
        if not converged.all():
            raise TrimError("tip", float(t[int(np.argmin(converged))]), "the flank does not reach the tip")
        return values[:, 0], jet_at(values)

    def _near_tip(self, side: ToothSide, stations: Array) -> Array:
        """Flank parameters (T, 2) near where flanks that are steep along the face reach the tip first, from the form point on;
        NaN where they do not."""
        share = np.linspace(0.0, FARTHEST_TIP, TIP_SAMPLES)[:, None]
        p = side.form_point[0] + share * (side.tip - side.form_point[0]) + np.zeros_like(stations)
        curves = follow(side.flank, p, stations, self.blank.axial)
        under: Array = np.where(curves.converged, self.blank.tip.value(curves.jet.r), np.nan)
        crossed: NDArray[np.bool_] = np.asarray(np.diff(under > 0.0, axis=0) & np.isfinite(under[:-1] + under[1:]))
        k, of = crossed.argmax(axis=0), np.arange(stations.size)
        low_under, high_under = under[k, of], under[k + 1, of]
        far = low_under / (low_under - high_under)
        ends = ((x[k, of], x[k + 1, of]) for x in (p, curves.values))
        start = np.stack([low + far * (high - low) for low, high in ends], axis=-1)
        return np.where(np.asarray(crossed.any(axis=0))[:, None], start, np.nan)

    def _tip_corner(self, side: ToothSide, tip_corner: TipCorner, stations: Array, t: Array) -> tuple[Array, Array]:
        """Parameters (T,) of flank and tip corner where they meet at each station."""
        axial = self.blank.axial
        p, q = (np.full_like(stations, parameter) for parameter in tip_corner.form_point)
        if not tip_corner.crossed:
            return p, q
        start = [p, along(side.flank, p, stations, axial)[0], q, along(tip_corner.surface, q, stations, axial)[0]]
        solution = intersection((side.flank, tip_corner.surface), np.stack(start, axis=-1), stations, axial)
        if not solution.converged.all():
            raise TrimError("edge", float(t[int(np.argmin(solution.converged))]), "flank and tip chamfer do not meet")
        return solution.values[:, 0], solution.values[:, 2]

    def _root_angle(self, side: ToothSide, stations: Array) -> Array:
        """Polar angle (T,), rad, of the end of a side's fillet at stations (T,)."""
        return self.joint.angle(self._root_jet(side, stations).r)

    def _root_jet(self, side: ToothSide, stations: Array) -> Jet:
        """Jet (T,) of a side's fillet where it begins at the root at stations (T,)."""
        return along(side.fillet, np.full_like(stations, side.root), stations, self.blank.axial)[1]

    def _width_of_root(self, right: Array, before: Array, t: Array) -> Array:
        """Angle (T,), rad, from the fillet of the tooth `before` to that of the right side at t (T,).

        Raises TrimError where they overlap.
        """
        width = self.joint.within(right - before)
        width = np.where(width < 0.0, self.joint.wrap(width), width)
        if (width < -1e-12).any():
            raise TrimError("root", float(t[0]), "the fillets of neighbouring teeth overlap")
        return width

    @cached_property
    def _crosses_below_tip(self) -> bool:
        """Whether the sides cross at mid face below a tip far above the form point: where the width of the tooth falls through half
        a turn on the way, the angle at the tip alone looks like land."""
        if self.teeth < FEWEST_TEETH:
            return False
        t = np.array([0.5])
        station, (tip, at_tip) = self.stations(t), self._tip(self.right, self.stations(t), t)
        form_point = along(self.right.flank, np.array([self.right.form_point[0]]), station, self.blank.axial)[1].r
        if not self.joint.radius(at_tip.r)[0] > FAR_TIP * self.joint.radius(form_point)[0]:
            return False
        share, angles = np.linspace(0.0, 1.0, WAY_STATIONS), []
        for side, end in ((self.right, tip[0]), (self.left, self._tip(self.left, station, t)[0][0])):
            p = side.form_point[0] + share * (end - side.form_point[0])
            angles.append(self.joint.angle(along(side.flank, p, np.full_like(p, station[0]), self.blank.axial)[1].r))
        return bool((self.joint.running(self.joint.within(angles[1] - angles[0])) <= 0.0).any())

    def _width_of_land(self, right: Array, left: Array, t: Array) -> Array:
        """Angle (T,), rad, between the tips of both sides at t (T,). Raises TrimError where the tooth is pointed."""
        if self._crosses_below_tip:
            raise TrimError("pointed", 0.5, "the tooth is pointed")
        width = self.joint.within(left - right)
        if (width <= 0.0).any():
            width = np.where(width <= 0.0, width + self._turns_of_land(t), width)
        if (width <= 0.0).any():
            k = int(np.argmin(width))
            raise TrimError("pointed", float(t[k]), "the tooth is pointed")
        return width

    def _turns_of_land(self, t: Array) -> Array:
        """Full turns (T,), rad, that the width of the land has grown through at t (T,) on its way from mid face: that of a single
        thread goes round nearly a turn where it runs out."""
        stretches = pairwise(np.unique([0.0, *self._bends, 0.5, 1.0]))
        way = np.unique(np.concatenate([t, *(np.linspace(*ends, LAND_STATIONS) for ends in stretches)]))
        right, left = (self.joint.angle(self._tip(self.side(side), self.stations(way), way)[1].r) for side in Side)
        width = self.joint.within(left - right)
        turns = self.joint.running(width) - width
        grown: Array = (turns - turns[way == 0.5])[np.searchsorted(way, t)]
        return grown


def _changes(holds: Callable[[Array], NDArray[np.bool_]]) -> Array:
    """Stations t inside (0, 1) where a condition begins or ends, ascending, each on the side where it does not hold."""
    t = np.linspace(0.0, 1.0, BREAK_SAMPLES)
    samples = holds(t)
    change = np.flatnonzero(samples[:-1] != samples[1:])
    was = samples[change]
    low, high = last_true(
        lambda at, k: holds(at) == was[k], t[change], t[change + 1], rounds=BREAK_ROUNDS, split=BREAK_PARTS
    )
    return np.where(was, high, low)


def _strip_outline(strip: EndStrip, piece: StripPiece, nodes: Array) -> tuple[Array, Array]:
    """Points of a piece of a chamfer at nodes of both directions and their derivatives along the outline, (S, T, 3) each."""
    at, ahead, behind = (strip.at(piece, s[:, None], nodes) for s in (nodes, nodes + HALF_STEP, nodes - HALF_STEP))
    return at, (ahead - behind) / (2.0 * HALF_STEP)
