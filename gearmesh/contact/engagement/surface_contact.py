"""Surface contact of one tooth pair: its beginning and its end, as roots in phi1.

Point contact begins and ends on an edge of a flank. Line contact begins and ends where the line has shrunk to the point between two
edges. The overlap is the rotation between the ends of the line at both ends of the face.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.bent_lines import directions
from gearmesh.contact.conditions.events import Events, reaches
from gearmesh.contact.conditions.line_ends import line_ends
from gearmesh.contact.conditions.lines import MIN_STATION_SHARE, on_edges, trace
from gearmesh.contact.conditions.meshing import Bound, Conditions
from gearmesh.contact.conditions.refinement import EDGE_SLACK, EQUAL_ADVANCE_RAD, Contacts, advances_of, margins
from gearmesh.contact.engagement.engagement import Engagement
from gearmesh.contact.first_touch.first_touch import first_touch
from gearmesh.contact.pair import Pair, along_face, within
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.numeric.roots import bracketed_root, last_true
from gearmesh.records import dataclass

#: rounds of division that find a change of the kind of contact for which no equation exists
DIVISION_ROUNDS = 11
#: parts into which one round divides its interval
PARTS_PER_ROUND = 8
#: stations at which a line is sampled
LINE_STATIONS = 33
#: rounds in which the stations close in on the point nearest to the flanks
REFINING_ROUNDS = 6
#: evaluations of a point of a line at most: points of the line need up to 30, other points 230
MAX_EVALUATIONS = 40
#: shares of the way along an edge from one end of the face to the other, in steps that double
DOUBLING_SHARES = 0.5 ** np.arange(6, -1, -1)


@dataclass(frozen=True)
class SurfaceContact:
    """Surface contact of pair 0 from phi1 = `begin` to `end` (rad), NaN without surface contact.

    `overlap` (rad) is the lag of one end of the face behind the other in line contact, NaN in point contact and where unknown.
    """

    begin: float
    end: float
    overlap: float

    @property
    def length(self) -> float:
        """Rotation phi1 from beginning to end, rad."""
        return self.end - self.begin


def surface_contact(engagement: Engagement, carries: NDArray[np.bool_]) -> SurfaceContact:
    """Solve for the ends of the surface contact of a tooth pair that has been followed.

    Interrupted surface contact counts in its longest part in which the pair `carries` (N,) at some position. Contact while the
    neighbours are far ahead is not part of the mesh.
    """
    return _Ends(engagement).whole(carries)


def _inside(c: Contacts) -> NDArray[np.bool_]:
    """Return True (N,) where contact is inside both flanks, or on a crease inside them."""
    edges = c.edges[:, 0]
    inside: NDArray[np.bool_] = c.touching & ((edges < 0) | within(edges))
    return inside


@dataclass(frozen=True)
class _End:
    """End of surface contact, after node `last` and before node `beyond`."""

    last: int
    beyond: int

    @property
    def step(self) -> int:
        return self.beyond - self.last


class _Ends:
    """Solver for the ends of surface contact, each between two nodes of the engagement."""

    def __init__(self, engagement: Engagement) -> None:
        self.pair, self.flanks, self.phi1 = engagement.pair, engagement.flanks, engagement.phi1

    def whole(self, carries: NDArray[np.bool_]) -> SurfaceContact:
        """Solve for both ends and the overlap; see `surface_contact`."""
        # the longest run of nodes with surface contact that is in contact somewhere
        c = self.flanks
        inside = np.flatnonzero(_inside(c))
        if not inside.size:
            return SurfaceContact(np.nan, np.nan, np.nan)
        runs = np.split(inside, np.flatnonzero(np.diff(inside) > 1) + 1)
        run = max(runs, key=lambda run: (bool(carries[run].any()), len(run)))
        both_ends = [_End(int(run[0]), int(run[0]) - 1), _End(int(run[-1]), int(run[-1]) + 1)]
        # of each end: phi1, and phi1 at which the line reaches the other end of the face
        known: dict[_End, tuple[float, float]] = {
            end: (float(self.phi1[end.last]), np.nan) for end in both_ends if not 0 <= end.beyond < len(self.phi1)
        }
        if self.pair.coupled:
            # teeth in mesh at every rotation: the count of the pair begins and ends, the contact goes on
            known |= {
                end: (at, np.nan) for end, at in zip(both_ends, self.pair.turn, strict=True) if self._between(at, end)
            }
        open_ends = [end for end in both_ends if end not in known]
        lines = [end for end in open_ends if c.line[end.last]]
        points = [end for end in open_ends if end not in lines]
        # point contact ends on an edge; bent lines of threads shrink to a point; other lines shrink into a corner of two edges
        if points:
            known |= self._point_ends(points)
        if lines and self.pair.wound:
            known |= self._wound_ends(lines)
            lines = [end for end in lines if end not in known]
        for own, piece in self.pair.pieces(c.x[[end.last for end in lines]]) if lines else ():
            on_piece = [lines[k] for k in own]
            last = [end.last for end in on_piece]
            middles = trace(piece, self.phi1[last], c.x[last]).x
            known |= self._line_ends(piece, on_piece, middles)
            for end, middle in zip(on_piece, middles, strict=True):
                if end not in known:
                    known[end] = self._undercut_end(end, middle) or (self._shrunk(piece, end), np.nan)
        # no equation gave the other ends: divide the step between the nodes
        known |= {end: (self._bisect(end), np.nan) for end in both_ends if end not in known}
        begin, end = known[both_ends[0]], known[both_ends[1]]
        overlap = np.nan
        if bool(c.line[run].all()):
            overlaps = [abs(other - own) for own, other in (begin, end) if np.isfinite(other)]
            overlap = float(np.mean(overlaps)) if overlaps else np.nan
        return SurfaceContact(begin[0], end[0], overlap)

    def _sides(self, end: _End) -> tuple[Array, Array]:
        """Return phi1 (1,) of the last node with and of the first node without surface contact."""
        return self.phi1[[end.last]], self.phi1[[end.beyond]]

    def _between(self, phi1: float, end: _End) -> bool:
        nodes = np.clip((end.last, end.beyond), 0, len(self.phi1) - 1)
        low, high = sorted(self.phi1[nodes])
        return bool(low - 1e-12 <= phi1 <= high + 1e-12)

    def _point_ends(self, ends: list[_End]) -> dict[_End, tuple[float, float]]:
        """Solve for phi1 at which the points of contact of the last nodes reach an edge; ends without a root are left out."""
        pair, rows = self.pair, np.arange(len(ends))
        last, beyond = (np.array([getattr(end, name) for end in ends]) for name in ("last", "beyond"))
        start = self.flanks.x[last]
        conditions = Conditions(pair.flanks, self.phi1[beyond], pair.length)
        # try first the edges beyond which the point would lie at the next node
        solved = newton.solve(conditions, start, tolerance=pair.tolerance, max_step=pair.max_step, max_iterations=15)
        outside = margins(pair, conditions.touch(solved.values, rows), solved.values)[0]
        outside[~solved.converged] = 0.0
        absent = np.isin(np.arange(len(pair.bounds)), pair.ends, invert=True)
        order = np.argsort(np.where(absent, np.inf, -outside), axis=1, kind="stable")
        places: dict[_End, tuple[float, float]] = {}
        before = replace(conditions, phi1=self.phi1[last])
        for rank in range(len(pair.ends)):
            left = np.array([k for k in rows if ends[k] not in places])
            if not left.size:
                break
            edge = order[left, rank]
            event = reaches(pair, before.repeat(left), edge, start[left])
            at = replace(conditions.repeat(left), phi1=event.phi1)
            touch = at.touch(event.x, np.arange(left.size))
            # the root counts if the point lies on both flanks, which face each other, between the two nodes
            beyond_edges, past = margins(pair, touch, event.x)
            beyond_edges[np.arange(left.size), edge] = 0.0
            good = event.reached & (beyond_edges <= EDGE_SLACK).all(axis=1) & (past <= EDGE_SLACK)
            good &= dot(touch.fixed[0].n, touch.fixed[1].n) < 0.0
            for k, phi1, fine in zip(left, event.phi1.tolist(), good, strict=True):
                if fine and self._between(phi1, ends[k]):
                    places[ends[k]] = phi1, np.nan
        return places

    def _wound_ends(self, ends: list[_End]) -> dict[_End, tuple[float, float]]:
        """Solve for phi1 at which bent lines of the last nodes have shrunk to a point; roots beyond the next node are left out."""
        last, beyond = ([getattr(end, name) for end in ends] for name in ("last", "beyond"))
        within = 2.0 * float(np.abs(self.phi1[beyond] - self.phi1[last]).max())
        with np.errstate(all="ignore"):
            shrunk = line_ends(self.pair.parts[0], self.phi1[last], self.flanks.x[last], within)
        places: dict[_End, tuple[float, float]] = {}
        for k, end in enumerate(ends):
            # of several roots the last one in the direction of the end: the line exists up to there
            phi1 = np.array([at for at in shrunk.phi1[shrunk.line == k].tolist() if self._between(at, end)])
            if phi1.size:
                places[end] = float(phi1[(phi1 * end.step).argmax()]), np.nan
        return places

    def _line_ends(self, pair: Pair, ends: list[_End], x: Array) -> dict[_End, tuple[float, float]]:
        """Solve for phi1 at which lines with middles x (M, 5) have shrunk to a point between two edges.

        The second value is phi1 at which the line meets the first edge at the other end of the face. Beyond its end, every edge
        that crosses the line leaves one side of it on the flanks. The line ended between the two edges that leave nothing between
        them. Ends without a root are left out.
        """
        rows = np.arange(len(ends))
        last, beyond = (np.array([getattr(end, name) for end in ends]) for name in ("last", "beyond"))
        before, plain = (Conditions(pair.flanks, self.phi1[k], pair.length) for k in (last, beyond))
        # follow the middle of the last line at its station to the next node
        axial = pair.pinion.axial
        touch = before.touch(x, rows)
        station, across = axial.value(touch.own[0].r), directions(pair, touch)[1]
        at_station = replace(plain, bounds=(Bound(0, axial, station),), across=across)
        x = x + np.array([0.0, 0.0, 0.0, 0.0, pair.ratio]) * (plain.phi1 - before.phi1)[:, None]
        followed = newton.solve(at_station, x, tolerance=pair.tolerance, max_step=pair.max_step)
        x = np.where(followed.converged[:, None], followed.values, x)
        # places along the line where edges cross it, and the two edges between which it ended
        touch = plain.touch(x, rows)
        along, across = directions(pair, touch)
        beyond_edges = margins(pair, touch, x)[0]
        places: list[dict[int, float]] = [{} for _ in ends]
        meets = on_edges(pair, plain, across, x)
        for number, (values, met) in meets.items():
            place = dot(plain.touch(values, rows).fixed[0].r - touch.fixed[0].r, along)
            for k in np.flatnonzero(met & followed.converged):
                places[k][number] = float(place[k])
        corners = [(int(k), *corner) for k in rows for corner in self._corners(places[k], beyond_edges[k])]
        if not corners:
            return {}
        # solve for the meeting of the line with both edges of each corner
        position, first, other = np.array(corners).T
        choice = np.stack((other, np.full_like(other, -1)), axis=-1)
        at_edges = replace(plain.repeat(position), bounds=pair.all_bounds, across=across[position])
        at_edges = replace(at_edges, choice=pair.numbers[choice])
        start = np.array([meets[number][0][k] for k, number in zip(position, other, strict=True)])
        event = reaches(pair, at_edges, first, start)
        good = self._on_flanks(event)
        # the corner that the line reaches last is its end, the corner reached first its other end
        line_ends: dict[_End, tuple[float, float]] = {}
        for k in rows:
            which = np.flatnonzero(good & (position == k))
            if not which.size:
                continue
            after = (event.phi1[which] - self.phi1[last[k]]) * ends[k].step
            pick = which[after.argmax()]
            own_end, other_end = float(event.phi1[pick]), float(event.phi1[which[after.argmin()]])
            advance = float(advances_of(pair, event.phi1, event.x, np.arange(len(position)))[pick])
            both = self._apart(event, which)
            if (both or not along_face(int(first[which[0]]))) and (
                self._between(own_end, ends[k]) or self._goes_on(own_end, advance, ends[k])
            ):
                line_ends[ends[k]] = own_end, other_end if along_face(int(first[which[0]])) else np.nan
        return line_ends

    def _undercut_end(self, end: _End, middle: Array) -> tuple[float, float] | None:
        """Solve for the end of a line on an undercut flank, from the line of the last node with its `middle` (5,).

        The line ends at the edge along the face, at one end of the face, that it reaches last; None where it reaches no edge.
        Beyond this end the flank meets its edge, and the mating tip meets the flank, once more on the other branch of the involute.
        """
        # candidates: each edge along the face with each edge up the profile that the line crosses
        pair = self.pair
        plain = Conditions(pair.flanks, self.phi1[[end.last]], pair.length)
        x = middle[None]
        _, across = directions(pair, plain.touch(x, np.zeros(1, dtype=np.intp)))
        meets = {number: values for number, (values, met) in on_edges(pair, plain, across, x).items() if met[0]}
        choices = [(a, b) for a in pair.ends if along_face(a) for b in meets if not along_face(b)]
        if not choices:
            return None
        first, other = np.array(choices).T
        whole = plain.repeat(np.zeros(len(choices), dtype=np.intp))
        whole = replace(whole, bounds=pair.all_bounds, across=np.repeat(across, len(choices), axis=0))
        whole = replace(whole, choice=pair.numbers[np.stack((other, np.full_like(other, -1)), axis=-1)])
        event = reaches(pair, whole, first, np.concatenate([meets[b] for b in other]))
        good = np.flatnonzero(self._on_flanks(event))
        if not good.size:
            return None
        # the line exists until it reaches the last of these corners
        last = good[(event.phi1[good] * end.step).argmax()]
        own_end, advance = float(event.phi1[last]), advances_of(pair, event.phi1, event.x, np.arange(len(first)))[last]
        if not self._between(own_end, end) and not self._goes_on(own_end, float(advance), end):
            return None
        return own_end, self._other_end(whole.repeat(np.array([last])), int(first[last]), event, int(last), end)

    def _other_end(self, at: Conditions, edge: int, event: Events, own: int, end: _End) -> float:
        """Solve for phi1 (rad) at which the line meets the same edge at the other end of the face; NaN without such a root.

        The search starts from event `own` with conditions `at` (1,) and walks along the edge in steps that double. Each step starts
        from the extrapolation of the last two places, which is exact for a screw motion. One step would be too long where few
        teeth wind far round their axis.
        """
        # unknowns of the event (5 and phi1), and its distances from the ends of the face
        pair = self.pair
        begin = np.append(event.x[own], event.phi1[own])
        jets = replace(at, phi1=begin[5:]).touch(begin[None, :5], np.zeros(1, dtype=np.intp)).own
        across = [
            bound for k, bound in enumerate(pair.bounds) if k in pair.ends and bound is not None and not along_face(k)
        ]
        away = np.array([float(bound.level.value(jets[bound.member].r)[0]) for bound in across])
        far = np.flatnonzero(np.abs(away) > MIN_STATION_SHARE * pair.length)
        count = len(far)
        y, reached = np.tile(begin, (count, 1)), np.full(count, True)
        events = Events(y[:, 5], y[:, :5], reached)
        choice = np.stack((np.arange(count), np.full(count, -1)), axis=-1)
        repeated = at.repeat(np.zeros(count, dtype=np.intp))
        for share in DOUBLING_SHARES if count else ():
            # the next place on the edge, at a share of the way to the other end
            bounds = tuple(replace(across[k], target=away[far] * (1.0 - share)) for k in far)
            y = begin + (1.0 if share == DOUBLING_SHARES[0] else 2.0) * (y - begin)
            placed = replace(repeated, phi1=y[:, 5], bounds=bounds, choice=choice)
            events = reaches(pair, placed, np.full(count, edge), y[:, :5])
            y, reached = np.column_stack((events.x, events.phi1)), reached & events.reached
        met = np.flatnonzero(reached & self._on_flanks(events))
        return float(events.phi1[met[(events.phi1[met] * end.step).argmin()]]) if met.size else np.nan

    def _apart(self, event: Events, which: NDArray[np.intp]) -> bool:
        """Return True if events `which` lie at both ends of the face."""
        r = self.pair.pinion.surface.jet(event.x[which, 0], event.x[which, 1]).r
        return bool(which.size > 1 and np.ptp(self.pair.pinion.axial.value(r)) > MIN_STATION_SHARE * self.pair.length)

    def _goes_on(self, phi1: float, advance: float, end: _End) -> bool:
        """Return True if a line that ends at phi1 (rad) with `advance` (rad) covers nodes whose contact is less advanced."""
        nodes = self.phi1[end.beyond :: end.step]
        passed = (nodes - phi1) * end.step < 0.0
        before = float(self.phi1[end.last]), float(self.flanks.advance[end.last])
        line = before[1] + (advance - before[1]) * (nodes - before[0]) / (phi1 - before[0])
        theirs = self.flanks.advance[end.beyond :: end.step]
        return bool(passed.any() and (theirs[passed] < line[passed] - EQUAL_ADVANCE_RAD).all())

    def _on_flanks(self, event: Events) -> NDArray[np.bool_]:
        """Return True (M,) for events that are found and lie on both flanks."""
        at = Conditions(self.pair.flanks, event.phi1, self.pair.length).touch(event.x, np.arange(len(event.phi1)))
        outside, past = margins(self.pair, at, event.x)
        on_flanks: NDArray[np.bool_] = (
            event.reached & (outside <= 10.0 * EDGE_SLACK).all(axis=1) & (past <= 10.0 * EDGE_SLACK)
        )
        return on_flanks

    def _shrunk(self, pair: Pair, end: _End) -> float:
        """Solve for phi1 (rad) at which no point of a line is left on both flanks: the least margin of its points is 0."""
        # start at the last node with contact on the flanks; the line moves on with the turning gears from there
        axial, start = pair.pinion.axial, self.flanks.x[[end.last]]
        low, high = self._sides(end)
        before = Conditions(pair.flanks, low, pair.length)
        _, across = directions(pair, before.touch(start, np.zeros(1, dtype=np.intp)))

        def least(phi1: Array, _index: NDArray[np.intp]) -> Array:
            """Return the least margin (1,), mm, of the line at phi1 (1,)."""
            x = start + np.array([0.0, 0.0, 0.0, 0.0, pair.ratio]) * (phi1 - low)[:, None]
            first, last = pair.pinion.extent
            # sample the line at stations, then around the station nearest to the flanks
            least_margin = np.inf
            for _ in range(REFINING_ROUNDS):
                station = np.linspace(first, last, LINE_STATIONS)
                conditions = Conditions(
                    pair.flanks,
                    np.repeat(phi1, LINE_STATIONS),
                    pair.length,
                    (Bound(0, axial, station),),
                    np.repeat(across, LINE_STATIONS, axis=0),
                )
                # the point of the line in each station: tangency of both flanks, with the station in the place of first touch
                solved = newton.solve(
                    conditions,
                    np.repeat(x, LINE_STATIONS, axis=0),
                    tolerance=pair.tolerance,
                    max_step=pair.max_step,
                    max_evaluations=MAX_EVALUATIONS,
                )
                touch = conditions.touch(solved.values, np.arange(LINE_STATIONS))
                outside, past = margins(pair, touch, solved.values)
                margin = np.where(solved.converged, np.maximum(outside.max(axis=1), past), np.inf)
                k = int(margin.argmin())
                if not margin[k] < least_margin:
                    break
                least_margin, x = float(margin[k]), solved.values[[k]]
                step = (last - first) / (LINE_STATIONS - 1)
                first, last = station[k] - step, station[k] + step
            return np.array([least_margin])

        # points are left at `low` and none at `high`: the bracket holds the rotation at which contact ends
        root = bracketed_root(least, low, high, tolerance=1e-12)
        return float(root.values[0]) if root.converged[0] else self._bisect(end)

    def _corners(self, places: dict[int, float], own: Array) -> list[tuple[int, int]]:
        """Return the pairs of edges between which a line may have ended; all have the same first edge.

        `places` are the crossings of edges along the line (mm), `own` (10,) the distances of its middle beyond each edge.
        """
        # an edge that the line does not cross has it all inside or all outside
        off = [k for k in self.pair.ends if k not in places and own[k] > 0.0]
        if off and places:
            first, others = off[0], list(places)
        else:
            sides: dict[bool, list[int]] = {True: [], False: []}
            for k, place in places.items():
                sides[(own[k] > 0.0) == (place > 0.0)].append(k)
            if not sides[True] or not sides[False]:
                return []
            low = max(sides[True], key=lambda k: places[k])
            high = min(sides[False], key=lambda k: places[k])
            first, others = (low, [high]) if along_face(low) else (high, [low])
        faces = [k for k in places if not along_face(k) and k != first]
        return [(first, other) for other in sorted({*others, *faces})]

    def _bisect(self, end: _End) -> float:
        """Find phi1 (rad) of an end by repeated division of the step between two nodes, by the kind of contact alone."""

        def inside(phi1: Array, _: NDArray[np.intp]) -> NDArray[np.bool_]:
            c = first_touch(self.pair.parts[0], phi1)
            return _inside(c)

        low, high = self._sides(end)
        low, high = last_true(inside, low, high, rounds=DIVISION_ROUNDS, split=PARTS_PER_ROUND)
        return float(0.5 * (low[0] + high[0]))
