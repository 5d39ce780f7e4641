"""Keyway and hub of a member, checked against the room that its body has for them."""

from __future__ import annotations

from typing import Any

from gearmesh.errors import DesignError
from gearmesh.teeth.pair import Hub, Keyway


def body_features(
    name: str, spec: Any, bore_radius: float, smallest: float, heel: float
) -> tuple[Keyway | None, Hub | None]:
    """Keyway and hub of the part `spec` of a design (in mm).

    `smallest` is the smallest radius of the body under the teeth, `heel` its radius on the heel face, mm.
    Raises DesignError naming key, value and limit.
    """
    keyway = Keyway(spec.keyway.width, spec.keyway.depth) if spec.keyway else None
    hub = Hub(spec.hub.diameter, spec.hub.length) if spec.hub else None
    if keyway:
        if bore_radius == 0.0:
            raise DesignError(f"{name}.keyway: needs a bore; set {name}.bore")
        if keyway.width >= 2.0 * bore_radius:
            raise DesignError(
                f"{name}.keyway.width = {keyway.width:g} mm: allowed is less than the bore, {2 * bore_radius:.6g} mm"
            )
        limit = smallest - bore_radius
        if keyway.depth >= limit:
            raise DesignError(
                f"{name}.keyway.depth = {keyway.depth:g} mm: allowed is less than {limit:.6g} mm (to the root)"
            )
    if hub:
        low = 2.0 * (bore_radius + (keyway.depth if keyway else 0.0))
        if not low < hub.diameter < 2.0 * heel:
            raise DesignError(
                f"{name}.hub.diameter = {hub.diameter:g} mm: allowed is between {low:.6g} (bore) and {2 * heel:.6g} mm (root)"
            )
    return keyway, hub
