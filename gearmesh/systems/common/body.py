"""Bodies of members: bore, keyway and hub, each checked against the room that there is."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearmesh.errors import DesignError
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.common.parallel_keys import LARGEST, SMALLEST, keyway_in_hub
from gearmesh.teeth.train import Boss, Slot

if TYPE_CHECKING:
    from gearmesh.design.core import GearBody, Keyway

#: a bore that is not given is this part of what it may not reach
DEFAULT_BORE = 0.4


def bore_radius(name: str, diameter: float | None, limit: float, what: str, smallest: float | None = None) -> float:
    """Radius (mm) of the bore of a member, of which the design gives the `diameter` (mm) or nothing.

    It must be below `limit` (mm), half of `what`; the default goes by `smallest`, or the limit. Raises DesignError.
    """
    radius = DEFAULT_BORE * (limit if smallest is None else smallest) if diameter is None else 0.5 * diameter
    if not radius < limit:
        raise DesignError(
            f"{name}.bore = {2.0 * radius:g} mm: the root lies below the bore; "
            f"allowed is less than {what}, {at_most(2.0 * limit)} mm"
        )
    return radius


def body_features(
    name: str, spec: GearBody, bore_radius: float, smallest: float, heel: float
) -> tuple[Slot | None, Boss | None]:
    """Keyway and hub of the part `spec` of a design (in mm).

    `smallest` is the smallest radius of the body under the teeth, `heel` its radius on the heel face, mm.
    Raises DesignError naming key, value and limit.
    """
    keyway = _slot(name, spec.keyway, 2.0 * bore_radius) if spec.keyway else None
    hub = Boss(spec.hub.diameter, spec.hub.length) if spec.hub else None
    if keyway:
        if keyway.width >= 2.0 * bore_radius:
            raise DesignError(
                f"{name}.keyway.width = {keyway.width:g} mm: allowed is less than the bore, {at_most(2.0 * bore_radius)} mm"
            )
        limit = smallest - bore_radius
        if keyway.depth >= limit:
            raise DesignError(
                f"{name}.keyway.depth = {keyway.depth:g} mm: allowed is less than {at_most(limit)} mm (to the root)"
            )
    if hub:
        low = 2.0 * (bore_radius + (keyway.depth if keyway else 0.0))
        if not low < hub.diameter < 2.0 * heel:
            raise DesignError(
                f"{name}.hub.diameter = {hub.diameter:g} mm: allowed is between {at_least(low)} (bore) and "
                f"{at_most(2.0 * heel)} mm (root)"
            )
    return keyway, hub


def _slot(name: str, spec: Keyway, bore: float) -> Slot:
    """The keyway in a bore of some diameter (mm)."""
    if bore == 0.0:
        raise DesignError(f"{name}.bore = 0 mm: a keyway needs a bore; allowed is more than 0 mm")
    if spec.width is not None and spec.depth is not None:
        return Slot(spec.width, spec.depth)
    found = keyway_in_hub(bore)
    if found is None:
        raise DesignError(
            f"{name}.keyway.standard = {spec.standard}: has no keyway for a bore of {bore:.6g} mm; allowed is a {name}.bore "
            f"from {SMALLEST:g} to {LARGEST:g} mm, or {name}.keyway.width and depth"
        )
    return Slot(*found)
