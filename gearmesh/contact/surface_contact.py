"""Where one pair of teeth has surface contact: from where it begins to where it ends, as roots in phi1.

A point of contact begins and ends on an edge of either flank. A line of contact does where it has shrunk to the point between two
edges; how much later it would at the other end of the face is the overlap.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.engagement import Engagement
from gearmesh.contact.events import Event, reaches
from gearmesh.contact.first_touch import first_touch
from gearmesh.contact.lines import directions, on_edge, traced
from gearmesh.contact.meshing import Bound, Conditions
from gearmesh.contact.pair import EDGES
from gearmesh.contact.settle import EDGE_SLACK, TOLERANCE, margins
from gearmesh.kernel import newton
from gearmesh.kernel.algebra import Array, dot
from gearmesh.kernel.roots import last_true

#: a change of the kind of contact that no equation gives is found by division, in so many rounds and parts
ROUNDS, SPLIT = 11, 8


@dataclass(frozen=True)
class SurfaceContact:
    """phi1 (rad) at which the surface contact of pair 0 begins and ends, NaN where there is none; `overlap` (rad): of a line of
    contact the part of that by which one end of the face is behind the other, NaN for points."""

    begin: float
    end: float
    overlap: float

    @property
    def length(self) -> float:
        """phi1 from beginning to end, rad."""
        return self.end - self.begin


def surface_contact(engagement: Engagement) -> SurfaceContact:
    """The surface contact of a tooth pair that has been followed; the longest, where it is interrupted."""
    return _Ends(engagement).whole()


class _Ends:
    """The ends of surface contact, each between two nodes of the engagement."""

    def __init__(self, engagement: Engagement) -> None:
        self.pair, self.flanks, self.phi1 = engagement.pair, engagement.flanks, engagement.phi1

    def whole(self) -> SurfaceContact:
        """Where it begins and ends, and what part of that is overlap."""
        c = self.flanks
        inside = np.flatnonzero(c.touching & (c.edges[:, 0] < 0))
        if not inside.size:
            return SurfaceContact(np.nan, np.nan, np.nan)
        runs = np.split(inside, np.flatnonzero(np.diff(inside) > 1) + 1)
        run = max(runs, key=len)
        ends = [self._end(int(run[0]), -1), self._end(int(run[-1]), 1)]
        begin, end = ends[0][0], ends[1][0]
        overlap = np.nan
        if bool(c.line[run].all()):
            overlaps = [abs(other - own) for own, other in ends if np.isfinite(other)]
            overlap = float(np.mean(overlaps)) if overlaps else 0.0
        return SurfaceContact(begin, end, overlap)

    def _end(self, last: int, step: int) -> tuple[float, float]:
        """phi1 where surface contact ends beyond node `last`; of a line also where it would if it ended at its other end."""
        beyond = last + step
        if not 0 <= beyond < len(self.phi1):
            return float(self.phi1[last]), np.nan
        if self.flanks.line[last]:
            found = self._line_end(last, beyond)
            if found is not None:
                return found
        else:
            event = self._point_end(last, beyond)
            if event is not None:
                return event.phi1, np.nan
        return self._divided(last, beyond), np.nan

    def _between(self, phi1: float, last: int, beyond: int) -> bool:
        low, high = sorted((self.phi1[last], self.phi1[beyond]))
        return bool(low - 1e-12 <= phi1 <= high + 1e-12)

    def _point_end(self, last: int, beyond: int) -> Event | None:
        """Where the contact of node `last` comes to an edge."""
        flat = np.zeros(1, dtype=np.intp)
        conditions = Conditions(self.pair.flanks, self.phi1[[beyond]], self.pair.length)
        start = Event(float(self.phi1[last]), self.flanks.x[last])
        # the edges that it would lie beyond at the next node come first
        there = newton.solve(
            conditions, start.x[None], tolerance=TOLERANCE, max_step=self.pair.max_step, max_iterations=15
        )
        outside = margins(self.pair, conditions.touch(there.values, flat), there.values)[0][0]
        order = np.argsort(-outside, kind="stable") if there.converged[0] else np.arange(len(outside))
        for number in order:
            bound = self.pair.bounds[number]
            event = None if bound is None else reaches(self.pair, conditions, bound, start)
            if event is None or not self._between(event.phi1, last, beyond):
                continue
            at = replace(conditions, phi1=np.array([event.phi1]))
            touch = at.touch(event.x[None], flat)
            beyond_edges, joint = margins(self.pair, touch, event.x[None])
            beyond_edges[0, number] = 0.0
            facing = dot(touch.fixed[0].n, touch.fixed[1].n)[0] < 0.0
            if (beyond_edges <= EDGE_SLACK).all() and (joint <= EDGE_SLACK).all() and facing:
                return event
        return None

    def _line_end(self, last: int, beyond: int) -> tuple[float, float] | None:
        """Where the line of node `last` has shrunk to a point between two edges; and where it meets the first at its other end.

        Along the line beyond, every edge leaves one side of where it crosses; the two edges that leave nothing between them are
        those between which it ended.
        """
        pair, phi1, one = self.pair, self.phi1[[beyond]], np.zeros(1, dtype=np.intp)
        before, plain = (Conditions(pair.flanks, self.phi1[[k]], pair.length) for k in (last, beyond))
        # the middle of the last line, followed at its station
        x = traced(pair, before.phi1, self.flanks.x[[last]]).x
        axial = pair.pinion.axial
        station = axial.value(before.touch(x, one).own[0].r)
        _, across = directions(pair, before, x)
        at_station = replace(plain, bounds=(Bound(0, axial, station),), across=across)
        x = x + np.array([0.0, 0.0, 0.0, 0.0, pair.ratio]) * (phi1 - before.phi1)
        found = newton.solve(at_station, x, tolerance=TOLERANCE, max_step=pair.max_step)
        if not found.converged[0]:
            return None
        x = found.values
        along, across = directions(pair, plain, x)
        touch = plain.touch(x, one)
        own = margins(pair, touch, x)[0][0]
        crossing: dict[int, tuple[float, Array]] = {}
        for number, bound in enumerate(pair.bounds):
            if bound is not None:
                meets = on_edge(pair, plain, bound, across, x)
                if meets.converged[0]:
                    r = plain.touch(meets.values, one).fixed[0].r - touch.fixed[0].r
                    crossing[number] = (float(dot(r, along)[0]), meets.values)
        # an edge that the line does not cross has it all inside or all outside
        off = [k for k, bound in enumerate(pair.bounds) if bound is not None and k not in crossing and own[k] > 0.0]
        if off:
            first, others = off[0], list(crossing)
        else:
            sides: dict[bool, list[int]] = {True: [], False: []}
            for k, (place, _) in crossing.items():
                sides[(own[k] > 0.0) == (place > 0.0)].append(k)
            if not sides[True] or not sides[False]:
                return None
            low = max(sides[True], key=lambda k: crossing[k][0])
            high = min(sides[False], key=lambda k: crossing[k][0])
            first, others = (low, [high]) if low % len(EDGES) == 0 else (high, [low])
        if not others:
            return None
        faces = [k for k in crossing if k % len(EDGES) != 0 and k != first]
        ends = {}
        for other in {*others, *faces}:
            start = Event(float(phi1[0]), crossing[other][1][0])
            extra, bound = pair.bounds[first], pair.bounds[other]
            assert extra is not None
            assert bound is not None
            corner = Conditions(pair.flanks, np.zeros(1), pair.length, (bound,), across)
            event = reaches(pair, corner, extra, start)
            if event is None:
                continue
            at = Conditions(pair.flanks, np.array([event.phi1]), pair.length).touch(event.x[None], one)
            outside, joint = margins(pair, at, event.x[None])
            if (outside <= 10.0 * EDGE_SLACK).all() and (joint <= 10.0 * EDGE_SLACK).all():
                ends[other] = event.phi1
        if not ends:
            return None
        own_end = max(ends.values(), key=lambda end: (end - self.phi1[last]) * np.sign(beyond - last))
        if not self._between(own_end, last, beyond):
            return None
        other_end = min(ends.values(), key=lambda end: (end - self.phi1[last]) * np.sign(beyond - last))
        return own_end, other_end if first % len(EDGES) == 0 else np.nan

    def _divided(self, last: int, beyond: int) -> float:
        """The same by repeated division, where nothing but the kind of contact tells."""

        def inside(phi1: Array, _: NDArray[np.intp]) -> NDArray[np.bool_]:
            c = first_touch(self.pair.parts[0], phi1)
            found: NDArray[np.bool_] = c.touching & (c.edges[:, 0] < 0)
            return found

        low, high = (np.array([self.phi1[k]]) for k in (last, beyond))
        low, high = last_true(inside, low, high, rounds=ROUNDS, split=SPLIT)
        return float(0.5 * (low[0] + high[0]))
