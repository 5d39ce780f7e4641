"""Bodies of members: disc and web, each checked against the room that there is; their features: `features`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gearmesh.errors import DesignError
from gearmesh.kernel.surface.levels import ConeLevel
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.teeth.blank.body import Body, Disc

if TYPE_CHECKING:
    from gearmesh.design.core import GearBody, MemberTable, Web

#: a bore that is not given is this part of what it may not reach
DEFAULT_BORE = 0.4
#: thickness of a rim that is not given, in whole depths of the teeth: thinner ones weaken them (ISO 6336-3, rim thickness factor)
RIM_DEPTHS = 1.2
#: diameter of a web's hub that is not given, in bores, or in diameters of the rim where there is no bore
HUB_BORES, HUB_RIMS = 1.6, 0.4
#: least rim over what is cut into a body, in whole depths (thinner ones are to be avoided: ISO 6336-3, rim thickness factor)
LEAST_RIM = 0.5
#: least wall between openings, or between them and bore, keyway or hub, in whole depths: thinner ones are lost in tolerances
LEAST_WALL = 0.02


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
    _check_thickness(name, web, spec.face_width, "the face width")
    inner, outer = _web_radii(name, spec, web, (bore, root - RIM_DEPTHS * depth, root))
    return Body.hub_and_rim(bore, Disc(inner, outer, -0.5 * web.thickness, 0.5 * web.thickness), -half, half)


def recessed_body(name: str, spec: GearBody, web: Web | None, disk: Body, root: ConeLevel, depth: float) -> Body:
    """A disk under teeth on a cone with a recess in its heel where there is to be a web, which goes on to the toe's face.

    `root`: cone of the roots, `depth`: of the teeth, mm. Raises DesignError naming key, value and limit.
    """
    if web is None:
        return disk
    toe, heel = disk.profile[disk.bore_band][1], disk.profile[disk.bore_band + 1][1]
    _check_thickness(name, web, heel - toe, "the body")
    level, steep = toe + web.thickness, math.hypot(1.0, root.slope)
    # the recess is nearest to the roots at its bottom
    rims = (
        min(float(root.at(level)) - depths * depth * steep, disk.profile[-1][0]) for depths in (RIM_DEPTHS, LEAST_RIM)
    )
    wanted, largest = rims
    what = f"what leaves {LEAST_RIM:g} whole depths under the roots"
    inner, outer = _web_radii(name, spec, web, (disk.bore_radius, wanted, largest), what)
    return disk.with_recess(Disc(inner, outer, toe, level))


def _check_thickness(name: str, web: Web, room: float, what: str) -> None:
    """Refuse a web as thick as what it is in (mm)."""
    if web.thickness >= room:
        raise DesignError(
            f"{name}.web.thickness", web.thickness, unit="mm", allowed=f"less than {what}, {at_most(room)} mm"
        )


def _web_radii(
    name: str, spec: GearBody, web: Web, limits: tuple[float, float, float], most: str = "the smallest root diameter"
) -> tuple[float, float]:
    """Radii (mm) of a web's hub and rim; `limits`: radii of the bore, of a rim that is not given, what it may not reach, `most`."""
    bore, default, root = limits
    rim = 2.0 * default if web.rim_diameter is None else web.rim_diameter
    hub = spec.hub.diameter if spec.hub else HUB_BORES * 2.0 * bore if bore > 0.0 else HUB_RIMS * rim
    hub = hub if web.hub_diameter is None else web.hub_diameter
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
            allowed=f"less than {most}, {at_most(2.0 * root)} mm",
        )
    return 0.5 * hub, 0.5 * rim
