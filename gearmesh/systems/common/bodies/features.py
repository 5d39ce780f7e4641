"""Features of bodies, each checked against the available room.

They are keyway, hexagon or flats of the bore, hubs, shafts, steps of the bore, holes, bolt holes and spokes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property, partial
from itertools import combinations, pairwise
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.design.core import MemberTable
from gearmesh.design.keys import Table
from gearmesh.errors import DesignError, VagueError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.polylines import contains, depth_inside
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.records import dataclass
from gearmesh.systems.common.bodies.body import LEAST_RIM, LEAST_WALL, RIM_DEPTHS
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.common.standards.din6885 import MAX_BORE_MM, MIN_BORE_MM, keyway_in_hub
from gearmesh.systems.common.tooth_edges import largest
from gearmesh.teeth.blank.body import Body, Disc, TurnedStep
from gearmesh.teeth.blank.bores import BoreForm, ClosedLine, Flats, Hexagon, Slot
from gearmesh.teeth.blank.features import BodyFeatures, Boss, Drilling, Pattern, Spokes
from gearmesh.teeth.blank.halves import HalfGear
from gearmesh.teeth.region import Region
from gearmesh.teeth.tooth import Tooth

if TYPE_CHECKING:
    from gearmesh.design.core import BoltHoles, BoreSteps, Holes, Hub, Keyway, MemberBody, ShaftSteps, SpokeTable

#: default diameter of holes, as part of the room
HOLE_ROOM = 0.5
#: largest default diameter of holes, as part of their pitch
HOLE_PITCH = 0.6
#: default distance of the openings between spokes from the bounds of the room, as part of the room
SPOKE_MARGIN = 0.1
#: default radius of their corners, as part of their height
SPOKE_CORNER = 0.1
#: points along the root line and other lines on which features are measured
LINE_POINTS = 33
#: points along each curve of an outline
CURVE_POINTS = 32
#: part of a size by which lines are kept off the faces that they end on
FACE_MARGIN = 1e-6


@dataclass(frozen=True)
class UnderTeeth:
    """The part of a member under its teeth, or around the teeth of an internal gear; lengths in mm."""

    #: name of the member
    name: str
    #: its tooth
    tooth: Tooth
    #: its body, with the web
    body: Body
    #: smallest radius of the body under the teeth; the largest for an internal gear
    smallest: float
    #: radius of the body on the heel's face
    heel: float
    #: module in which messages count rims
    module: float
    #: rows of teeth
    halves: tuple[HalfGear, ...] = (HalfGear(),)
    #: radii at toe and heel above which a shaft may be a wall that the teeth run out into
    walls: tuple[float, float] = (math.inf, math.inf)

    @property
    def ends(self) -> tuple[float, float]:
        """Radii of the end faces for hubs and shafts at toe and heel."""
        web, bands = self.body.web, self.body.bands
        if web is None:
            return self.smallest, self.heel
        return web.inner if bands[0] is Region.WEB else self.smallest, web.inner

    @property
    def flat(self) -> bool:
        """True if the teeth end on planes."""
        return station_normal(self.tooth.blank.axial)[0] == 0.0

    @cached_property
    def root(self) -> Array:
        """Line (N, 2) of the roots of all rows, (rho, z), from the end of the body's profile to its beginning."""
        lines = np.concatenate([self._line(Region.ROOT, half) for half in self.halves])
        return lines[np.argsort(-self.body.rise * lines[:, 1])] if self.flat else lines[::-1]

    @cached_property
    def depth(self) -> float:
        """Whole depth of the teeth at mid face, mm."""
        tip, root = (self._line(region, self.halves[0])[LINE_POINTS // 2] for region in (Region.LAND, Region.ROOT))
        return float(np.linalg.norm(tip - root))

    @property
    def least_rim(self) -> float:
        """Least rim over cut-outs of the body, mm."""
        return LEAST_RIM * self.depth

    @property
    def wall(self) -> float:
        """Least wall beside openings, mm."""
        return LEAST_WALL * self.depth

    def _line(self, region: Region, half: HalfGear) -> Array:
        """Return the line (N, 2), (rho, z), of a region in the middle of a tooth."""
        points = self.tooth.grid(
            region, np.array([0.5]), self.tooth.sections(np.linspace(0.0, 1.0, LINE_POINTS))
        ).points[0]
        points = half.points(points)
        return np.stack((np.hypot(points[:, 0], points[:, 1]), points[:, 2]), axis=-1)

    def is_inside(self, body: Body, points: Array) -> bool:
        """True if all points (N, 2), (rho, z), are inside a body under the roots."""
        return bool(contains(np.concatenate((body.profile, self.root)), points).all())

    def leaves(self, rim: float, radius: float, ends: tuple[float, float]) -> bool:
        """True if a feature up to a radius (internal gear: down to it) between two z leaves a rim, mm."""
        points, root = _line((radius, ends[0]), (radius, ends[1])), self.root[np.argsort(self.root[:, 1])]
        over = np.interp(points[:, 1], root[:, 1], root[:, 0]) - points[:, 0]
        return bool((self.body.rise * over > 0.0).all() and _distances(points, self.root).min() >= rim)

    def farthest(self, rim: float, ends: tuple[float, float]) -> float:
        """Return the radius (mm) up to which features between two z leave a rim, mm.

        For an internal gear features may extend down to this radius.
        """
        start, end = (
            (self.body.profile[0][0], self.root[:, 0].min()) if self.body.around else (0.0, self.root[:, 0].max())
        )
        return float(
            start + largest(lambda share: self.leaves(rim, start + share * (end - start), ends)) * (end - start)
        )

    def rim_fault(self, points: Array) -> str:
        """Return the fault of a feature that leaves too thin a rim to the roots; empty if there is none.

        `points`: outline (N, 2), (rho, z), of the feature in the axial plane.
        """
        left = float(_distances(points, self.root).min()) if self.is_inside(self.body.without_web, points) else 0.0
        if left >= self.least_rim:
            return ""
        rim = f"a rim of {left:.3g} mm, {left / self.module:.2g} modules," if left > 0.0 else "no rim"
        return f"leaves {rim} at the roots"

    @property
    def rim_words(self) -> str:
        """Text about the least rim, to be appended to a bound."""
        modules = f"{self.least_rim / self.module:.3g} modules"
        return f"which leaves at least {at_least(self.least_rim)} mm of rim, {modules} or {LEAST_RIM:g} whole depths"

    def check_rim(
        self,
        key: str,
        value: object,
        radii: tuple[float, ...],
        ends: tuple[float, float],
        bound: Callable[[float], str],
    ) -> None:
        """Refuse a feature that leaves less than the least rim to the roots.

        - radii: radii of the feature, mm.
        - ends: z between which it extends, mm.
        - bound: text of the key's bound for the farthest radius of a feature.
        """
        fault = self.rim_fault(np.concatenate([_line((rho, ends[0]), (rho, ends[1])) for rho in radii]))
        if fault:
            allowed = f"{bound(self.farthest(self.least_rim, ends))}, {self.rim_words}"
            raise DesignError(f"{self.name}.{key}", value, unit="mm", reason=fault, allowed=allowed)


def body_features(spec: MemberBody, under: UnderTeeth) -> BodyFeatures:
    """Return the features of the part `spec` of a design (in mm). Raises DesignError naming key, value and limit."""
    name, body, web = under.name, under.body, under.body.web
    keyway, form = _keyway(spec, under), _bore_form(spec, under)
    # hubs and shafts must enclose the corners of the bore
    bore = BodyFeatures(keyway=keyway, bore=form)
    keyed, corner, inner = _around_bore(bore, body.bore_radius)
    ends = under.ends
    hubs = [
        _boss(name, key, hub, (corner, end), web, inner)
        for key, hub, end in (("toe_hub", spec.toe_hub, ends[0]), ("hub", spec.hub, ends[1]))
    ]
    shafts = [
        _shaft(name, key, shaft, (corner, end if hub is None else None), inner, wall)
        for key, shaft, hub, end, wall in (
            ("toe_shaft", spec.toe_shaft, hubs[0], ends[0], under.walls[0]),
            ("heel_shaft", spec.heel_shaft, hubs[1], ends[1], under.walls[1]),
        )
    ]
    if web is None and isinstance(spec, MemberTable) and spec.web is not None:
        raise DesignError(
            f"{name}.web.thickness", spec.web.thickness, unit="mm", reason="this body has no room for a web"
        )
    features = replace(bore, hub=hubs[1], toe_hub=hubs[0], toe_shaft=shafts[0], heel_shaft=shafts[1])
    # steps of the bore need the outside of the body with its hubs and shafts
    bores = _bore_steps(spec, under, features)
    features = replace(features, toe_bore=bores[0], heel_bore=bores[1])
    beside = [0.5 * hub.diameter for hub in hubs if hub] + [steps[0].radius for steps in (*shafts, *bores) if steps]
    # openings are between bore, hubs or shafts and the roots, or in the web
    room = (max(keyed, *beside, 0.0), under.smallest) if web is None else (web.inner, web.outer)
    return _with_openings(spec, under, features, room, corner)


def ring_features(spec: MemberTable, under: UnderTeeth) -> BodyFeatures:
    """Return the features of the rim of an internal gear; see `body_features`."""
    outside = under.body.profile[0][0]
    sides = [
        _steps(under, key, steps, Region.RIM)
        for key, steps in (("toe_bore", spec.toe_bore), ("heel_bore", spec.heel_bore))
    ]
    _check_lengths(spec, under, under.body)
    for key, steps in zip(("toe_bore", "heel_bore"), sides, strict=True):
        for step in steps:
            if step.radius == outside:
                raise DesignError(
                    f"{under.name}.{key}.diameters", 2.0 * outside, unit="mm", reason="is that of the rim: no step"
                )
            if step.radius < outside:
                _check_ring_step(under, key, step)
    features = BodyFeatures(toe_bore=sides[0], heel_bore=sides[1])
    least = min([outside, *(step.radius for steps in sides for step in steps)])
    return _with_openings(spec, under, features, (under.smallest, least), under.smallest)


def _check_ring_step(under: UnderTeeth, key: str, step: TurnedStep) -> None:
    """Refuse a step of a ring's outside that leaves too thin a rim."""
    ends = under.body.ends
    under.check_rim(
        f"{key}.diameters", 2.0 * step.radius, (step.radius,), ends, lambda r: Allowed.at_least(2.0 * r, "mm")
    )


def _keyway(spec: MemberBody, under: UnderTeeth) -> Slot | None:
    """Return the keyway; None if the design has none."""
    name, body, web = under.name, under.body, under.body.web
    if spec.keyway is None:
        return None
    keyway = _slot(name, spec.keyway, 2.0 * body.bore_radius)
    if keyway.width >= 2.0 * body.bore_radius:
        raise DesignError(
            f"{name}.keyway.width",
            keyway.width,
            unit="mm",
            allowed=Allowed.less_than(2.0 * body.bore_radius, "mm", "the bore"),
        )
    # the depth is limited at the corners of the keyway
    room = _bore_room(under)
    limit = math.sqrt(max(room**2 - 0.25 * keyway.width**2, 0.0)) - body.bore_radius
    if keyway.depth >= limit:
        raise DesignError(
            f"{name}.keyway.depth",
            keyway.depth,
            unit="mm",
            allowed=Allowed.less_than(limit, "mm", note=f" (to the {_within(web)})"),
        )
    return keyway


def _bore_form(spec: MemberBody, under: UnderTeeth) -> BoreForm | None:
    """Return the hexagon or the flats of the bore; None if the design has neither."""
    name, bore = under.name, 2.0 * under.body.bore_radius
    for table, noun in (("hex_bore", "a hexagonal bore"), ("d_bore", "a flat")):
        if getattr(spec, table) is not None and bore == 0.0:
            raise DesignError(f"{name}.bore", 0, unit="mm", reason=f"{noun} needs a bore", allowed="more than 0 mm")
    if spec.hex_bore is not None:
        # the room costs sections of the teeth: it is asked for a hexagon alone
        hexagon, room = Hexagon(spec.hex_bore.across_flats), _bore_room(under)
        if hexagon.corner >= room:
            raise DesignError(
                f"{name}.hex_bore.across_flats",
                hexagon.across_flats,
                unit="mm",
                allowed=Allowed.less_than(
                    hexagon.across_flats * room / hexagon.corner,
                    "mm",
                    note=f" (corners to the {_within(under.body.web)})",
                ),
            )
        if not hexagon.across_flats <= bore < 2.0 * hexagon.corner:
            allowed = f"at least {at_least(hexagon.across_flats)} and less than {at_most(2.0 * hexagon.corner)} mm"
            raise DesignError(
                f"{name}.bore", bore, unit="mm", reason="the hole before broaching the hexagon", allowed=allowed
            )
        return hexagon
    if spec.d_bore is None:
        return None
    # the axis is inside the bore
    least = 0.5 * bore if spec.d_bore.flats == 1 else 0.0
    if not least < spec.d_bore.height < bore:
        raise DesignError(
            f"{name}.d_bore.height",
            spec.d_bore.height,
            unit="mm",
            allowed=Allowed.between(least, bore, "mm", note=" (the bore)"),
        )
    return Flats(spec.d_bore.height, spec.d_bore.flats)


def _around_bore(features: BodyFeatures, radius: float) -> tuple[float, float, str]:
    """Return the largest radii (mm) of the bore on its axes and at its corners, and the name of what is there."""
    form = features.bore_form
    if form is None or form.reach(radius) <= radius:
        return radius, radius, "bore"
    return max(form.on_x(radius)), form.reach(radius), form.name


def _bore_room(under: UnderTeeth) -> float:
    """Return the radius (mm) that the corners of a bore must not reach."""
    web = under.body.web
    return (under.smallest if web is None else web.inner) - under.wall


def _within(web: Disc | None) -> str:
    """Return the name of the part that bounds a hub or keyway."""
    return "root" if web is None else "hub of the web"


def _boss(
    name: str, key: str, spec: Hub | None, bounds: tuple[float, float], web: Disc | None, inner: str
) -> Boss | None:
    """Return a hub between two radii (mm): of the bore or keyway, called `inner`, and of its end face."""
    if spec is None:
        return None
    low, high = 2.0 * bounds[0], 2.0 * bounds[1]
    if not (low < spec.diameter < high or (spec.diameter == high and web is not None)):
        raise DesignError(
            f"{name}.{key}.diameter",
            spec.diameter,
            unit="mm",
            allowed=f"between {at_least(low)} ({inner}) and {at_most(high)} mm ({_within(web)})",
        )
    return Boss(spec.diameter, spec.length)


def _shaft(
    name: str, key: str, spec: ShaftSteps | None, bounds: tuple[float, float | None], inner: str, wall: float
) -> tuple[TurnedStep, ...]:
    """Return the steps of a shaft.

    `bounds`: radius (mm) of the bore or keyway, called `inner`, and of the end face; None for a shaft on a hub. `wall`: radius
    above which teeth run out into the shaft.
    """
    if spec is None:
        return ()
    ends = spec.end_diameters or spec.diameters
    low, high = bounds
    for given, diameters in (("diameters", spec.diameters), ("end_diameters", ends)):
        if min(diameters) <= 2.0 * low:
            raise DesignError(
                f"{name}.{key}.{given}",
                min(diameters),
                unit="mm",
                allowed=Allowed.more_than(2.0 * low, "mm", f"the {inner}"),
            )
    if high is not None and 2.0 * high <= spec.diameters[0] <= 2.0 * wall:
        raise DesignError(
            f"{name}.{key}.diameters",
            spec.diameters[0],
            unit="mm",
            reason="the first step is wider than the end face",
            allowed=Allowed.less_than(2.0 * high, "mm")
            + (f", or more than the tip diameter, {at_least(2.0 * wall)} mm" if math.isfinite(wall) else ""),
        )
    return tuple(
        TurnedStep(0.5 * diameter, 0.5 * end, length, Region.SHAFT)
        for diameter, end, length in zip(spec.diameters, ends, spec.lengths, strict=True)
    )


def _steps(under: UnderTeeth, key: str, spec: BoreSteps | None, region: Region) -> tuple[TurnedStep, ...]:
    """Return the steps of a bore, or of the outside of a ring."""
    if spec is None:
        return ()
    for one, other in pairwise(spec.diameters):
        if one == other:
            raise DesignError(f"{under.name}.{key}.diameters", one, unit="mm", reason="two steps are alike")
    return tuple(
        TurnedStep(0.5 * diameter, 0.5 * diameter, length, region)
        for diameter, length in zip(spec.diameters, spec.lengths, strict=True)
    )


def _bore_steps(spec: MemberBody, under: UnderTeeth, features: BodyFeatures) -> list[tuple[TurnedStep, ...]]:
    """Return the steps of the bore at toe and heel, for a body with hubs and shafts."""
    name, turned, bore = under.name, features.turn(under.body), under.body.bore_radius
    _, least, what = _around_bore(features, bore)
    made = []
    _check_lengths(spec, under, turned)
    for key, table, end in (("toe_bore", spec.toe_bore, 0), ("heel_bore", spec.heel_bore, 1)):
        steps = _steps(under, key, table, Region.COUNTERBORE)
        made.append(steps)
        if not steps:
            continue
        diameters = [2.0 * step.radius for step in steps]
        if bore == 0.0:
            raise DesignError(f"{name}.bore", 0, unit="mm", reason=f"{key} needs a bore", allowed="more than 0 mm")
        if diameters != sorted(diameters, reverse=True) or diameters[-1] <= 2.0 * least:
            raise DesignError(
                f"{name}.{key}.diameters",
                diameters,
                reason="a bore has its widest step at its end",
                allowed=f"falling from the end face inwards, all above the {what}, {at_least(2.0 * least)} mm",
            )
        sense = -1.0 if end else 1.0
        z = turned.profile[turned.bore_band + end][1]
        for step in steps:
            reach = (z, z + sense * step.length)
            fault = _bore_step_fault(under, turned, step.radius, reach)
            if fault:
                most = _widest_bore_step(under, turned, (least, step.radius), reach)
                allowed = (
                    "a shorter step" if most is None else Allowed.at_most(2.0 * most, "mm", note=f", {under.rim_words}")
                )
                key, value = f"{name}.{key}.diameters", 2.0 * step.radius
                raise DesignError(key, value, unit="mm", reason=fault, allowed=allowed)
            z += sense * step.length
    return made


def _bore_step_fault(under: UnderTeeth, turned: Body, radius: float, ends: tuple[float, float]) -> str:
    """Return the fault of a step of the bore from one z to another; empty if there is none."""
    line = _line((radius * (1.0 + FACE_MARGIN), ends[0]), (radius * (1.0 + FACE_MARGIN), ends[1]))
    if not under.is_inside(turned, line):
        return "breaks through the outside of the body"
    return under.rim_fault(line) if float(_distances(line, under.root).min()) < under.least_rim else ""


def _widest_bore_step(
    under: UnderTeeth, turned: Body, bounds: tuple[float, float], ends: tuple[float, float]
) -> float | None:
    """Return the largest radius (mm) of a step of the bore without a fault; None if there is none.

    `bounds`: radii between which it is searched; `ends`: z of the step's ends.
    """
    low, high = bounds
    share = largest(lambda share: not _bore_step_fault(under, turned, low + share * (high - low), ends))
    return low + share * (high - low) if share > 0.0 else None


def _check_lengths(spec: MemberBody, under: UnderTeeth, body: Body) -> None:
    """Refuse steps of a bore, or of a ring's outside, that leave nothing of it between them."""
    lengths = {
        key: sum(steps.lengths) for key in ("toe_bore", "heel_bore") if (steps := getattr(spec, key)) is not None
    }
    band = body.bands.index(Region.RIM if body.around else Region.BORE)
    room = abs(body.profile[band + 1][1] - body.profile[band][1])
    if lengths and sum(lengths.values()) >= room:
        key, length = max(lengths.items(), key=lambda item: item[1])
        others = sum(lengths.values()) - length
        raise DesignError(
            f"{under.name}.{key}.lengths",
            length,
            unit="mm",
            reason="together",
            allowed=Allowed.less_than(
                room - others, "mm", note=f", the length of the {'rim' if body.around else 'bore'}"
            ),
        )


def _with_openings(
    spec: MemberBody, under: UnderTeeth, features: BodyFeatures, room: tuple[float, float], least: float
) -> BodyFeatures:
    """Return the features with holes, bolt holes and spokes.

    - room: radii (mm) between which openings are placed by default.
    - least: radius (mm) of bore and keyway, which openings must not reach.
    """
    name, holes = under.name, getattr(spec, "holes", None)
    made: list[tuple[str, float, Pattern]] = []
    if holes is not None:
        features = replace(features, holes=(drilled := holes_in(name, holes, *room, under.wall)))
        made.append((*_stated_size(holes, "holes", ("circle", "diameter", "count")), drilled))
    if spec.bolts is not None:
        features = replace(features, bolts=(bolts := _bolts(name, spec.bolts, room)))
        made.append((*_stated_size(spec.bolts, "bolts", ("circle", "diameter")), bolts))
    if spec.spokes is not None:
        features = replace(features, spokes=(spokes := _spokes(spec.spokes, under, room, least)))
        made.append((*_stated_size(spec.spokes, "spokes", ("outer_diameter", "inner_diameter", "width")), spokes))
    body = features.turn(under.body)
    for key, value, pattern in made:
        # on plane end faces a thinner rim beside holes has always been allowed
        rim = under.wall if pattern is features.holes and under.flat else under.least_rim
        ends = _within_body(_levels(key, value, pattern, body, under, rim), under)
        if ends is not None and rim == under.least_rim:
            under.check_rim(key, value, pattern.reach, ends, partial(_up_to, key, pattern, under))
        _check_beside_bore(under, features, key, value, pattern)
    for (key, _, one), (other_key, value, other) in combinations(made, 2):
        if _overlap(one, other):
            raise DesignError(
                f"{name}.{other_key}",
                value,
                unit="" if other_key.endswith("count") else "mm",
                reason=f"its openings meet those of {key.partition('.')[0]}",
                allowed="another circle, size or start_angle",
            )
    return features


def _check_beside_bore(under: UnderTeeth, features: BodyFeatures, key: str, value: float, pattern: Pattern) -> None:
    """Refuse openings that cut into a keyway or a hexagon of the bore, or leave less than a wall to it."""
    form, radius, wall = features.bore_form, under.body.bore_radius, under.wall
    if form is None or pattern.reach[0] >= form.reach(radius) + wall:
        return
    bore = _points(form.in_bore(radius))
    left = min(float(-depth_inside(bore, _points(outline)).max()) for outline in pattern.outlines)
    if left >= wall * (1.0 - FACE_MARGIN):
        return
    least = 2.0 * (form.reach(radius) + wall)
    if key.endswith("circle"):
        least += pattern.reach[1] - pattern.reach[0]
    elif key.endswith("diameter"):
        least = 0.0
    raise DesignError(
        f"{under.name}.{key}",
        value,
        unit="" if key.endswith("count") else "mm",
        reason=f"leaves {f'a wall of {left:.3g} mm' if left > 0.0 else 'no wall'} to the {form.name}",
        allowed=Allowed.at_least(least, "mm", note=", or another start_angle")
        if least
        else "another circle or start_angle",
    )


def _within_body(ends: tuple[float, float], under: UnderTeeth) -> tuple[float, float] | None:
    """Return the part of an opening between two z that is under the teeth.

    Hubs and shafts beyond the end faces have no roots.
    """
    low, high = max(ends[0], under.body.ends[0]), min(ends[1], under.body.ends[1])
    return (low, high) if low < high else None


def _up_to(key: str, pattern: Pattern, under: UnderTeeth, radius: float) -> str:
    """Return the bound, as text, of a key of openings that must not extend beyond a radius (mm)."""
    (inner, outer), around = pattern.reach, under.body.around
    named = key.rpartition(".")[2]
    if named == "circle":
        return (
            Allowed.at_least(2.0 * radius + outer - inner, "mm")
            if around
            else Allowed.at_most(2.0 * radius - outer + inner, "mm")
        )
    if named == "diameter" and (most := abs(2.0 * radius - outer - inner)) and (2.0 * radius > outer + inner) != around:
        return Allowed.at_most(most, "mm")
    if named == "outer_diameter":
        return Allowed.at_most(2.0 * radius, "mm")
    return f"openings {f'from {at_least(2.0 * radius)}' if around else f'up to {at_most(2.0 * radius)}'} mm"


def _stated_size(spec: Table, table: str, keys: tuple[str, ...]) -> tuple[str, float]:
    """Return the first given key of a table, with the table's name before it, and its value."""
    return next((f"{table}.{key}", getattr(spec, key)) for key in keys if getattr(spec, key) is not None)


def _levels(key: str, value: float, pattern: Pattern, body: Body, under: UnderTeeth, rim: float) -> tuple[float, float]:
    """Return the z between which openings go through the body.

    Raises DesignError if they, including the walls beside them, do not begin and end on plane faces. `rim`: rim that
    they must leave under the roots, mm.
    """
    inner, outer = pattern.reach
    try:
        return body.levels((max(inner - under.wall, 0.0), outer + under.wall), under.flat, pattern.depth)
    except ValueError:
        if pattern.depth is not None and _goes_deeper(pattern, body, under.flat):
            low, high = body.levels(pattern.reach, under.flat)
            key = f"{under.name}.{key.partition('.')[0]}.depth"
            most = Allowed.less_than(high - low, "mm", note=", or none")
            why = "the holes do not end in the body"
            raise DesignError(key, pattern.depth, unit="mm", reason=why, allowed=most) from None
        why = f"openings from {2.0 * inner:.6g} to {2.0 * outer:.6g} mm do not begin and end on one plane face each"
        if pattern.depth is not None:
            why = f"holes from {2.0 * inner:.6g} to {2.0 * outer:.6g} mm, {pattern.depth:g} mm deep, do not end in the body"
        rooms = _rooms(body, under, pattern.depth, rim)
        allowed = " or ".join(f"{at_least(2.0 * a)} to {at_most(2.0 * b)} mm" for a, b in rooms)
        raise DesignError(
            f"{under.name}.{key}", value, unit="mm", reason=why, allowed=f"openings from {allowed}" if rooms else ""
        ) from None


def _goes_deeper(pattern: Pattern, body: Body, flat_ends: bool) -> bool:
    """True if blind holes are too deep where holes through the body would fit."""
    try:
        body.levels(pattern.reach, flat_ends)
    except ValueError:
        return False
    return True


def _rooms(body: Body, under: UnderTeeth, depth: float | None, rim: float) -> list[tuple[float, float]]:
    """Return the ranges of radii (mm) of openings on plane faces, without the walls and the `rim` under the roots."""
    bounds = {face_bound for face in body.plane_faces(under.flat) for face_bound in (face.inner, face.outer)}
    # blind holes in the heel do not reach the toe's face, so that only the radius at the heel limits them
    limit = under.smallest if depth is None or body.around else max(under.smallest, under.heel)
    places = sorted({bound for bound in bounds if 0.0 <= bound < np.inf} | {limit})
    rooms: list[tuple[float, float]] = []
    for one, other in pairwise(places):
        # only the teeth are beyond the roots
        if one >= limit if body.around else other <= limit:
            on_one_face = (rooms[-1][0], other) if rooms and rooms[-1][1] == one else (one, other)
            if _levels_of(body, on_one_face, under, depth) is not None:
                rooms[-1:] = [on_one_face] if on_one_face[0] < one else [*rooms[-1:], on_one_face]
            elif _levels_of(body, (one, other), under, depth) is not None:
                rooms.append((one, other))
    made = []
    for one, other in rooms:
        low, high = one + under.wall if one > 0.0 else 0.0, other - under.wall
        if (ends := _levels_of(body, (one, other), under, depth)) is not None:
            bound = under.farthest(rim, ends)
            low, high = (max(low, bound), high) if body.around else (low, min(high, bound))
        if low < high:
            made.append((low, high))
    return made


def _levels_of(
    body: Body, reach: tuple[float, float], under: UnderTeeth, depth: float | None
) -> tuple[float, float] | None:
    """Return the z between which openings go through the part under the teeth; None if they are not on plane faces."""
    try:
        return _within_body(body.levels(reach, under.flat, depth), under)
    except ValueError:
        return None


def _bolts(name: str, spec: BoltHoles, room: tuple[float, float]) -> Drilling:
    """Return the bolt holes, by default in the middle of the room between two radii (mm)."""
    circle = sum(room) if spec.circle is None else spec.circle
    apart = math.sin(math.pi / spec.count)
    if spec.diameter >= circle:
        if spec.circle is not None:
            allowed = Allowed.more_than(spec.diameter, "mm", "bolts.diameter")
            raise DesignError(f"{name}.bolts.circle", circle, unit="mm", allowed=allowed)
        raise DesignError(f"{name}.bolts.diameter", spec.diameter, unit="mm", allowed=Allowed.less_than(circle, "mm"))
    if spec.count > 1 and spec.diameter >= circle * apart:
        most = math.ceil(math.pi / math.asin(spec.diameter / circle)) - 1
        raise DesignError(
            f"{name}.bolts.count",
            spec.count,
            reason=f"holes of {spec.diameter:g} mm overlap on {circle:.6g} mm",
            allowed=Allowed.at_most(most),
        )
    return Drilling(spec.count, spec.diameter, circle, math.radians(spec.start_angle), spec.depth, Region.BOLT)


def _spokes(spec: SpokeTable, under: UnderTeeth, room: tuple[float, float], least: float) -> Spokes:
    """Return the spokes.

    By default their openings are slightly within the room between two radii (mm). Without a web they leave a rim as
    thick as a web's rim. Given openings may go through hubs, too, down to the `least` radius; plane faces are checked
    later.
    """
    name, web = under.name, under.body.web
    limit = under.farthest(under.least_rim, under.body.ends if web is None else (web.low, web.high))
    # the openings stay inside the smallest radius under the teeth
    limit = min(limit, under.smallest - under.wall)
    if web is None:
        room = room[0], room[1] - RIM_DEPTHS / LEAST_RIM * under.least_rim
    margin = SPOKE_MARGIN * (room[1] - room[0])
    inner = 2.0 * (room[0] + margin) if spec.inner_diameter is None else spec.inner_diameter
    outer = 2.0 * (room[1] - margin) if spec.outer_diameter is None else spec.outer_diameter
    low, high = 2.0 * (least + under.wall), 2.0 * limit
    if not low < high or (room[0] >= room[1] and None in (spec.inner_diameter, spec.outer_diameter)):
        reason = "the body has no room for spokes between bore or hub and rim"
        raise VagueError(f"{name}.spokes", reason=reason)
    top = outer if spec.outer_diameter is not None and low < outer <= high else high
    if spec.inner_diameter is not None and not low <= inner < top:
        allowed = f"at least {at_least(low)} and less than {at_most(top)} mm"
        raise DesignError(f"{name}.spokes.inner_diameter", inner, unit="mm", allowed=allowed)
    if spec.outer_diameter is not None and not inner < outer <= high:
        allowed = f"more than {at_least(inner)} and at most {at_most(high)} mm"
        raise DesignError(f"{name}.spokes.outer_diameter", outer, unit="mm", allowed=allowed)
    if not inner < outer:
        raise VagueError(f"{name}.spokes.inner_diameter", inner, unit="mm", reason=f"no room up to {at_most(outer)} mm")
    corner = SPOKE_CORNER * 0.5 * (outer - inner) if spec.corner_radius is None else spec.corner_radius
    spokes = Spokes(spec.count, spec.width, inner, outer, corner, math.radians(spec.start_angle))
    if not spokes.fits:
        widest = 2.0 * ((0.5 * inner + corner) * math.sin(math.pi / spec.count) - corner)
        deepest = 0.25 * (outer - inner)
        if corner >= deepest:
            raise DesignError(
                f"{name}.spokes.corner_radius", corner, unit="mm", allowed=Allowed.less_than(deepest, "mm")
            )
        angle = float(np.arctan2(spokes.corners[0, 1], spokes.corners[0, 0]))
        reason = "leaves no opening between the spokes"
        if widest > 0.0 or angle <= 0.0:
            most = Allowed.less_than(widest, "mm") if widest > 0.0 else "thinner spokes or a smaller corner_radius"
            raise DesignError(f"{name}.spokes.width", spec.width, unit="mm", reason=reason, allowed=most)
        fewer = max(math.ceil(math.pi / angle) - 1, 1)
        raise DesignError(
            f"{name}.spokes.count",
            spec.count,
            reason=reason,
            allowed=Allowed.at_most(fewer),
            remedy="or a smaller corner_radius",
        )
    return spokes


def _overlap(one: Pattern, other: Pattern) -> bool:
    """True if openings of two patterns meet."""
    drawn = [[_points(outline) for outline in pattern.outlines] for pattern in (one, other)]
    return any(bool(contains(a, b).any() or contains(b, a).any()) for a in drawn[0] for b in drawn[1])


def _points(outline: ClosedLine) -> Array:
    """Return points (N, 2) along a closed line."""
    return np.concatenate([curve.at(np.arange(CURVE_POINTS) / CURVE_POINTS) for curve in outline])


def _line(one: tuple[float, float], other: tuple[float, float]) -> Array:
    """Return points (LINE_POINTS, 2) between two points, except for the very ends, which may lie on faces."""
    s = np.clip(np.linspace(0.0, 1.0, LINE_POINTS), FACE_MARGIN, 1.0 - FACE_MARGIN)[:, None]
    return np.asarray((1.0 - s) * np.array(one) + s * np.array(other))


def _distances(points: Array, line: Array) -> Array:
    """Return the distances (N,) of points (N, 2) from a line of straight pieces through (M, 2)."""
    start, way = line[:-1], np.diff(line, axis=0)
    length = np.maximum((way**2).sum(axis=-1), np.finfo(float).tiny)
    along = np.clip(((points[:, None] - start) * way).sum(axis=-1) / length, 0.0, 1.0)
    return np.asarray(np.linalg.norm(points[:, None] - start - along[..., None] * way, axis=-1).min(axis=1))


def holes_in(name: str, spec: Holes, inner: float, outer: float, wall: float = 0.0) -> Drilling:
    """Return holes in the room between two radii, without the walls (mm).

    Raises DesignError naming key, value and limit.
    """
    room, apart = outer - inner - 2.0 * wall, math.sin(math.pi / spec.count)
    circle = inner + outer if spec.circle is None else spec.circle
    diameter = spec.diameter
    if diameter is None:
        widest = 2.0 * min(0.5 * circle - inner, outer - 0.5 * circle)
        diameter = min(HOLE_ROOM * widest, HOLE_PITCH * circle * apart if spec.count > 1 else math.inf)
    if spec.diameter is not None and not diameter < room:
        # the room on their own circle, if it leaves any
        here = 2.0 * min(0.5 * circle - inner - wall, outer - wall - 0.5 * circle)
        room = min(room, here) if here > 0.0 else room
        raise DesignError(
            f"{name}.holes.diameter", diameter, unit="mm", allowed=Allowed.less_than(room, "mm", "the room for them")
        )
    size = max(diameter, 0.0) + 2.0 * wall
    if not (diameter > 0.0 and 2.0 * inner + size < circle < 2.0 * outer - size):
        raise DesignError(
            f"{name}.holes.circle",
            circle,
            unit="mm",
            allowed=Allowed.between(2.0 * inner + size, 2.0 * outer - size, "mm"),
        )
    if spec.count > 1 and diameter >= circle * apart:
        most = math.ceil(math.pi / math.asin(diameter / circle)) - 1
        raise DesignError(
            f"{name}.holes.count",
            spec.count,
            reason=f"holes of {diameter:g} mm overlap",
            allowed=Allowed.at_most(most),
        )
    return Drilling(spec.count, diameter, circle)


def _slot(name: str, spec: Keyway, bore: float) -> Slot:
    """Return the keyway in a bore of a diameter (mm)."""
    if bore == 0.0:
        raise DesignError(f"{name}.bore", 0, unit="mm", reason="a keyway needs a bore", allowed="more than 0 mm")
    if spec.width is not None and spec.depth is not None:
        return Slot(spec.width, spec.depth)
    standard = keyway_in_hub(bore)
    if standard is None:
        raise DesignError(
            f"{name}.keyway.standard",
            spec.standard,
            reason=f"has no keyway for a bore of {bore:.6g} mm",
            allowed=f"a {name}.bore from {MIN_BORE_MM:g} to {MAX_BORE_MM:g} mm, or {name}.keyway.width and depth",
        )
    return Slot(*standard)
