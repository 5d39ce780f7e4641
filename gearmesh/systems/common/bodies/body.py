"""Bodies of members: disc and web, each checked against the available room. Their features are in `features`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.kernel.surface.levels import ConeLevel
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.teeth.blank.body import Body, Disc

if TYPE_CHECKING:
    from gearmesh.design.core import GearBody, MemberTable, Web

#: default bore, as part of the size that it must not reach
DEFAULT_BORE = 0.4
#: default thickness of a rim, whole depths; thinner rims weaken the teeth (ISO 6336-3, rim thickness factor)
RIM_DEPTHS = 1.2
#: default diameter of a web's hub, in bores
HUB_BORES = 1.6
#: default diameter of a web's hub without a bore, in diameters of the rim
HUB_RIMS = 0.4
#: least rim over cut-outs of a body, whole depths (ISO 6336-3, rim thickness factor)
LEAST_RIM = 0.5
#: least wall beside openings, whole depths: thinner walls are lost in tolerances
LEAST_WALL = 0.02


def bore_radius(
    name: str, diameter: float | None, limit: float, what: str, smallest: float | None = None, key: str = "bore"
) -> float:
    """Return the radius (mm) of a member's bore; `diameter` (mm) is the given value of `key` or None.

    The radius must be below `limit` (mm), half of `what`. The default is a part of `smallest`, or of the limit. Raises
    DesignError.
    """
    radius = DEFAULT_BORE * (limit if smallest is None else smallest) if diameter is None else 0.5 * diameter
    if not radius < limit:
        raise DesignError(
            f"{name}.{key}",
            2.0 * radius,
            unit="mm",
            reason="the root lies below the bore",
            allowed=Allowed.less_than(2.0 * limit, "mm", f"{what}"),
        )
    return radius


def disc_body(
    name: str, spec: MemberTable, bore: float, root: float, depth: float, ends: tuple[float, float] | None = None
) -> Body:
    """Return the body of a member between plane end faces: a disc with a bore and maybe a web, whose middle is at z = 0.

    - bore: radius of the bore, mm.
    - root: smallest radius of the root, mm.
    - depth: whole depth of the teeth, mm.
    - ends: z of both end faces; by default the face width apart, with their middle at z = 0.

    Raises DesignError naming key, value and limit.
    """
    web, (toe, heel) = spec.web, ends or (-0.5 * spec.face_width, 0.5 * spec.face_width)
    if web is None:
        return Body.tube(bore, toe, heel)
    _check_thickness(name, web, spec.face_width, "the face width")
    inner, outer = _web_radii(name, spec, web, (bore, root - RIM_DEPTHS * depth, root))
    return Body.hub_and_rim(bore, Disc(inner, outer, -0.5 * web.thickness, 0.5 * web.thickness), toe, heel)


def recessed_body(name: str, spec: GearBody, web: Web | None, disk: Body, root: ConeLevel, depth: float) -> Body:
    """Return a disk under teeth on a cone; a web is made by a recess in its heel and extends to the toe's face.

    `root`: cone of the roots; `depth`: whole depth of the teeth, mm. Raises DesignError naming key, value and limit.
    """
    if web is None:
        return disk
    toe, heel = disk.profile[disk.bore_band][1], disk.profile[disk.bore_band + 1][1]
    _check_thickness(name, web, heel - toe, "the body")
    level, steep = toe + web.thickness, math.hypot(1.0, root.slope)
    # the bottom of the recess is nearest to the roots
    rims = (
        min(float(root.at(level)) - depths * depth * steep, disk.profile[-1][0]) for depths in (RIM_DEPTHS, LEAST_RIM)
    )
    wanted, largest = rims
    what = f"what leaves {LEAST_RIM:g} whole depths under the roots"
    inner, outer = _web_radii(name, spec, web, (disk.bore_radius, wanted, largest), what)
    return disk.with_recess(Disc(inner, outer, toe, level))


def _check_thickness(name: str, web: Web, room: float, what: str) -> None:
    """Refuse a web as thick as the part that it is in (mm)."""
    if web.thickness >= room:
        raise DesignError(
            f"{name}.web.thickness", web.thickness, unit="mm", allowed=Allowed.less_than(room, "mm", f"{what}")
        )


def _web_radii(
    name: str, spec: GearBody, web: Web, limits: tuple[float, float, float], most: str = "the smallest root diameter"
) -> tuple[float, float]:
    """Return the radii (mm) of a web's hub and rim.

    `limits`: radii of the bore, of the default rim, and of `most`, which the rim must not reach.
    """
    bore, default, root = limits
    rim = 2.0 * default if web.rim_diameter is None else web.rim_diameter
    hub = spec.hub.diameter if spec.hub else HUB_BORES * 2.0 * bore if bore > 0.0 else HUB_RIMS * rim
    hub = hub if web.hub_diameter is None else web.hub_diameter
    if not 2.0 * bore < hub:
        raise DesignError(
            f"{name}.web.hub_diameter", hub, unit="mm", allowed=Allowed.more_than(2.0 * bore, "mm", "the bore")
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
            allowed=Allowed.less_than(2.0 * root, "mm", f"{most}"),
        )
    return 0.5 * hub, 0.5 * rim
