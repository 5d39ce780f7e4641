"""Tools that fill the spaces of internal members of beveloid pairs, one for each side of the teeth."""

from __future__ import annotations

import math
from typing import Protocol

from gearmesh.errors import DesignError
from gearmesh.systems.common.bounds import at_least
from gearmesh.tools.shaper import Shaper

#: radius by which a root is outside the base circle at least, in modules
MIN_ROOT_MARGIN_MODULES = 1e-6


class RingTeeth(Protocol):
    """Teeth of an internal member, as a design gives them."""

    @property
    def teeth(self) -> int: ...
    @property
    def helix_angle(self) -> float: ...
    @property
    def profile_shift(self) -> float: ...
    @property
    def dedendum(self) -> float: ...
    @property
    def root_diameter(self) -> float | None: ...


def form_tools(
    name: str, spec: RingTeeth, module: float, angles: tuple[float, float], reduction: float
) -> tuple[Shaper, Shaper]:
    """Return the tools of the right and the left flanks of an internal member, which fill its spaces, without rounding.

    - angles: normal pressure angles (deg) of right and left flanks.
    - reduction: reduction (mm) of half a tooth's normal thickness.
    """
    right, left = (_form_tool(name, spec, module, math.radians(angle), reduction) for angle in angles)
    return right, left


def _form_tool(name: str, spec: RingTeeth, module: float, alpha: float, reduction: float) -> Shaper:
    """Return a tool that fills the spaces of an internal member, in the transverse section and without rounding.

    Raises DesignError naming key, value and limit: a root inside the base circle, or spaces pointed before the root.
    """
    helix = math.radians(spec.helix_angle)
    transverse = math.atan(math.tan(alpha) / math.cos(helix))
    radius = 0.5 * spec.teeth * module / math.cos(helix)
    # the tool is as thick as the member's spaces: its shift is opposite, and backlash makes it thicker
    shift = -spec.profile_shift + reduction / module / math.tan(alpha)
    root = radius + (spec.dedendum - spec.profile_shift) * module
    if spec.root_diameter is not None:
        root = 0.5 * spec.root_diameter
    base = radius * math.cos(transverse)
    key, value, unit = (
        ("dedendum", spec.dedendum, "") if spec.root_diameter is None else ("root_diameter", spec.root_diameter, "mm")
    )
    if root <= base + MIN_ROOT_MARGIN_MODULES * module:
        least = f"at least {at_least(2.0 * base)} mm" if unit else "more"
        raise DesignError(f"{name}.{key}", value, unit=unit, reason="the root is inside the base circle", allowed=least)
    try:
        return Shaper(
            teeth=spec.teeth,
            module=module / math.cos(helix),
            pressure_angle=transverse,
            addendum=root - radius,
            profile_shift=shift * math.cos(helix),
        )
    except DesignError as failure:
        reason = "the spaces are pointed before the root"
        raise DesignError(f"{name}.{key}", value, unit=unit, reason=reason, allowed="less") from failure
