"""A tooth: flanks, fillets and lands, trimmed against each other and by the blank, as grids (s, t) of exact points.

Parameter t runs from 0 at the toe to 1 at the heel, s from 0 to 1 along each link of a section (see `section`). "right"
is y < 0 of a tooth centred on +x (ISO 21771). The tool's tip generates the fillet. Where the fillet undercuts the
flank, both end at their true intersection.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.errors import KindError
from gearmesh.kernel.envelope.limiting_line import area_density
from gearmesh.kernel.motion.joint import REVOLUTE_JOINT, Joint
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, distinct, dot
from gearmesh.kernel.numeric.roots import last_true
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.kernel.surface.stations import TrimError, along, follow
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.records import dataclass
from gearmesh.teeth.blank.blank import Blank
from gearmesh.teeth.blank.development import Development
from gearmesh.teeth.blank.end_edge import SHARP_ENDS
from gearmesh.teeth.blank.tip_edge import TipEdge
from gearmesh.teeth.end_strip import EndStrip, SharpOutline, StripPiece
from gearmesh.teeth.region import FILLET_REGIONS, FLANK_REGIONS, TIP_EDGES, Region, Side
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
from gearmesh.teeth.tooth_side import Bottom, Crest, TipCorner, ToothSide
from gearmesh.teeth.undercut import Undercut, cut_off, form_point, intersection, singular_stations, trim_tolerance

#: stations between which the beginning and the end of undercut are looked for
BREAK_SAMPLES = 17
#: Gauss nodes along a generatrix: exact for products of three coordinates, which have degree 4 there
GENERATRIX_NODES = 3
#: stations at which a flank is searched for loops with two cusps
FOLD_STATIONS = 5
#: distance in t from the beginning or end of undercut at which a flank with such a loop is trimmed as a proof
BREAK_DISTANCE_T = 1e-6
#: fewest stations, evenly spaced, of the sections that are kept
EVEN_STATIONS = 25
#: largest face width, in tooth heights, that still adds stations
MAX_FACE_HEIGHTS = 64
#: stations in each turn of a tooth that winds round its axis
STATIONS_PER_TURN = 24
#: a thread has a tip radius of more than this many times its axial advance per radian
MIN_RADIUS_PER_ADVANCE = 1.8
#: samples each way of a flank that is tested for being a screw surface
SCREW_SAMPLES = 3
#: largest spread of the advances of these samples, as a share of the mean
MAX_SCREW_SPREAD = 1e-6
#: largest difference between the advances of both sides of a thread with two leads, as a share of the mean
MAX_ADVANCE_DIFFERENCE = 0.5
#: samples of a flank between which its tip is looked for
TIP_SAMPLES = 33
#: largest distance of the tip from the form point, in nominal flank lengths
MAX_TIP_SHARE = 1.5
#: tip radius over form point radius from which the tooth's width is followed up to the tip
MIN_FAR_TIP_RATIO = 2.0
#: samples of a flank at which that width is followed
WIDTH_SAMPLES = 65
#: fewest teeth for which it is followed: threads of worms are wider than half a turn at their form point
MIN_FOLLOWED_TEETH = 3
#: stations of each smooth stretch of the face along which the width of the land is followed
LAND_STATIONS = 9
#: stations at which a tooth is trimmed as a proof, before it is used
PROOF_STATIONS = 9
#: their places from toe to heel
PROVED_T = np.linspace(0.0, 1.0, PROOF_STATIONS)
#: distance from the tip, by the height of the tooth, from which its solution starts at other stations
NEAR_TIP_SHARE = 1e-3
#: largest distance between the tip and a flank followed along the face, as a share of the tooth's height
TIP_OFF_SHARE = 1e-6
#: distance from the ends of a link, as a share of it, within which a break makes no seam
MIN_SEAM_SHARE = 1e-3
#: shares of the way to the tip left after each step, where Newton's method does not converge in one step
TIP_APPROACH_SHARES = (0.75, 0.5, 0.25, 0.0)
#: half of the step in s with which drawn curves are differentiated
HALF_STEP = 1e-6
#: stations, of which t is given, at which neighbouring links are compared where they meet
JOINED_STATIONS_T = (0.0, 0.5, 1.0)
#: words for the place where flank and fillet meet
FORM_POINT_PLACE = "at the form point"
#: largest distance between neighbouring links where they meet, as a share of the largest coordinate
MAX_GAP_SHARE = 1e-8
#: parts of the interval with a beginning or end of undercut at first: it may hold several, which fewer samples do not tell apart
FIRST_BREAK_PARTS = 128
#: rounds in which the part with the first one is divided then
BREAK_ROUNDS = 8
#: parts in each of these rounds, which cost less than 4 parts in twice as many rounds, or 256 in half as many
BREAK_PARTS = 16

#: what is called with every tooth that is proved, before it is trimmed: the proof of a kind compares its surfaces
before_trimming: ContextVar[Callable[[Tooth], object] | None] = ContextVar("before_trimming", default=None)

#: flank parameters (T,) and jets of the tips of the right and the left side
Tips = tuple[tuple[Array, Jet], tuple[Array, Jet]]


@dataclass(frozen=True)
class Tooth:
    """One tooth of a member with `teeth` teeth, centred on +x at the middle station.

    Methods raise TrimError where the chain of links cannot be closed.
    """

    #: number of teeth of the member
    teeth: int
    #: surfaces of the right side, y < 0
    right: ToothSide
    #: surfaces of the left side
    left: ToothSide
    #: levels that limit the tooth (stations, tip, root), and the gear body
    blank: Blank
    #: drawn chamfer or rounding of the tip; None if the tip is sharp or the tool generates its edge
    tip_edge: TipEdge | None = None
    #: root that is no surface of revolution; the root of `blank` is then the level through its middle
    bottom: Bottom | None = None
    #: land that is no surface of revolution; None for a land on the tip of the blank
    crest: Crest | None = None
    #: motion from one tooth to the next: a turn, or the slide of a rack
    joint: Joint = REVOLUTE_JOINT

    @property
    def pitch_angle(self) -> float:
        return self.joint.pitch(self.teeth)

    def side(self, side: Side) -> ToothSide:
        """Return the surfaces of the "right" or "left" side."""
        return self.right if Side(side) is Side.RIGHT else self.left

    @cached_property
    def chain(self) -> dict[Region, Link]:
        """Links of a section by region, in their order round the tooth."""
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
        """Surfaces of tip chamfers or roundings by side; empty where the tip is sharp.

        A generated edge is the tool's envelope with its own parameters. A drawn edge has parameters (s, z), s from 0 at
        the flank to 1 at the land.
        """
        surfaces: dict[Side, Surface] = {}
        for side in Side:
            link = self.chain.get(TIP_EDGES[side])
            if isinstance(link, DrawnLink):
                surfaces[side] = drawn_edge_surface(link, self.sections, self.smooth_stretches)
            elif link is not None and link.surface is not None:
                surfaces[side] = link.surface
        return surfaces

    def tip_edge_grid(self, which: Side, s: Array) -> Grid | None:
        """Return points (S, T, 3), mm, of one side's tip edge at the even stations, with the parameters of its surface.

        `s` (S,): shares of the way from the flank to the land, ascending. None if the tip is sharp.
        """
        link = self.chain.get(TIP_EDGES[which])
        if link is None:
            return None
        if not isinstance(link, DrawnLink):
            return link.grid(s if which is Side.RIGHT else 1.0 - s, self.even)
        p, v = np.broadcast_arrays(s[:, None], self.even.stations)
        jet = self.tip_edges[which].jet(p, v)
        return Grid(jet.r, jet.n, jet, p, v)

    def _top(self) -> TurnedLink | BottomLink:
        """Return the link between the tips of both sides."""
        if self.crest is not None:
            return BottomLink(Region.LAND, self.crest.surface, self.blank.axial, self.crest.ends)

        def land(sections: Sections) -> tuple[Array, Array]:
            return sections.right.tip_angle, sections.left.tip_angle

        return TurnedLink(Region.LAND, self.blank.tip.surface, self.blank.axial, land)

    def _links(self, which: Side) -> list[Link]:
        """Return the links of one side, from the root to the land."""
        side, axial = self.side(which), self.blank.axial

        def fillet(ends: Ends) -> tuple[Array, Array]:
            return np.full_like(ends.form_point_fillet, side.root), ends.form_point_fillet

        links: list[Link] = [
            self._add_seams(
                GeneratedLink(FILLET_REGIONS[which], which, side.fillet, axial, fillet), side.fillet_breaks
            ),
            self._flank(which),
        ]
        if side.tip_corner is not None:
            end = side.tip_corner.end

            def tip_corner(ends: Ends) -> tuple[Array, Array]:
                return ends.tip_corner, np.full_like(ends.tip_corner, end)

            links.append(GeneratedLink(TIP_EDGES[which], which, side.tip_corner.surface, axial, tip_corner))
        elif self.tip_edge is not None:
            links.append(DrawnLink(TIP_EDGES[which], which, self.tip_edge.of(which), axial))
        return links

    def _flank(self, which: Side) -> GeneratedLink:
        """Return the link of one side's flank, from the form point to the tip."""
        side = self.side(which)
        flank = GeneratedLink(
            FLANK_REGIONS[which], which, side.flank, self.blank.axial, lambda ends: (ends.form_point_flank, ends.tip)
        )
        return self._add_seams(flank, side.flank_breaks)

    def _add_seams(self, link: GeneratedLink, breaks: tuple[float, ...]) -> GeneratedLink:
        """Return the link with a seam at each of `breaks` that lies inside it all along the face."""
        if not breaks:
            return link
        first, last = (end[:, None] for end in link.ends(self._coarse_ends(link.side)))
        share = (np.sort(breaks) - first) / (last - first)
        inside = ((share > MIN_SEAM_SHARE) & (share < 1.0 - MIN_SEAM_SHARE)).all(axis=0)
        seams = [(float(s), float(p)) for s, p in zip(share[0, inside], np.sort(breaks)[inside], strict=True)]
        if link.side is Side.LEFT:
            seams = [(1.0 - s, p) for s, p in seams]
        return replace(link, seams=tuple(sorted(seams)))

    def _coarse_ends(self, which: Side) -> Ends:
        """Ends of one side's links at five stations; the middle station is the first."""
        return self.ends(which, np.array([0.5, 0.0, 0.25, 0.75, 1.0]))

    @cached_property
    def sharp_ends(self) -> Tooth:
        """The tooth without end chamfers: its links go on to the end faces."""
        return self if self.blank.ends == SHARP_ENDS else replace(self, blank=self.blank.sharp)

    @cached_property
    def end_strips(self) -> tuple[EndStrip | None, EndStrip | None]:
        """Broken edges of the end faces at toe and heel, None where an edge is sharp. Raises TrimError where a chamfer
        has no room.
        """
        toe, heel = (self._end_strip(end) for end in (0, 1))
        return toe, heel

    def _end_strip(self, end: int) -> EndStrip | None:
        """Return the broken edge of one end face, or None if that edge is sharp; `end` is 0 at the toe, 1 at the
        heel.
        """
        chamfer, at = self.blank.ends[end], np.array([float(end)])
        if chamfer is None:
            return None
        cut_and_sharp = self, self.sharp_ends
        chains, sections = (self.chain, cut_and_sharp[1].chain), (self.sections(at), cut_and_sharp[1].sections(at))
        step = self.joint.to(self.pitch_angle)
        return EndStrip(chains, sections, Development(self.blank.axial, self.joint), chamfer, step)

    @cached_property
    def sharp_outlines(self) -> tuple[SharpOutline, SharpOutline]:
        """Outlines of the end faces at toe and heel, with sharp edges."""
        sharp, plane = self.sharp_ends, Development(self.blank.axial, self.joint)
        step = self.joint.to(self.pitch_angle)
        toe, heel = (SharpOutline(sharp.chain, sharp.sections([end]), plane, step) for end in (0.0, 1.0))
        return toe, heel

    @property
    def regions(self) -> tuple[Region, ...]:
        """Regions of the links, in order."""
        return tuple(self.chain)

    @cached_property
    def breaks(self) -> Array:
        """Stations t inside (0, 1) that are lines of every grid.

        At these stations undercut begins or ends, so that the form point has a corner, or a flank is not smooth along
        the face.
        """
        return distinct(np.concatenate([*(self.breaks_of(side) for side in Side), self.face_breaks]))

    @cached_property
    def face_breaks(self) -> Array:
        """Stations t inside (0, 1) where a flank or the tip is not smooth along the face."""
        return self._inner([*self.right.face_breaks, *self.left.face_breaks, *self.blank.corners])

    @cached_property
    def slanted_breaks(self) -> tuple[tuple[float, float], ...]:
        """Station t at the root, and second surface parameter, of lines aslant across all fillets and flanks where curvature jumps.

        They stand for all `face_breaks`; empty if undercut begins or ends where they are.
        """
        if self.right.slanted_breaks != self.left.slanted_breaks or self.tip_edge is not None or self.crest is not None:
            return ()
        toe, heel = self.blank.extent
        found = tuple(((z - toe) / (heel - toe), v) for z, v in self.right.slanted_breaks)
        if not found or any(link.seams for link in self.chain.values()):
            return ()
        nearest = np.abs(self.face_breaks[:, None] - np.array([t for t, _ in found])).argmin(axis=1)
        others = np.setdiff1d(self.breaks, self.face_breaks, assume_unique=True)
        for k in range(len(found)):
            ends = self.face_breaks[nearest == k]
            if ends.size == 0 or ((others > ends.min()) & (others < ends.max())).any():
                return ()
        return found

    def creases(self, region: Region) -> Array:
        """Return the stations t (K,) inside (0, 1), ascending, where the surface of a link has a corner along the face."""
        blank, sides = self.blank, (*self.right.face_breaks, *self.left.face_breaks)
        ends = {Region.LAND: blank.tip.corners(blank.axial), Region.ROOT: blank.root.corners(blank.axial)}
        return self._inner([*sides, *ends.get(region, ())])

    def _inner(self, places: list[float]) -> Array:
        """Convert station coordinates (mm) to t, ascending, and keep those inside (0, 1)."""
        toe, heel = self.blank.extent
        t = (np.array(places) - toe) / (heel - toe)
        return distinct(t[(t > 0.0) & (t < 1.0)])

    @property
    def smooth_stretches(self) -> tuple[float, ...]:
        """Values of t from 0 to 1 between which Gauss quadrature of sections is exact.

        They are 0, the breaks of the face, the places where higher derivatives jump, and 1.
        """
        return (0.0, *distinct(np.append(self.face_breaks, self._bends)).tolist(), 1.0)

    @property
    def _bends(self) -> Array:
        """Stations t inside (0, 1), ascending, where higher derivatives jump along the face."""
        return self._inner([*self.right.face_bends, *self.left.face_bends])

    @cached_property
    def unmodified_tooth(self) -> Tooth:
        """The tooth as its tools leave it, without modifications or deviations."""
        right, left = (side.generated or side for side in (self.right, self.left))
        if (right, left) == (self.right, self.left):
            return self
        crest = None if self.crest is None else self.crest.generated or self.crest
        return replace(self, right=right, left=left, crest=crest)

    def breaks_of(self, which: Side) -> Array:
        """Return the stations t (K,) inside (0, 1), ascending, where undercut of one side begins or ends."""
        side = self.side(which)
        return _changes(lambda t: self._cut_off(side, t))

    def _cut_off(self, side: ToothSide, t: Array) -> NDArray[np.bool_]:
        """True (T,) at stations t where the flank is undercut, at the tool's form point or before it."""
        # undercut at the form point; a flank with loops may also have a cusp before its form point
        cut, odd = self._cut_off_at_form_point(side, t)
        if not self._folds(side):
            return cut
        stations, axial = self.stations(t), self.blank.axial
        folded = singular_stations(side, stations, axial)
        if odd.any():
            folded[odd] = singular_stations(side, stations[odd], axial, self._tip(side, stations[odd], t[odd])[0])
        return cut | folded

    def _cut_off_at_form_point(self, side: ToothSide, t: Array) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Test for undercut at the tool's form point.

        Returns two arrays (T,) at stations t: where the flank is undercut, and where the nominal tip cannot tell, so
        that the true tip was used.
        """
        stations, axial = self.stations(t), self.blank.axial
        sound, odd = self._nominal_tip(side, t)
        cut = cut_off(side, sound, stations, axial)
        if odd.any():
            cut[odd] = cut_off(side, self._tip(side, stations[odd], t[odd])[1], stations[odd], axial)
        return cut, odd

    def _nominal_tip(self, side: ToothSide, t: Array) -> tuple[Jet, NDArray[np.bool_]]:
        """Evaluate the flank at its nominal tip.

        Returns the jet (T,) at stations t, and an array (T,) that is True where it cannot be used. There the station
        does not meet the flank, or the flank is turned inside out against mid face: steep flanks reach the tip far from
        the nominal one.
        """
        which = self._which(side)
        if which not in self._senses and 0.5 not in t:
            self._nominal_tip(side, np.array([0.5]))
        # the area density has the sign of mid face wherever the flank is sound
        stations = self.stations(t)
        nominal = follow(side.flank, np.full_like(stations, side.tip), stations, self.blank.axial)
        density = area_density(nominal.jet)
        sense = self._senses.setdefault(which, float(density[np.abs(t - 0.5).argmin()]))
        odd: NDArray[np.bool_] = ~(nominal.converged & (density * sense > 0.0))
        return nominal.jet, odd

    def find_undercut(self) -> None:
        """Find where the flanks are undercut, unless that is known.

        Later sections start from the result, which changes their rounding errors. Raises TrimError if the tooth cannot be
        trimmed.
        """
        for which in Side:
            if which not in self._undercut:
                self.ends(which, PROVED_T)

    def near_tips(self, which: Side, t: Array) -> Array:
        """Return profile parameters (T,) of points near the tip at which the flank is sound, at stations t (T,).

        They are those of the nominal tip, or of the true tip where the nominal one cannot be used, as on steep flanks.
        """
        side, odd = self.side(which), self._nominal_tip(self.side(which), t)[1]
        p = np.full(t.shape, side.tip)
        if odd.any():
            p[odd] = self._tip(side, self.stations(t[odd]), t[odd])[0]
        return p

    @cached_property
    def _senses(self) -> dict[Side, float]:
        """Area densities of the flanks at their nominal tip at mid face, by side; filled when first needed."""
        return {}

    def _folds(self, side: ToothSide) -> bool:
        """True if the flank of a side turns back and forth again before its form point.

        A loop with two cusps is wide, or it is narrow and lies next to the station where undercut at the form point
        ends. Both places are tested.
        """
        which = self._which(side)
        if which not in self._folded_sides:
            t = np.linspace(0.0, 1.0, FOLD_STATIONS)
            sound = t[~self._cut_off_at_form_point(side, t)[0]]
            if sound.size < t.size:
                sound = np.append(sound, _changes(lambda t: self._cut_off_at_form_point(side, t)[0]))
            self._folded_sides[which] = bool(
                sound.size and singular_stations(side, self.stations(sound), self.blank.axial).any()
            )
        return self._folded_sides[which]

    def _which(self, side: ToothSide) -> Side:
        """Return the name of a side of this tooth."""
        return Side.RIGHT if side is self.right else Side.LEFT

    def stations(self, t: ArrayLike) -> Array:
        """Return the coordinates (T,), mm, of stations t (T,) from 0 at the toe to 1 at the heel.

        They are z, or the distance along the cone of conical teeth.
        """
        toe, heel = self.blank.extent
        return toe + (heel - toe) * np.asarray(t, dtype=float)

    def sections(self, t: ArrayLike) -> Sections:
        """Trim both sides at stations t (T,), from 0 at the toe to 1 at the heel.

        The result has the ends of fillets, flanks and tips, and the polar angles of tips and roots (rad). Raises TrimError
        if the tooth cannot be trimmed at a station.
        """
        t = np.atleast_1d(np.asarray(t, dtype=float))
        return self._sections(t, self._tips(t))

    def _sections(self, t: Array, tips: Tips) -> Sections:
        """Trim both sides at t (T,), with known tips of the flanks."""
        stations = self.stations(t)
        right, left = (self._ends(side, t, tip) for side, tip in zip(Side, tips, strict=True))
        # polar angles are known but for full turns. Threads wind round the axis many times: continue their angles along the face.
        # A land is narrower than half a turn, except in the run-out of a single thread, and a root narrower than three quarters
        right = replace(right, tip_angle=self.joint.running(right.tip_angle))
        left = replace(left, root_angle=self.joint.running(left.root_angle))
        width = self._width_of_land(right.tip_angle, left.tip_angle, t)
        before = left.root_angle - self.pitch_angle
        root = self._width_of_root(right.root_angle, before, t)
        right, left = replace(right, root_angle=before + root), replace(left, tip_angle=right.tip_angle + width)
        return Sections(t, stations, right, left)

    def ends(self, which: Side, t: Array) -> Ends:
        """Trim fillet and flank of one side at stations t (T,), without the angle of the root (NaN).

        The other side is not evaluated. Raises TrimError if the tooth cannot be trimmed at a station.
        """
        return self._ends(which, t, self._tip_of(which, t), root=False)

    @cached_property
    def even(self) -> Sections:
        """Sections at evenly spaced stations from toe to heel, made once; contact and clearance start from them.

        There are at least EVEN_STATIONS. A wide face has two for every tooth height, because contact is about as long
        as teeth are high. A thread has STATIONS_PER_TURN for every turn.
        """
        toe, heel = self.blank.extent
        wide = 2 * int(np.ceil(min(abs(heel - toe) / self.height, MAX_FACE_HEIGHTS))) + 1
        wound = int(np.ceil(STATIONS_PER_TURN * self.windings)) + 1
        return self.sections(np.linspace(0.0, 1.0, max(wide, wound, EVEN_STATIONS)))

    @cached_property
    def height(self) -> float:
        """Height (mm) of the tip over the root, at mid face."""
        return abs(float(self.blank.root.value(self._middle_tip.r)[0]))

    @cached_property
    def windings(self) -> float:
        """Turns of the tooth round its axis along the face, from its slope at mid face; 0 for a rack."""
        tip, (toe, heel) = self._middle_tip, self.blank.extent
        along_axis, around = self.blank.axial.gradient(tip.r), self.joint.velocity(Rigid.identity(), tip.r)
        spin = float(np.linalg.norm(self.joint.spin(Rigid.identity())))
        turning = float((dot(tip.n, along_axis) / dot(tip.n, around))[0])
        return spin * abs((heel - toe) * turning) / (2.0 * np.pi)

    @cached_property
    def screw(self) -> float | None:
        """Axial advance of a thread, mm/rad, negative for left-hand threads; None for other teeth.

        The flanks of a thread, as its tools leave them, are screw surfaces, and its tip radius is more than
        MIN_RADIUS_PER_ADVANCE times the advance. If the two sides have different advances, the mean is returned.
        Run-outs at the ends are not screw surfaces: only the stretch between them is tested.
        """
        if self.joint.travel is not None or self.windings == 0.0:
            return None
        tooth, screws = self.unmodified_tooth, []
        ends = np.array([0.0, *self._bends, 1.0])
        along = np.linspace(ends[ends < 0.5].max(), ends[ends > 0.5].min(), SCREW_SAMPLES)
        for side in Side:
            grid = tooth.flank_grid(side, np.linspace(0.0, 1.0, SCREW_SAMPLES), along)
            # the motion along the helix of a screw surface is at right angles to all normals, which gives the advance
            around = grid.points[..., 1] * grid.normals[..., 0] - grid.points[..., 0] * grid.normals[..., 1]
            advances = around / grid.normals[..., 2]
            if not np.ptp(advances) <= MAX_SCREW_SPREAD * abs(advances.mean()):
                return None
            screws.append(float(advances.mean()))
        screw, apart = 0.5 * sum(screws), abs(screws[0] - screws[1])
        reach = float(self.joint.radius(self._middle_tip.r)[0])
        # teeth that taper, as of beveloids, wind to opposite sides: they are no threads
        return (
            screw
            if reach > MIN_RADIUS_PER_ADVANCE * abs(screw) and apart < MAX_ADVANCE_DIFFERENCE * abs(screw)
            else None
        )

    @property
    def sharp_tip(self) -> Tooth:
        """The tooth without the drawn chamfer or rounding of its tip."""
        return self if self.tip_edge is None else replace(self, tip_edge=None)

    @cached_property
    def _middle_tip(self) -> Jet:
        """Jet (1,) of the right flank at its tip at mid face."""
        return self._tip_in_middle(Side.RIGHT)[1]

    def _tip_in_middle(self, which: Side) -> tuple[Array, Jet]:
        """Return `_tip` of one side at mid face alone, from the proof of the tooth if there is one."""
        if which in self._proved_tips:
            (p, jet), middle = self._proved_tips[which], np.array([PROOF_STATIONS // 2])
            return p[middle], jet[middle]
        return self._tip(self.side(which), self.stations([0.5]), np.array([0.5]))

    @cached_property
    def _known_tips(self) -> dict[Side, Array]:
        """Parameters (PROOF_STATIONS, 2) of the flank at its tip, by side, as soon as they were solved from toe to heel."""
        return {}

    @cached_property
    def _proved_tips(self) -> dict[Side, tuple[Array, Jet]]:
        """Results of `_tip` by side at the stations of `prove`, empty before it."""
        return {}

    @cached_property
    def _folded_sides(self) -> dict[Side, bool]:
        """Results of `_folds` by side; filled when first needed."""
        return {}

    @cached_property
    def _undercut(self) -> dict[Side, Undercut]:
        """Undercut by side, kept as soon as a side was trimmed from toe to heel: finding it takes most of the time of a
        trimming.
        """
        return {}

    def prove(self) -> None:
        """Trim the tooth at many stations from toe to heel, and near the ends of loops with two cusps.

        Raises TrimError if it cannot be trimmed at a station, and KindError if its surfaces do not join there.
        """
        self.prove_joined()
        compare = before_trimming.get()
        if compare is not None:
            compare(self)
        t = PROVED_T
        tips = self._tips(t)
        self._proved_tips.update(zip(Side, tips, strict=True))
        self._prove_land(t, tips)
        looped = [self.breaks_of(which) for which in Side if self._folds(self.side(which))]
        if looped:
            beside = np.concatenate(looped)[:, None] + np.array([-BREAK_DISTANCE_T, BREAK_DISTANCE_T])
            t = np.append(t, np.clip(beside, 0.0, 1.0))
            tips = self._tips(t)
        self._sections(t, tips)

    def prove_joined(self) -> None:
        """Compare neighbouring surfaces of each side where their parameters say that they meet, at toe, mid face and heel.

        Where the flank is undercut, flank and fillet end at their intersection, which is solved. A tooth is compared once.
        Raises KindError naming both surfaces and the station if they are apart.
        """
        if not self._joined:
            for which in Side:
                self._prove_side_joined(which)
            self._joined.append(True)

    @cached_property
    def _joined(self) -> list[bool]:
        """One entry as soon as `prove_joined` has found no gap."""
        return []

    def _prove_side_joined(self, which: Side) -> None:
        """Raise KindError where surfaces of one side do not meet; see `prove_joined`."""
        side, corner, axial = self.side(which), self.side(which).tip_corner, self.blank.axial
        stations = self.stations(JOINED_STATIONS_T)
        flank, fillet, edge = FLANK_REGIONS[which], FILLET_REGIONS[which], TIP_EDGES[which]

        def points(surface: Surface, *parameters: float) -> Array:
            """Return points (P, T, 3) of a surface with first parameters (P,); NaN at stations that it does not reach."""
            p = np.repeat(np.array(parameters, dtype=float)[:, None], stations.size, axis=1)
            followed = follow(surface, p, stations, axial)
            return np.where(followed.converged[..., None], followed.jet.r, np.nan)

        # edges of the surfaces as the kind states them: where two surfaces join, both must have the same points
        on_flank = points(side.flank, side.form_point[0], *(() if corner is None else corner.form_point[:1]))
        on_fillet = points(side.fillet, side.form_point[1], side.root)
        compared = []
        # surfaces that cross are cut at their intersection, which is solved wherever the tooth is trimmed
        if not side.crossed:
            compared.append((f"{flank} and {fillet}", FORM_POINT_PLACE, on_flank[0] - on_fillet[0]))
        if corner is not None and not corner.crossed:
            apart = on_flank[1] - points(corner.surface, corner.form_point[1])[0]
            compared.append((f"{flank} and {edge}", "at the tip", apart))
        if self.crest is not None:
            end = self.crest.ends[0 if which is Side.RIGHT else 1]
            apart = points(side.flank, side.tip)[0] - points(self.crest.surface, end)[0]
            compared.append((f"{flank} and {Region.LAND}", "at the tip", apart))
        # a fillet ends on the root surface of the blank, or on the end of a bottom that the tool cuts
        if self.bottom is None:
            below = self.blank.root.value(on_fillet[1])[:, None]
        else:
            end, ahead = (self.bottom.ends[1], 0.0) if which is Side.RIGHT else (self.bottom.ends[0], -self.pitch_angle)
            below = points(self.bottom.surface, end)[0] - self.joint.to(ahead).point(on_fillet[1])
        compared.append((f"{fillet} and {Region.ROOT}", "at the root", below))
        # gaps count relative to the size of the tooth, so that rounding errors of its coordinates are none
        largest = float(np.fmax.reduce(np.abs(on_fillet), axis=None, initial=float(np.abs(stations).max())))
        for surfaces, place, apart in compared:
            gap = np.linalg.norm(apart, axis=-1)
            gap[~(gap > MAX_GAP_SHARE * largest)] = 0.0
            # an undercut flank ends above the form point, where the trimmed surfaces cross: no gap of the real tooth
            if gap.any() and place == FORM_POINT_PLACE:
                apart_at = np.flatnonzero(gap)
                gap[apart_at[self._undercut_at(side, np.array(JOINED_STATIONS_T)[apart_at])]] = 0.0
            if gap.any():
                k = int(gap.argmax())
                raise KindError(
                    surfaces,
                    reason=f"they are {gap[k]:.3g} mm apart {place}, at t = {JOINED_STATIONS_T[k]:g} (station "
                    f"{stations[k]:.6g} mm)",
                    must_be="joined there",
                )

    def _undercut_at(self, side: ToothSide, t: Array) -> NDArray[np.bool_]:
        """True (T,) at stations t where a flank is undercut, or where it cannot be trimmed."""
        with suppress(TrimError):
            return self._cut_off(side, t)
        # one of the stations cannot be trimmed: ask the others alone
        found = np.ones(t.shape, dtype=bool)
        for k in range(t.size):
            with suppress(TrimError):
                found[k] = self._cut_off(side, t[k : k + 1])[0]
        return found

    @property
    def has_loops(self) -> bool:
        """True if a flank has a loop with two cusps before its form point.

        In that case `prove` takes about a hundred times as long as one section.
        """
        return any(self._folds(self.side(which)) for which in Side)

    def prove_land(self, t: Array) -> None:
        """Trim only the flanks at the tip, at stations t (T,), in a fiftieth of the time of a section.

        Chamfers and roundings of the tip are not tested: only `sections` includes them. Raises TrimError for a pointed
        tooth, and for a flank that turns back along the face near its tip.
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
        """Raise TrimError where the tooth is pointed or a flank misses its tip, at stations t (T,) with known tips."""
        if self.tip_edge is None and self.right.tip_corner is None:
            right, left = (self.joint.angle(jet.r) for _, jet in tips)
            self._width_of_land(right, left, t)
        self._prove_tips(t, tips)

    def prove_root(self, t: Array) -> None:
        """Follow only the ends of the fillets at the root, at stations t (T,), in a tenth of the time of a section.

        Raises TrimError if the fillets of a space overlap.
        """
        right, left = (self._root_angle(self.side(side), self.stations(t)) for side in Side)
        self._width_of_root(right, self.joint.running(left) - self.pitch_angle, t)

    @cached_property
    def root_ends(self) -> Array:
        """Points (2, PROOF_STATIONS, 3), mm, where the fillets of the right and the left side begin at the root."""
        stations = self.stations(PROVED_T)
        sides = (self.side(which) for which in Side)
        return np.array([self._root_jet(side, stations).r for side in sides])

    def root_middle(self, z: Array) -> Array:
        """Return y (...,), mm, of the middle of the root before a rack's tooth, as its tools leave it; a bar ends there.

        `z` (...,): positions along the face, mm.
        """
        right, left = self.unmodified_tooth.sharp_ends.root_ends
        middle = 0.5 * (right + left - self.joint.to(self.pitch_angle).translation)
        return np.asarray(np.interp(z, middle[:, 2], middle[:, 1]))

    def grid(self, region: Region, s: ArrayLike, sections: Sections) -> Grid:
        """Return exact points and normals (S, T, 3), mm, own frame, of one link.

        - region: region of the link, as "flank_right".
        - s: shares (S,) or (S, T) of the way along the link.
        - sections: ends of the links at T stations.
        """
        return self.chain[region].grid(s, sections)

    def flank_grid(self, which: Side, s: ArrayLike, t: ArrayLike) -> Grid:
        """Return exact points and normals (S, T, 3), mm, own frame, of a trimmed flank; the other side is not evaluated.

        `s` (S,) are shares of the way from the form point to the tip, `t` (T,) stations from 0 at the toe to 1 at the heel.
        Raises TrimError if the tooth cannot be trimmed at a station.
        """
        return self.flank_grids(which, (s, t))[0]

    def flank_grids(self, which: Side, *grids: tuple[ArrayLike, ArrayLike]) -> list[Grid]:
        """Return several grids of a flank, each for its s (S,) and t (T,) as in `flank_grid`, trimmed once for all of
        them."""
        which = Side(which)
        wanted = [(np.asarray(s, dtype=float)[:, None], np.atleast_1d(np.asarray(t, dtype=float))) for s, t in grids]
        stations, place = np.unique(np.concatenate([t for _, t in wanted]), return_inverse=True)
        ends, flank = self.ends(which, stations), self._flank(which)
        places = np.split(place, np.cumsum([t.size for _, t in wanted])[:-1])
        return [
            flank.between(s if which is Side.RIGHT else 1.0 - s, ends[at], self.stations(t))
            for (s, t), at in zip(wanted, places, strict=True)
        ]

    def volume(self, order: int = 24) -> float:
        """Return the volume (mm^3) of all teeth and the body, by Gauss quadrature of exact section areas.

        The section of a station lies on a plane, cone or cylinder. It reaches from the tooth's outline down to a floor,
        the straight line between the ends of the body's profile. With u along the generatrix, its area is the integral
        of rho du over the polar angle. The volume of the teeth is the integral of the area over the station coordinate.
        Floor and profile enclose the rest, a solid of revolution. `order`: Gauss nodes in each direction.
        """
        return self.teeth * self._swept(order) - self.blank.body.enclosed_volume()

    def _swept(self, order: int) -> float:
        """Volume (mm^3) between the links of one tooth and the floor under them."""
        # Gauss quadrature over each smooth stretch of the face, and over each smooth piece of each link
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
        """Volume (mm^3) of one tooth over the floor, within the depth of the chamfer at an end; 0 for a sharp end."""
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
        """Return a Gauss rule over one tooth, down to the floor that `volume` uses: points (N, 3), mm, and weights (N,), mm^3.

        The rule is exact along the generatrices for products of up to three coordinates. `order`: Gauss nodes in each
        direction.
        """
        (nodes, weights), (depths, shares) = (np.polynomial.legendre.leggauss(n) for n in (order, GENERATRIX_NODES))
        nodes, weights, depths, shares = 0.5 * (nodes + 1.0), 0.5 * weights, 0.5 * (depths + 1.0), 0.5 * shares
        points, amounts = [], []
        for outline, along_s, stations, size in self._outlines(nodes):
            foot, rate = self._generatrices(outline, along_s, stations)
            samples = foot + depths[:, None, None, None] * (outline - foot)
            radius = 1.0 if self.joint.travel is not None else np.hypot(samples[..., 0], samples[..., 1])
            points.append(samples.reshape(-1, 3))
            amounts.append((size * shares[:, None, None] * weights[:, None] * weights * rate * radius).ravel())
        return np.concatenate(points), np.concatenate(amounts)

    def _outlines(self, nodes: Array) -> Iterator[tuple[Array, Array, Array, float | Array]]:
        """Yield every smooth piece of a tooth's surface, evaluated at Gauss nodes in both directions.

        Each piece has four parts:

        - points (S, T, 3), mm.
        - their derivatives by s.
        - their stations (T,), mm.
        - the area in s and station coordinate of the parameter square, signed from toe to heel; on a chamfer one value
          per node.
        """
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
        """Compute the generatrices from the floor to points (S, T, 3) of a section.

        Returns their feet (S, T, 3) on the floor, and the area that they sweep per ds, (S, T): length times polar
        angle, of a bar length times y.
        """
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
        """Derivative by s of the area over the floor, on an (S, T) grid; area between generatrices is the integral of
        rho du.
        """
        return self._density(*self._outline(link, s, sections), sections.stations)

    def _density(self, points: Array, along_s: Array, stations: Array) -> Array:
        """Derivative by s of the area over the floor, (S, T), from points (S, T, 3), their derivatives by s, and
        stations (T,), mm.
        """
        x, y, z = np.moveaxis(points, -1, 0)
        if self.joint.travel is not None:
            # a bar: the area between the section and the back
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
        """Return rho and z (T,) of the floor at stations (T,), mm."""
        first, last = (np.array(self.blank.body.profile[k]) for k in (0, -1))
        toe, heel = self.blank.faces
        floor, floor_z = (first + ((stations - toe) / (heel - toe))[:, None] * (last - first)).T
        return floor, floor_z

    def _outline(self, link: Link, s: Array, sections: Sections) -> tuple[Array, Array]:
        """Return points of a link and their derivatives by s at constant stations, (S, T, 3) each."""
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
        """Trim one side from its tip at t (T,); without `root` the polar angle of the root is NaN."""
        with _trimming(which):
            return self._side_ends(which, t, at_tip, root=root)

    def _side_ends(self, which: Side, t: Array, at_tip: tuple[Array, Jet], *, root: bool) -> Ends:
        """Return `_ends`; a TrimError does not name the side."""
        side, stations, (tip, tip_jet) = self.side(which), self.stations(t), at_tip
        tip_point, tip_corner = tip_jet.r, np.full_like(stations, np.nan)
        # form point, or the intersection of flank and fillet where the flank is undercut
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
        # sections from toe to heel show all undercut: later sections start from it
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
            edge_ends, at = (form_point_flank, tip), (stations, t)
            tip, edge = self.tip_edge.of(which)._between(side.flank, self.blank, which.sign, edge_ends, at)
            tip_point = edge[1]
        return Ends(form_point_flank, form_point_fillet, tip, tip_corner, self.joint.angle(tip_point), root_angle, edge)

    def _demand_flank(self, side: ToothSide, ends: tuple[Array, Array], at: tuple[Array, Array], tip: Jet) -> None:
        """Raise TrimError where the form point lies beyond the tip.

        `ends`: flank parameters (T,) of form point and tip; `at`: stations (mm) and t (T,); `tip`: jets at the tip.
        """
        height = (ends[1] - ends[0]) * np.sign(side.tip - side.form_point[0])
        if (height > 0.0).all():
            return
        k, (stations, t) = int(np.argmin(height)), at
        begins = along(side.flank, ends[0][[k]], stations[[k]], self.blank.axial)[1].r
        radii = (float(self.joint.radius(r)[0]) for r in (begins, tip.r[[k]]))
        lost = "no flank is left between the form point (radius {:.6g} mm) and the tip ({:.6g} mm)".format(*radii)
        raise TrimError("flank", float(t[k]), lost, -float(height[k]))

    def _tips(self, t: Array) -> Tips:
        """Return `_tip` of both sides at t (T,)."""
        right, left = (self._tip_of(which, t) for which in Side)
        return right, left

    def _tip_of(self, which: Side, t: Array) -> tuple[Array, Jet]:
        """Return `_tip` of one side at t (T,)."""
        with _trimming(which):
            return self._tip(self.side(which), self.stations(t), t)

    def _tip(self, side: ToothSide, stations: Array, t: Array) -> tuple[Array, Jet]:
        """Solve for the flank's tip: the point on the tip's level, or where a generated chamfer or rounding begins.

        Returns the flank parameter p (T,) and the jet at each station.
        """
        axial, tip = self.blank.axial, self.blank.tip
        if self.crest is not None:
            ends = np.full_like(stations, side.tip)
            return ends, along(side.flank, ends, stations, axial)[1]
        if side.tip_corner is not None:
            begins, _ = self._tip_corner(side, side.tip_corner, stations, t)
            return begins, along(side.flank, begins, stations, axial)[1]

        def at_tip(which: NDArray[np.intp], level: Array) -> Callable[[Array, NDArray[np.intp]], tuple[Array, Array]]:
            """Return the residuals, mm, and their Jacobian for points on given levels (N,), mm, of the tip."""

            def residual(x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
                jet = jet_at(x)
                f = np.stack((axial.value(jet.r) - stations[which[index]], tip.value(jet.r) - level[index]), axis=-1)
                rows = [[dot(g, d) for d in (jet.r_u, jet.r_v)] for g in (axial.gradient(jet.r), tip.gradient(jet.r))]
                return f, np.moveaxis(np.array(rows), -1, 0)

            return residual

        start, start_jet, reached = self._tip_starts(side, stations, t)
        last = start, start_jet

        def jet_at(x: Array) -> Jet:
            """Evaluate the flank at parameters (N, 2); the last result is kept, because every solution begins with the
            last point.
            """
            nonlocal last
            if not np.array_equal(x, last[0]):
                last = x.copy(), side.flank.jet(x[:, 0], x[:, 1])
            return last[1]

        tolerance = trim_tolerance(start_jet.r[reached])
        # two equations, station and tip level, for the flank parameters (p, v)
        solution = newton.solve(at_tip(np.arange(stations.size), np.zeros_like(stations)), start, tolerance=tolerance)
        values, converged = solution.values, solution.converged
        # the flank meets the tip level several times; the physical root lies within 1.5 nominal flank lengths of the form point
        share = (values[:, 0] - side.form_point[0]) / (side.tip - side.form_point[0])
        odd = np.flatnonzero(~(converged & (share > 0.0) & (share < MAX_TIP_SHARE)))
        if odd.size:
            # Newton's method runs to other roots on steep flanks: start from the first crossing of the tip level
            first = newton.solve(
                at_tip(odd, np.zeros(odd.size)), self._near_tip(side, stations[odd]), tolerance=tolerance
            )
            values[odd[first.converged]] = first.values[first.converged]
            converged[odd] |= first.converged
        if not converged.all():
            lost = np.flatnonzero(~converged)
            x = start[lost]
            # a tip far from the tool's nominal tip, as in a throat: approach its level in steps
            for left in TIP_APPROACH_SHARES:
                solution = newton.solve(at_tip(lost, left * tip.value(start_jet.r[lost])), x, tolerance=tolerance)
                x = solution.values
            values[lost], converged[lost] = x, solution.converged
        if not converged.all():
            raise TrimError("tip", float(t[int(np.argmin(converged))]), "the flank does not reach the tip")
        if np.array_equal(t, PROVED_T):
            self._known_tips[self._which(side)] = values
        return values[:, 0], jet_at(values)

    def _tip_starts(self, side: ToothSide, stations: Array, t: Array) -> tuple[Array, Jet, NDArray[np.bool_]]:
        """Return parameters (T, 2) near the tip, their jets, and True (T,) where the nominal tip reaches the station.

        These are polynomials through the tips at the stations of the proof, if they are known and lead close to the tip at all
        stations; else the nominal tip at each station.
        """
        axial = self.blank.axial
        known = self._known_tips.get(self._which(side))
        if known is not None and t.size > 1 and t.min() >= 0.0 and t.max() <= 1.0:
            powers, proved = (np.vander(2.0 * at - 1.0, PROOF_STATIONS) for at in (t, PROVED_T))
            start = powers @ np.linalg.solve(proved, known)
            jet = side.flank.jet(start[:, 0], start[:, 1])
            apart = np.abs([axial.value(jet.r) - stations, self.blank.tip.value(jet.r)])
            if (apart <= NEAR_TIP_SHARE * self.height).all():
                return start, jet, np.ones(t.shape, dtype=bool)
        begin = np.full_like(stations, side.tip) if side.tip_along is None else side.tip_along(stations)
        near = follow(side.flank, begin, stations, axial)
        return np.stack((begin, near.values), axis=-1), near.jet, near.converged

    def _near_tip(self, side: ToothSide, stations: Array) -> Array:
        """Return flank parameters (T, 2) near the first crossing of the tip's level, counted from the form point.

        They are start values for flanks that are steep along the face; NaN at stations where there is no crossing.
        """
        # height over the tip level along the flank at each station; its first change of sign from the form point is the tip
        share = np.linspace(0.0, MAX_TIP_SHARE, TIP_SAMPLES)[:, None]
        p = side.form_point[0] + share * (side.tip - side.form_point[0]) + np.zeros_like(stations)
        curves = follow(side.flank, p, stations, self.blank.axial)
        under: Array = np.where(curves.converged, self.blank.tip.value(curves.jet.r), np.nan)
        crossed: NDArray[np.bool_] = np.asarray(np.diff(under > 0.0, axis=0) & np.isfinite(under[:-1] + under[1:]))
        k, station = crossed.argmax(axis=0), np.arange(stations.size)
        low_under, high_under = under[k, station], under[k + 1, station]
        far = low_under / (low_under - high_under)
        ends = ((x[k, station], x[k + 1, station]) for x in (p, curves.values))
        start = np.stack([low + far * (high - low) for low, high in ends], axis=-1)
        return np.where(np.asarray(crossed.any(axis=0))[:, None], start, np.nan)

    def _tip_corner(self, side: ToothSide, tip_corner: TipCorner, stations: Array, t: Array) -> tuple[Array, Array]:
        """Parameters (T,) of flank and tip corner where they meet at each station."""
        axial = self.blank.axial
        p, q = (np.full_like(stations, parameter) for parameter in tip_corner.form_point)
        if not tip_corner.crossed:
            return p, q
        # the tool's form point lies on one of both surfaces only: solve for their true intersection at each station
        start = [p, along(side.flank, p, stations, axial)[0], q, along(tip_corner.surface, q, stations, axial)[0]]
        solution = intersection((side.flank, tip_corner.surface), np.stack(start, axis=-1), stations, axial)
        if not solution.converged.all():
            raise TrimError("edge", float(t[int(np.argmin(solution.converged))]), "flank and tip chamfer do not meet")
        return solution.values[:, 0], solution.values[:, 2]

    def _root_angle(self, side: ToothSide, stations: Array) -> Array:
        """Polar angle (T,), rad, at which a side's fillet begins at the root, at stations (T,)."""
        return self.joint.angle(self._root_jet(side, stations).r)

    def _root_jet(self, side: ToothSide, stations: Array) -> Jet:
        """Jet (T,) of a side's fillet at the root, at stations (T,)."""
        return along(side.fillet, np.full_like(stations, side.root), stations, self.blank.axial)[1]

    def _width_of_root(self, right: Array, before: Array, t: Array) -> Array:
        """Angle (T,), rad, from the left fillet of the tooth `before` to the right fillet of this tooth, at t (T,).

        Raises TrimError where they overlap.
        """
        # from -pi to pi first; a negative width is an overlap, or a wide root of a thread, up to three quarters of a turn
        width = self.joint.within(right - before)
        width = np.where(width < 0.0, self.joint.wrap(width), width)
        if (width < -1e-12).any():
            k = int(np.argmin(width))
            raise TrimError("root", float(t[k]), "the fillets of neighbouring teeth overlap", -float(width[k]))
        return width

    @cached_property
    def _crosses_below_tip(self) -> bool:
        """True if the sides cross at mid face below a tip that is far above the form point.

        The width of such a tooth falls through half a turn on the way to the tip, so that the angle at the tip alone
        looks like a land.
        """
        if self.teeth < MIN_FOLLOWED_TEETH:
            return False
        station, (tip, at_tip) = self.stations([0.5]), self._tip_in_middle(Side.RIGHT)
        form_point = along(self.right.flank, np.array([self.right.form_point[0]]), station, self.blank.axial)[1].r
        if not self.joint.radius(at_tip.r)[0] > MIN_FAR_TIP_RATIO * self.joint.radius(form_point)[0]:
            return False
        # follow the angles of both sides from the form point to the tip: the width must stay positive
        share, angles = np.linspace(0.0, 1.0, WIDTH_SAMPLES), []
        for side, end in ((self.right, tip[0]), (self.left, self._tip_in_middle(Side.LEFT)[0][0])):
            p = side.form_point[0] + share * (end - side.form_point[0])
            angles.append(self.joint.angle(along(side.flank, p, np.full_like(p, station[0]), self.blank.axial)[1].r))
        return bool((self.joint.running(self.joint.within(angles[1] - angles[0])) <= 0.0).any())

    def _width_of_land(self, right: Array, left: Array, t: Array) -> Array:
        """Angle (T,), rad, between the tips of both sides at t (T,). Raises TrimError where the tooth is pointed."""
        if self._crosses_below_tip:
            raise TrimError("pointed", 0.5, "the tooth is pointed")
        width = self.joint.within(left - right)
        # a land lies within a pitch: only that of a single thread can be wider than half a turn
        if self.pitch_angle > np.pi and (width <= 0.0).any():
            width = np.where(width <= 0.0, width + self._turns_of_land(t), width)
        if (width <= 0.0).any():
            k = int(np.argmin(width))
            raise TrimError("pointed", float(t[k]), "the tooth is pointed", -float(width[k]))
        return width

    def _turns_of_land(self, t: Array) -> Array:
        """Multiples (T,) of 2 pi, rad, to add to the width of the land when it is continued from mid face to t (T,).

        The land of a single thread spans nearly a full turn where the thread runs out.
        """
        # sample the face finely enough that the width changes by less than half a turn, and count its full turns from mid face
        stretches = pairwise(distinct(np.array([0.0, *self._bends, 0.5, 1.0])))
        way = distinct(np.concatenate([t, *(np.linspace(*ends, LAND_STATIONS) for ends in stretches)]))
        right, left = (self.joint.angle(self._tip(self.side(side), self.stations(way), way)[1].r) for side in Side)
        width = self.joint.within(left - right)
        turns = self.joint.running(width) - width
        grown: Array = (turns - turns[way == 0.5])[np.searchsorted(way, t)]
        return grown


@contextmanager
def _trimming(side: Side) -> Iterator[None]:
    """Name the side in a TrimError from the block."""
    try:
        yield
    except TrimError as failure:
        failure.side = failure.side or side.value
        raise


def _changes(holds: Callable[[Array], NDArray[np.bool_]]) -> Array:
    """Find the stations t inside (0, 1) where a condition begins or ends, ascending, each on the side where it does not
    hold.
    """
    # samples show the changes; each is then narrowed by division, because the condition has no equation
    t = np.linspace(0.0, 1.0, BREAK_SAMPLES)
    samples = holds(t)
    change = np.flatnonzero(samples[:-1] != samples[1:])
    was = samples[change]

    def as_before(at: Array, k: NDArray[np.intp]) -> NDArray[np.bool_]:
        return np.asarray(holds(at) == was[k])

    low, high = last_true(as_before, t[change], t[change + 1], rounds=1, split=FIRST_BREAK_PARTS)
    low, high = last_true(as_before, low, high, rounds=BREAK_ROUNDS, split=BREAK_PARTS)
    return np.where(was, high, low)


def _strip_outline(strip: EndStrip, piece: StripPiece, nodes: Array) -> tuple[Array, Array]:
    """Points of a piece of a chamfer at nodes in both directions, and their derivatives along the outline, (S, T, 3)
    each.
    """
    at, ahead, behind = (strip.at(piece, s[:, None], nodes) for s in (nodes, nodes + HALF_STEP, nodes - HALF_STEP))
    return at, (ahead - behind) / (2.0 * HALF_STEP)
