"""Tools that fill the spaces of internal members of beveloid pairs, one for each side of the teeth."""

from __future__ import annotations

import math
from typing import Protocol

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.tools.shaper import Shaper, ShaperFlank

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

    Both are one tool, seen from either flank. Raises DesignError naming key, value and limit: a root inside a base circle,
    or spaces pointed before the root.
    """
    helix = math.radians(spec.helix_angle)
    radius = 0.5 * spec.teeth * module / math.cos(helix)
    root = radius + (spec.dedendum - spec.profile_shift) * module
    if spec.root_diameter is not None:
        root = 0.5 * spec.root_diameter
    transverse = [math.atan(math.tan(math.radians(angle)) / math.cos(helix)) for angle in angles]
    base = max(radius * math.cos(angle) for angle in transverse)
    key, value, unit = (
        ("dedendum", spec.dedendum, "") if spec.root_diameter is None else ("root_diameter", spec.root_diameter, "mm")
    )
    if root <= base + MIN_ROOT_MARGIN_MODULES * module:
        least = Allowed.at_least(2.0 * base, "mm") if unit else "more"
        raise DesignError(f"{name}.{key}", value, unit=unit, reason="the root is inside the base circle", allowed=least)
    # the tool is as thick as the member's spaces: its shift is opposite, and backlash makes it thicker
    shifts = [-spec.profile_shift + reduction / module / math.tan(math.radians(angle)) for angle in angles]
    # one shift is that of the right side; the other half of the tooth has its thickness in place of another shift
    thicker = 2.0 * module * (shifts[1] - shifts[0]) * math.tan(transverse[1])
    try:
        tool = Shaper(
            teeth=spec.teeth,
            module=module / math.cos(helix),
            pressure_angle=transverse[0],
            addendum=root - radius,
            profile_shift=shifts[0] * math.cos(helix),
            opposite=None if transverse[0] == transverse[1] else ShaperFlank(transverse[1], thicker),
        )
    except DesignError as failure:
        reason = "the spaces are pointed before the root"
        raise DesignError(f"{name}.{key}", value, unit=unit, reason=reason, allowed="less") from failure
    return tool, tool.other_flank
