"""Bodies of members: bore, keyway, hub, web and holes, each checked against the room that there is."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gearmesh.design.core import MemberTable
from gearmesh.errors import DesignError
from gearmesh.systems.common.bodies.parallel_keys import LARGEST, SMALLEST, keyway_in_hub
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.teeth.blank.body import Body, Disc
from gearmesh.teeth.gear_train import Boss, Drilling, Slot

if TYPE_CHECKING:
    from gearmesh.design.core import GearBody, Holes, Keyway

#: a bore that is not given is this part of what it may not reach
DEFAULT_BORE = 0.4
#: thickness of a rim that is not given, in whole depths of the teeth: thinner ones weaken them (ISO 6336-3, rim thickness factor)
RIM_DEPTHS = 1.2
#: diameter of a web's hub that is not given, in bores, or in diameters of the rim where there is no bore
HUB_BORES, HUB_RIMS = 1.6, 0.4
#: diameter of holes that are not given, as parts of the room and of the distance from one to the next
HOLE_ROOM, HOLE_PITCH = 0.5, 0.6


def bore_radius(name: str, diameter: float | None, limit: float, what: str, smallest: float | None = None) -> float:
    """Radius (mm) of the bore of a member, of which the design gives the `diameter` (mm) or nothing.

    It must be below `limit` (mm), half of `what`; the default goes by `smallest`, or the limit. Raises DesignError.
    """
    radius = DEFAULT_BORE * (limit if smallest is None else smallest) if diameter is None else 0.5 * diameter
    if not radius < limit:
        raise DesignError(
            f"{name}.bore",
            2.0 * radius,
            unit="mm",
            reason="the root lies below the bore",
            allowed=f"less than {what}, {at_most(2.0 * limit)} mm",
        )
    return radius


def disc_body(name: str, spec: MemberTable, bore: float, root: float, depth: float) -> Body:
    """The body of a member between plane end faces, middle at z = 0: a disc with its bore, and a web where `spec` has one.

    `bore`, `root`: radius of the bore and smallest radius of the root, `depth`: of the teeth, mm. Raises DesignError naming
    key, value and limit.
    """
    half, web = 0.5 * spec.face_width, spec.web
    if web is None:
        return Body.tube(bore, -half, half)
    rim = 2.0 * (root - RIM_DEPTHS * depth) if web.rim_diameter is None else web.rim_diameter
    hub = spec.hub.diameter if spec.hub else HUB_BORES * 2.0 * bore if bore > 0.0 else HUB_RIMS * rim
    hub = hub if web.hub_diameter is None else web.hub_diameter
    if web.thickness >= spec.face_width:
        raise DesignError(
            f"{name}.web.thickness",
            web.thickness,
            unit="mm",
            allowed=f"less than the face width, {at_most(spec.face_width)} mm",
        )
    if not 2.0 * bore < hub:
        raise DesignError(
            f"{name}.web.hub_diameter", hub, unit="mm", allowed=f"more than the bore, {at_least(2.0 * bore)} mm"
        )
    if not hub < rim:
        if web.rim_diameter is not None:
            raise DesignError(
                f"{name}.web.rim_diameter",
                rim,
                unit="mm",
                allowed=f"more than web.hub_diameter, {at_least(hub)} mm, and less than the root, {at_most(2.0 * root)} "
                "mm",
            )
        if web.hub_diameter is not None:
            raise DesignError(
                f"{name}.web.hub_diameter",
                hub,
                unit="mm",
                allowed=f"less than web.rim_diameter, by default {at_most(rim)} mm",
            )
        raise DesignError(
            f"{name}.web.thickness",
            web.thickness,
            unit="mm",
            reason=f"there is no room for a web between a hub of {hub:.6g} mm and the root, {at_most(2.0 * root)} mm, "
            f"less a rim of {RIM_DEPTHS:g} whole depths",
            allowed="another web.hub_diameter or rim_diameter",
        )
    if not rim < 2.0 * root:
        raise DesignError(
            f"{name}.web.rim_diameter",
            rim,
            unit="mm",
            allowed=f"less than the smallest root diameter, {at_most(2.0 * root)} mm",
        )
    disc = Disc(0.5 * hub, 0.5 * rim, -0.5 * web.thickness, 0.5 * web.thickness)
    return Body.hub_and_rim(bore, disc, -half, half)


def body_features(
    name: str, spec: GearBody, bore_radius: float, smallest: float, heel: float, web: Disc | None = None
) -> tuple[Slot | None, Boss | None, Drilling | None]:
    """Keyway, hub and holes of the part `spec` of a design (in mm).

    `smallest` is the smallest radius of the body under the teeth, `heel` its radius on the heel face, mm; `web`: that of the
    body. Raises DesignError naming key, value and limit.
    """
    within = "root" if web is None else "hub of the web"
    keyway = _slot(name, spec.keyway, 2.0 * bore_radius) if spec.keyway else None
    hub = Boss(spec.hub.diameter, spec.hub.length) if spec.hub else None
    if keyway:
        if keyway.width >= 2.0 * bore_radius:
            raise DesignError(
                f"{name}.keyway.width",
                keyway.width,
                unit="mm",
                allowed=f"less than the bore, {at_most(2.0 * bore_radius)} mm",
            )
        limit = (smallest if web is None else web.inner) - bore_radius
        if keyway.depth >= limit:
            raise DesignError(
                f"{name}.keyway.depth",
                keyway.depth,
                unit="mm",
                allowed=f"less than {at_most(limit)} mm (to the {within})",
            )
    keyed = bore_radius + (keyway.depth if keyway else 0.0)
    if hub:
        low, high = 2.0 * keyed, 2.0 * (heel if web is None else web.inner)
        if not (low < hub.diameter < high or (hub.diameter == high and web is not None)):
            raise DesignError(
                f"{name}.hub.diameter",
                hub.diameter,
                unit="mm",
                allowed=f"between {at_least(low)} (bore) and {at_most(high)} mm ({within})",
            )
    drilling = None
    if isinstance(spec, MemberTable):
        if spec.web is not None and web is None:
            raise DesignError(
                f"{name}.web.thickness", spec.web.thickness, unit="mm", reason="this body has no room for a web"
            )
        if spec.holes is not None:
            around = max(keyed, 0.5 * hub.diameter if hub else 0.0)
            drilling = holes_in(name, spec.holes, *((around, smallest) if web is None else (web.inner, web.outer)))
    return keyway, hub, drilling


def holes_in(name: str, spec: Holes, inner: float, outer: float) -> Drilling:
    """Holes where a body has room between two radii (mm). Raises DesignError naming key, value and limit."""
    room, apart = outer - inner, math.sin(math.pi / spec.count)
    circle = inner + outer if spec.circle is None else spec.circle
    diameter = spec.diameter
    if diameter is None:
        widest = 2.0 * min(0.5 * circle - inner, outer - 0.5 * circle)
        diameter = min(HOLE_ROOM * widest, HOLE_PITCH * circle * apart if spec.count > 1 else math.inf)
    if spec.circle is None and not diameter < room:
        raise DesignError(
            f"{name}.holes.diameter", diameter, unit="mm", allowed=f"less than the room for them, {at_most(room)} mm"
        )
    if not (diameter > 0.0 and 2.0 * inner + diameter < circle < 2.0 * outer - diameter):
        size = max(diameter, 0.0)
        raise DesignError(
            f"{name}.holes.circle",
            circle,
            unit="mm",
            allowed=f"between {at_least(2.0 * inner + size)} and {at_most(2.0 * outer - size)} mm",
        )
    if spec.count > 1 and diameter >= circle * apart:
        most = math.ceil(math.pi / math.asin(diameter / circle)) - 1
        raise DesignError(
            f"{name}.holes.count",
            spec.count,
            reason=f"holes of {diameter:g} mm overlap",
            allowed=f"at most {most}",
        )
    return Drilling(spec.count, diameter, circle)


def _slot(name: str, spec: Keyway, bore: float) -> Slot:
    """The keyway in a bore of some diameter (mm)."""
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
            allowed=f"a {name}.bore from {SMALLEST:g} to {LARGEST:g} mm, or {name}.keyway.width and depth",
        )
    return Slot(*standard)
