"""Views of a member on paper: axial section and view along the axis, of a rack front view and section [ISO 128, ISO
2203].

First-angle projection: the view from the left is drawn on the right. The side with the teeth or the hub looks to the
left. The x axis is up in both views: the first tooth lies there, and the keyway, a corner or a flat of the bore.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from itertools import pairwise
from typing import Protocol

import numpy as np

from gearmesh.drawing.canvas import LETTER_HEIGHT_MM, Canvas, Pen
from gearmesh.drawing.dimensions import Span, note, room, stack
from gearmesh.drawing.facts import Facts, diameter, number
from gearmesh.drawing.outline import Outline, bar_faces, end_of_teeth, outline_of, tip_edges
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.plane.curves import PlaneArc
from gearmesh.records import dataclass
from gearmesh.teeth.blank.features import Drilling, HoleRow, Spokes
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Region

#: distance between views
VIEW_DISTANCE_MM = 10.0
#: length of chain lines beyond outlines
CHAIN_OVERRUN_MM = 4.0
#: smallest pitch on paper at which all teeth are drawn
MIN_TOOTH_PITCH_MM = 3.0
#: number of teeth that are drawn at a smaller pitch
TEETH_DRAWN = 5
#: length that counts as 0
ZERO_LENGTH_MM = 1e-6
#: regions of steps whose length is a dimension
LENGTH_REGIONS = (Region.HUB, Region.SHAFT, Region.COUNTERBORE, Region.RIM)
#: height of a text over the teeth of a rack
TEXT_ABOVE_TEETH_MM = 5.0
#: points on each arc of a bore: odd, so that the middle is one of them
BORE_POINTS = 181
#: points on each curve of an opening
CURVE_POINTS = 33


class Views(Protocol):
    """The views of a member."""

    def size(self, scale: float) -> tuple[float, float]:
        """Return width and height on paper with all dimensions, mm."""

    def draw(self, canvas: Canvas, scale: float, left: float, low: float) -> None:
        """Draw the views at a scale, above and to the right of a corner."""


def views_of(member: Member, facts: Facts) -> Views:
    """Return the views of a gear or of a rack."""
    outline = outline_of(member)
    return (WheelViews if member.body.bore_diameter is not None else RackViews)(member, outline, facts)


@dataclass(frozen=True)
class _Length:
    """A length along the axis from `low` to `high` z, measured at the radii `near`."""

    low: float
    high: float
    near: tuple[float, float]


@dataclass(frozen=True)
class _Diameter:
    """A diameter with its position; mm."""

    #: the diameter
    value: float
    #: lowest z at which it is found
    low: float
    #: highest z at which it is found
    high: float
    #: text of the dimension
    text: str


@dataclass(frozen=True)
class WheelViews:
    """Axial section and end view of a gear."""

    member: Member
    outline: Outline
    facts: Facts

    @cached_property
    def side(self) -> float:
        """Side that the end view shows: 1 from larger z, -1 from smaller."""
        rise = sum(float((row.tip - row.root)[:, 0].sum()) for row in self.outline.rows[:1])
        if abs(rise) > ZERO_LENGTH_MM:
            return 1.0 if rise > 0.0 else -1.0
        return -1.0 if self.member.hub is None else 1.0

    @cached_property
    def tip(self) -> Array:
        """Points (N, 2) of the tip, (z, rho)."""
        return np.concatenate([row.tip for row in self.outline.rows])

    @property
    def is_cylindrical(self) -> bool:
        """True if the tip has the same diameter along the face."""
        return float(np.ptp(self.tip[:, 1])) < ZERO_LENGTH_MM

    @cached_property
    def own(self) -> list[_Diameter]:
        """Diameters of the teeth."""
        widest = self.tip[np.abs(self.tip[:, 1] - self.tip[:, 1].max()) < ZERO_LENGTH_MM]
        value = 2.0 * widest[0, 1] if self.facts.tip is None else self.facts.tip
        tip = diameter(float(value), self.facts.tip_deviations)
        diameters = [_Diameter(2.0 * widest[0, 1], widest[:, 0].min(), widest[:, 0].max(), tip)]
        if self.facts.reference is not None:
            place = np.concatenate([row.on_ends(self._reference_radii) for row in self.outline.rows])
            place = place[np.abs(place[:, 1] - place[:, 1].max()) < ZERO_LENGTH_MM]
            diameters.append(
                _Diameter(2.0 * place[0, 1], place[:, 0].min(), place[:, 0].max(), f"({diameter(2.0 * place[0, 1])})")
            )
        return diameters

    @property
    def _reference_radii(self) -> tuple[float, float]:
        """Reference radii at toe and heel, mm."""
        assert self.facts.reference is not None
        first, last = self.facts.reference
        return 0.5 * first, 0.5 * last

    @cached_property
    def body(self) -> list[_Diameter]:
        """Diameters of the body, one for each size."""
        profile = self.member.body.profile
        sizes: dict[float, list[float]] = {}
        sizes_of_teeth = [radius.value for radius in self.own]
        for (rho, z), (other, end) in pairwise(profile):
            places = {rho: (z, end)} if rho == other else {} if z == end else {rho: (z,), other: (end,)}
            for radius, z_values in places.items():
                bored = self.bore_is_round or radius != self.member.body.bore_radius
                if radius > 0.0 and bored and not any(abs(2.0 * radius - value) < 1e-3 for value in sizes_of_teeth):
                    sizes.setdefault(round(radius, 6), []).extend(z_values)
        for gap in self.member.gaps:
            sizes.setdefault(round(0.5 * gap.diameter, 6), []).extend(gap.body.ends)
        return [_Diameter(2.0 * rho, min(z), max(z), diameter(2.0 * rho)) for rho, z in sizes.items()]

    @cached_property
    def lengths(self) -> list[_Length]:
        """Lengths along the axis, without duplicates."""
        body, rows = self.member.body, self.outline.rows
        lengths: list[_Length] = []

        def add(one: tuple[float, float], other: tuple[float, float]) -> None:
            """Add the length between two points (z, rho)."""
            (a, r), (b, s) = sorted((one, other))
            same = any(abs(a - length.low) < 1e-3 and abs(b - length.high) < 1e-3 for length in lengths)
            if b - a > 1e-3 and not same:
                lengths.append(_Length(a, b, (r, s)))

        if self.is_cylindrical:
            for row in rows:
                add(tuple(row.tip[0]), tuple(row.tip[-1]))
            whole = self.tip[np.argsort(self.tip[:, 0])]
            add(tuple(whole[0]), tuple(whole[-1]))
        else:
            crown = self.tip[np.argmax(self.tip[:, 1])]
            rear = body.ends[0] if self.side > 0.0 else body.ends[1]
            back = next(point for point in body.profile if point[1] == rear)
            add(tuple(crown), (back[1], back[0]))
            ends = self.tip[np.argsort(self.tip[:, 0])]
            add(tuple(ends[0]), tuple(ends[-1]))
        web = body.web
        if web is not None:
            add((web.low, web.outer), (web.high, web.outer))
        if self.member.hub is not None:
            top = body.ends[1]
            add((top - self.member.hub.length, 0.5 * self.member.hub.diameter), (top, 0.5 * self.member.hub.diameter))
        for band, ((rho, z), (other, end)) in zip(body.bands, pairwise(body.profile), strict=True):
            if z != end and band in LENGTH_REGIONS and not (band is Region.RIM and body.bands.count(band) == 1):
                add((z, rho), (end, other))
        lowest, highest = (pick(body.profile, key=lambda point: point[1]) for pick in (min, max))
        add((lowest[1], lowest[0]), (highest[1], highest[0]))
        at = np.concatenate((self.outline.body, self.tip))
        add(tuple(at[np.argmin(at[:, 0])]), tuple(at[np.argmax(at[:, 0])]))
        return lengths

    @cached_property
    def sides(self) -> tuple[list[_Diameter], list[_Diameter]]:
        """Diameters on the left and on the right of the section."""
        middle = 0.5 * sum(self.outline.ends)
        # the diameter of a cone is on the side of its large end
        right = (
            []
            if self.is_cylindrical
            else [tooth_diameter for tooth_diameter in self.own if -self.side * (tooth_diameter.low - middle) > 0.0]
        )
        left = [tooth_diameter for tooth_diameter in self.own if tooth_diameter not in right]
        return left, [*self.body, *right]

    @cached_property
    def bore_sizes(self) -> tuple[tuple[float, float] | None, tuple[float, float] | None]:
        """Ends of the dimensions of a keyway, hexagon or flat along y and along x, mm; None where there is none."""
        form, radius = self.member.bore_form, self.member.body.bore_radius
        return (None, None) if form is None else (form.across(radius), form.along(radius))

    @cached_property
    def bore_is_round(self) -> bool:
        """True if a part of the bore is round, so that its diameter is a dimension."""
        form = self.member.bore_form
        return form is None or any(isinstance(c, PlaneArc) for c in form.in_bore(self.member.body.bore_radius))

    def size(self, scale: float) -> tuple[float, float]:
        low, high = self.outline.ends
        left, right = self.sides
        across = 2.0 * self.outline.reach * scale
        wide = (
            room(len(left))
            + (high - low) * scale
            + room(len(right))
            + VIEW_DISTANCE_MM
            + across
            + room(int(self.bore_sizes[1] is not None))
        )
        return wide + CHAIN_OVERRUN_MM, across + room(len(self.lengths)) + max(
            CHAIN_OVERRUN_MM, room(int(self.bore_sizes[0] is not None))
        )

    def draw(self, canvas: Canvas, scale: float, left: float, low: float) -> None:
        ends, axis = self.outline.ends, low + room(len(self.lengths)) + self.outline.reach * scale
        begin = left + room(len(self.sides[0]))
        first = ends[0] if self.side < 0.0 else ends[1]
        place = _Place(scale, begin, axis, -self.side, first)
        self._section(canvas, place)
        self._dimensions(canvas, place)
        end = begin + (ends[1] - ends[0]) * scale + room(len(self.sides[1])) + VIEW_DISTANCE_MM
        self._end(canvas, scale, np.array([end + self.outline.reach * scale, axis]))

    # ---------------------------------------------------------------- axial section

    def _section(self, canvas: Canvas, place: _Place) -> None:
        """Draw the axial section."""
        body = self.member.body
        for up in (1.0, -1.0):
            cuts = []
            for (a, b), reach, drilled in self._cuts:
                cuts.append(((a, b), reach))
                if drilled:
                    middle = 0.5 * sum(reach)
                    line = place.on(np.array([(a, middle), (b, middle)]), up)
                    canvas.stroke(_longer(line, CHAIN_OVERRUN_MM - 1.0), Pen.CHAIN)
            openings = [place.on(np.array([(z, r) for z, r in zip((a, b, b, a), (s, s, t, t), strict=True)]), up)
                        for (a, b), (s, t) in cuts]  # fmt: skip
            outline = place.on(self._body_section(up), up)
            canvas.hatch([outline, *openings])
            _draw_outline(canvas, outline, place.axis)
            for opening in openings:
                _draw_outline(canvas, opening, place.axis)
            for row in self.outline.rows:
                _draw_outline(canvas, place.on(row.outline, up), place.axis)
                if self.facts.reference is not None:
                    canvas.stroke(_longer(place.on(row.on_ends(self._reference_radii), up), 2.0), Pen.CHAIN)
            web = body.web
            if web is not None:
                for z in (body.profile[0][1], body.profile[-1][1]):
                    canvas.stroke(place.on(np.array([(z, web.inner), (z, web.outer)]), up))
        # edges behind the section
        for x in self._bore_edges():
            at = [(z, abs(x)) for _, z in body.profile[body.bore_band : body.bore_band + 2]]
            canvas.stroke(place.on(np.array(at), float(np.sign(x))))
        for z, rho in self._inner_ends():
            reach = self._bore_on_x if rho == body.bore_radius else (rho, rho)
            ends = [place.on(np.array([(z, x)]), up) for x, up in zip(reach, (1.0, -1.0), strict=True)]
            canvas.stroke(np.concatenate(ends))
        axis = place.on(np.array([(z, 0.0) for z in self.outline.ends]), 1.0)
        canvas.stroke(_longer(axis, CHAIN_OVERRUN_MM), Pen.CHAIN)

    @property
    def _bore_on_x(self) -> tuple[float, float]:
        """Distances (mm) of the bore from the axis on +x and on -x."""
        form, radius = self.member.bore_form, self.member.body.bore_radius
        return (radius, radius) if form is None else form.on_x(radius)

    def _body_section(self, up: float) -> Array:
        """Polygon (N, 2), (z, rho), of the body on the side of +x (`up` 1) or -x (-1), with the bore in its form."""
        member, polygon = self.member, self.outline.body
        if member.bore_form is None:
            return polygon
        body = member.body
        ends = [(z, rho) for rho, z in body.profile[body.bore_band : body.bore_band + 2]]
        on_bore = (polygon[:, None] == np.array(ends)).all(axis=-1).any(axis=1)
        there = self._bore_on_x[0 if up > 0.0 else 1]
        return np.column_stack((polygon[:, 0], np.where(on_bore, there, polygon[:, 1])))

    def _bore_edges(self) -> set[float]:
        """Return x (mm) of the edges of the bore beyond the axial section."""
        form, radius = self.member.bore_form, self.member.body.bore_radius
        if form is None:
            return set()
        near, far = self._bore_on_x
        corners = {round(float(curve.start[0]), 6) for curve in form.in_bore(radius)}
        return {x for x in corners if -far + ZERO_LENGTH_MM < x < near - ZERO_LENGTH_MM and x != 0.0}

    @cached_property
    def _cuts(self) -> list[tuple[tuple[float, float], tuple[float, float], bool]]:
        """Holes, and openings between spokes, as if they lay in the section: z, radii, and whether they are drilled."""
        cuts = {(cut.low, cut.high, *cut.reach): cut.region is not Region.SPOKE for cut in self.member.openings}
        return [((a, b), (s, t), drilled) for (a, b, s, t), drilled in cuts.items()]

    def _inner_ends(self) -> list[tuple[float, float]]:
        """(z, rho) of both ends of the bore, or of the teeth of an internal gear."""
        if self.member.body.around:
            return [(float(z), float(rho)) for z, rho in (self.tip[0], self.tip[-1])]
        body, seen = self.member.body, dict[float, float]()
        for band, ends in zip(body.bands, pairwise(body.profile), strict=True):
            for rho, z in ends if band in (Region.BORE, Region.COUNTERBORE) else ():
                seen[z] = max(rho, seen.get(z, 0.0))
        return [(z, rho) for z, rho in seen.items() if rho > 0.0]

    def _dimensions(self, canvas: Canvas, place: _Place) -> None:
        """Draw the diameters and lengths."""
        ends = np.sort(place.along(np.array(self.outline.ends)))
        for diameters, side in zip(self.sides, (-1, 1), strict=True):
            spans = []
            for size in diameters:
                near = place.along(np.array([size.low, size.high]))
                start = float(near.min() if side < 0 else near.max())
                half = 0.5 * size.value * place.scale
                spans.append(Span(place.axis - half, place.axis + half, size.text, (start, start)))
            stack(canvas, spans, float(ends[0] if side < 0 else ends[1]), side, upright=True)
        spans = []
        for length in self.lengths:
            a, b = place.along(np.array([length.low, length.high])).tolist()
            levels = [place.axis - radius * place.scale for radius in length.near]
            ends_and_levels = sorted(zip((a, b), levels, strict=True))
            text = number(length.high - length.low)
            spans.append(
                Span(ends_and_levels[0][0], ends_and_levels[1][0], text, (ends_and_levels[0][1], ends_and_levels[1][1]))
            )
        stack(canvas, spans, place.axis - self.outline.reach * place.scale, -1, upright=False)

    # ---------------------------------------------------------------- end view

    def _end(self, canvas: Canvas, scale: float, centre: Array) -> None:
        """Draw the view along the axis."""
        member, body = self.member, self.member.body

        def on(points: Array) -> Array:
            """Return points (N, 2), over x and y, on paper."""
            return np.asarray(centre + scale * np.stack((-self.side * points[:, 1], points[:, 0]), axis=-1))

        self._teeth(canvas, scale, centre, on)
        circles = {round(rho, 6) for rho, z in body.profile if self._is_seen(z)} - {round(body.bore_radius, 6), 0.0}
        for rho in sorted(circles):
            canvas.circle(centre[0], centre[1], scale * rho)
        if self.facts.reference is not None:
            canvas.circle(centre[0], centre[1], 0.5 * scale * max(self.facts.reference), Pen.CHAIN)
        reach = scale * self.outline.reach + CHAIN_OVERRUN_MM
        for way in (np.array([reach, 0.0]), np.array([0.0, reach])):
            canvas.line(centre - way, centre + way, pen=Pen.CHAIN)
        self._bore(canvas, scale, centre, on)
        for region in {opening.region: None for opening in member.openings}:
            self._openings(canvas, region, on)
        for drilled in (member.holes, member.features.bolts):
            if drilled is not None:
                self._name_holes(canvas, scale, centre, on, drilled)
        if member.features.spokes is not None:
            self._name_spokes(canvas, scale, centre, on, member.features.spokes)

    def _is_seen(self, z: float) -> bool:
        """True if a face at z is visible in the end view."""
        low, high = self.member.body.ends
        return self.side * (z - 0.5 * (low + high)) > 0.0

    def _teeth(self, canvas: Canvas, scale: float, centre: Array, on: _Mapping) -> None:
        """Draw all teeth, or some teeth and circles for the rest [ISO 2203]."""
        tooth = self.member.tooth
        pitch, radius = tooth.pitch_angle, float(self.tip[:, 1].max())
        all_drawn = scale * radius * pitch >= MIN_TOOTH_PITCH_MM
        count = tooth.teeth if all_drawn else TEETH_DRAWN
        first = -(count // 2)
        end = end_of_teeth(self.member, self.side > 0.0)
        more = () if self.is_cylindrical else (*end_of_teeth(self.member, self.side < 0.0), *tip_edges(self.member))
        lines = [*end, *more]
        for k in range(first, first + count):
            for line in lines:
                canvas.stroke(on(_turn(line, k * pitch)))
        if all_drawn:
            return
        # teeth that are not drawn [ISO 2203]: tip circles, and the root circle as a thin line
        roots = self.outline.rows[0].root[:, 1]
        tips = {(round(float(rho), 6), Pen.OUTLINE) for rho in (radius, self.tip[:, 1].min())}
        rest = {(round(float(roots.max()), 6), Pen.THIN)} if self.is_cylindrical else set()
        for rho, pen in sorted(tips | rest, key=lambda circle: circle[0]):
            a, b = (first + count - 0.5) * pitch, 2.0 * np.pi + (first - 0.5) * pitch
            angle = np.linspace(a, b, 181)
            canvas.stroke(on(rho * np.stack((np.cos(angle), np.sin(angle)), axis=-1)), pen)

    def _bore(self, canvas: Canvas, scale: float, centre: Array, on: _Mapping) -> None:
        """Draw the bore, with the dimensions of its keyway, hexagon or flat."""
        radius, form = self.member.body.bore_radius, self.member.bore_form
        if radius <= 0.0:
            return
        if form is None:
            canvas.circle(centre[0], centre[1], scale * radius)
            return
        lines = [
            curve.at(np.linspace(0.0, 1.0, BORE_POINTS if isinstance(curve, PlaneArc) else 2))
            for curve in form.in_bore(radius)
        ]
        outline = on(np.concatenate(lines))
        canvas.stroke(np.concatenate((outline, outline[:1])))
        reach, (across, along) = scale * self.outline.reach, self.bore_sizes
        for sizes, upright in ((across, False), (along, True)):
            if sizes is None:
                continue
            at = int(upright)
            low, high = (float(centre[at] + scale * size) for size in sizes)
            near = [float(outline[np.abs(outline[:, at] - end) < ZERO_LENGTH_MM, 1 - at].max()) for end in (low, high)]
            text = number(sizes[1] - sizes[0]) + form.mark
            stack(canvas, [Span(low, high, text, (near[0], near[1]))], centre[1 - at] + reach, 1, upright=upright)

    def _openings(self, canvas: Canvas, region: Region, on: _Mapping) -> None:
        """Draw the outlines of openings, except blind ones on the far side."""
        for opening in self.member.openings:
            blind = opening.floor is not None and not self._is_seen(sum((opening.low, opening.high, -opening.floor)))
            if opening.region is region and not blind:
                points = np.concatenate([curve.at(np.linspace(0.0, 1.0, CURVE_POINTS)) for curve in opening.curves])
                canvas.stroke(on(np.concatenate((points, points[:1]))))

    def _name_holes(self, canvas: Canvas, scale: float, centre: Array, on: _Mapping, holes: Drilling) -> None:
        """Draw the circle through holes, and a text with their number, size and depth."""
        canvas.circle(centre[0], centre[1], 0.5 * scale * holes.circle, Pen.CHAIN)
        places = on(holes.centres)
        # the leader starts at the hole at the lower right (bolt holes: lower left)
        side = -1.0 if holes.region is Region.BOLT else 1.0
        x, y = places[np.argmax(side * places[:, 0] - places[:, 1])]
        way = np.array([side, -1.0]) / np.sqrt(2.0)
        tip = np.array([x, y]) + 0.5 * scale * holes.diameter * way
        text = f"{holes.count} \N{MULTIPLICATION SIGN} {diameter(holes.diameter)} on {diameter(holes.circle)}"
        if holes.depth is not None:
            text += f", {number(holes.depth)} deep"
        self._note_below(canvas, scale, centre, tip, side, text)

    def _name_spokes(self, canvas: Canvas, scale: float, centre: Array, on: _Mapping, spokes: Spokes) -> None:
        """Draw a text with number and width of spokes, and size of their openings, at the opening at the lower right
        (beside holes: lower left).
        """
        angle = spokes.start + 2.0 * np.pi * (np.arange(spokes.count) + 0.5) / spokes.count
        places = on(0.5 * spokes.outer * np.stack((np.cos(angle), np.sin(angle)), axis=-1))
        # holes are named on the right, bolt holes on the left
        side = -1.0 if self.member.holes is not None else 1.0
        tip = places[np.argmax(side * places[:, 0] - places[:, 1])]
        text = (
            f"{spokes.count} spokes, {number(spokes.width)} wide, {diameter(spokes.inner)} to {diameter(spokes.outer)}"
        )
        if spokes.corner > 0.0:
            text += f", R {number(spokes.corner)}"
        self._note_below(canvas, scale, centre, tip, side, text, 2.0 * LETTER_HEIGHT_MM)

    def _note_below(
        self, canvas: Canvas, scale: float, centre: Array, tip: Array, side: float, text: str, more: float = 0.0
    ) -> None:
        """Draw a text at a leader from a tip to below the view, on the right (`side` 1) or the left; `more` (mm) lowers
        it.
        """
        low = centre[1] - scale * self.outline.reach - CHAIN_OVERRUN_MM - 3.0 - more
        corner = (
            (float(tip[0] + side * 2.0), low) if tip[1] > low else (float(tip[0] + side * 4.0), float(tip[1] - 4.0))
        )
        note(
            canvas,
            (float(tip[0]), float(tip[1])),
            (corner[0] - 40.0 if corner[0] > centre[0] else corner[0], corner[1]),
            text,
        )


class _Mapping(Protocol):
    def __call__(self, points: Array) -> Array: ...


@dataclass(frozen=True)
class _Place:
    """Position of the axial section on paper; lengths in mm."""

    #: scale of the view
    scale: float
    #: horizontal position of z = `first`
    begin: float
    #: vertical position of the axis
    axis: float
    #: +1 if z grows to the right, -1 if to the left
    way: float
    #: z at the left end of the section
    first: float

    def along(self, z: Array) -> Array:
        """Return horizontal positions (N,) of z."""
        return np.asarray(self.begin + self.way * self.scale * (z - self.first))

    def on(self, points: Array, up: float) -> Array:
        """Return points (N, 2) of (z, rho) on paper, above the axis or (`up` -1) below it."""
        return np.stack((self.along(points[:, 0]), self.axis + up * self.scale * points[:, 1]), axis=-1)


def _turn(points: Array, angle: float) -> Array:
    """Turn points (N, 2) by an angle, rad."""
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(points @ np.array([(c, s), (-s, c)]))


def _longer(line: Array, more: float) -> Array:
    """Lengthen a line between two points (2, 2) at both ends."""
    way = (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
    return np.array([line[0] - more * way, line[1] + more * way])


def _draw_outline(canvas: Canvas, outline: Array, axis: float) -> None:
    """Draw a closed outline without its parts on the axis."""
    runs: list[list[Array]] = [[]]
    for point, after in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        if abs(point[1] - axis) < ZERO_LENGTH_MM and abs(after[1] - axis) < ZERO_LENGTH_MM:
            runs.append([])
            continue
        runs[-1] += [point, after] if not runs[-1] else [after]
    for run in runs:
        if run:
            canvas.stroke(np.array(run))


@dataclass(frozen=True)
class RackViews:
    """Front view and section of a rack."""

    member: Member
    outline: Outline
    facts: Facts

    @cached_property
    def contour(self) -> Array:
        """Points (N, 2) of the end of teeth and bar, (x, y); with broken edges, of the section under them."""
        from gearmesh.cad.section import member_section

        half, end = self.member.rows.outer[1]
        z = self.member.halves[half].points(np.array([0.0, 0.0, self.member.tooth.blank.extent[end]]))[2]
        cut = member_section(self.member, float(z), 1e-3)
        return np.concatenate([curve.at(np.linspace(0.0, 1.0, 9)) for curve in cut.contours[0].curves])

    @property
    def heights(self) -> tuple[float, float]:
        """Heights of back and tip over the reference plane."""
        return float(self.contour[:, 0].min()), float(self.contour[:, 0].max())

    @property
    def ends(self) -> tuple[float, float]:
        """First and last y."""
        return float(self.contour[:, 1].min()), float(self.contour[:, 1].max())

    @property
    def width(self) -> float:
        low, high = self.outline.ends
        return high - low

    @property
    def widths(self) -> list[tuple[float, float]]:
        """First and last z over the first z of the section: of the halves and their gap, and of the whole bar."""
        rows = [(float(row.tip[:, 0].min()), float(row.tip[:, 0].max())) for row in self.outline.rows]
        parts = [*rows, *(gap.body.ends for gap in self.member.gaps)] if len(rows) > 1 else []
        low = self.outline.ends[0]
        return [*((min(part) - low, max(part) - low) for part in parts), (0.0, self.width)]

    def size(self, scale: float) -> tuple[float, float]:
        back, tip = self.heights
        first, last = self.ends
        above = CHAIN_OVERRUN_MM if self.member.features.row is None else CHAIN_OVERRUN_MM + TEXT_ABOVE_TEETH_MM
        wide = room(2) + (last - first + self.width) * scale + VIEW_DISTANCE_MM + 2.0 * CHAIN_OVERRUN_MM
        return wide, (tip - back) * scale + room(len(self.widths)) + above

    def draw(self, canvas: Canvas, scale: float, left: float, low: float) -> None:
        back, tip = self.heights
        first, last = self.ends
        x, y = left + room(2), low + room(len(self.widths))

        def spans(values: Iterable[tuple[float, float, float]], origin: float, start: float) -> list[Span]:
            return [
                Span(origin + scale * a, origin + scale * b, number(value), (start, start)) for a, b, value in values
            ]

        canvas.stroke(
            np.stack((x + scale * (self.contour[:, 1] - first), y + scale * (self.contour[:, 0] - back)), axis=-1)
        )
        for face in bar_faces(self.member):
            canvas.line(*zip(x + scale * (face[:, 1] - first), y + scale * (face[:, 0] - back), strict=True))
        level = y - scale * back
        length = last - first
        canvas.line((x - CHAIN_OVERRUN_MM, level), (x + scale * length + CHAIN_OVERRUN_MM, level), pen=Pen.CHAIN)
        stack(canvas, spans([(0.0, tip - back, tip - back), (0.0, -back, -back)], y, x), x, -1, upright=True)
        stack(canvas, spans([(0.0, length, length)], x, y), y, -1, upright=False)
        row = self.member.features.row
        if row is not None:
            self._holes(canvas, row, np.array([x - scale * first, level]), scale)
        # section
        x += scale * length + VIEW_DISTANCE_MM + CHAIN_OVERRUN_MM
        start = np.array([self.outline.ends[0], back])
        body = np.array([x, y]) + scale * (self.outline.body - start)
        holes = []
        if row is not None:
            deep = self.width if row.depth is None else row.depth
            low_end, high_end = (level + scale * reach for reach in row.reach)
            across = np.array([x + scale * (self.width - deep), x + scale * self.width])
            holes = [np.column_stack((across[[0, 1, 1, 0]], [low_end, low_end, high_end, high_end]))]
            middle = level + scale * row.height
            canvas.line((x - 2.0, middle), (x + scale * self.width + 2.0, middle), pen=Pen.CHAIN)
        canvas.hatch([body, *holes])
        for hole in holes:
            _draw_outline(canvas, hole, -1.0)
        _draw_outline(canvas, body, -1.0)
        for toothed in self.outline.rows:
            tip_line, root_line = (np.array([x, y]) + scale * (line - start) for line in toothed.broken)
            canvas.line(*map(tuple, np.concatenate((root_line[:1], tip_line, root_line[-1:])).tolist()))
        canvas.line((x - 2.0, level), (x + scale * self.width + 2.0, level), pen=Pen.CHAIN)
        stack(canvas, spans([(a, b, b - a) for a, b in self.widths], x, y), y, -1, upright=False)

    def _holes(self, canvas: Canvas, row: HoleRow, origin: Array, scale: float) -> None:
        """Draw the holes of a row in the front view, with their sizes; `origin` (2,) is the point y = 0 of the
        reference plane on paper.
        """
        places = origin + scale * row.centres[:, ::-1]
        for x, y in places:
            canvas.circle(float(x), float(y), 0.5 * scale * row.diameter)
            reach = 0.5 * scale * row.diameter + 1.5
            canvas.line((x, y - reach), (x, y + reach), pen=Pen.CHAIN)
        ends = places[[0, -1]] + np.array([[-1.0, 0.0], [1.0, 0.0]]) * (0.5 * scale * row.diameter + 1.5)
        canvas.line(*map(tuple, ends.tolist()), pen=Pen.CHAIN)
        over = row.height - self.heights[0]
        text = f"{row.count} \N{MULTIPLICATION SIGN} {diameter(row.diameter)}, {number(over)} over the back"
        if row.count > 1:
            text += f", every {number(row.pitch)}"
        if row.depth is not None:
            text += f", {number(row.depth)} deep"
        tip = places[0] + 0.5 * scale * row.diameter * np.array([1.0, 1.0]) / np.sqrt(2.0)
        top = float(origin[1]) + scale * self.heights[1] + TEXT_ABOVE_TEETH_MM
        note(canvas, (float(tip[0]), float(tip[1])), (float(tip[0]) + 0.5 * (top - float(tip[1])), top), text)
