"""Blades of head cutters by the keys of a design: straight or curved edges, tip roundings and toprems."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.systems.spiral_bevel.design import BLADE_KEYS
from gearmesh.tools.head_cutter import Blade, Toprem

if TYPE_CHECKING:
    from gearmesh.systems.common.bevel.blank import BevelBlank
    from gearmesh.systems.spiral_bevel.design import BladeTable, Machine

#: largest default edge radius under a toprem, over the largest that fits
TOPREM_EDGE_SHARE = 0.8


def or_else(value: float | None, otherwise: float) -> float:
    """Return a key's value, or `otherwise` if it is left out."""
    return otherwise if value is None else value


def or_none(value: float | None, otherwise: float | None) -> float | None:
    """Return a key's value, or `otherwise` if it is left out; both may be None."""
    return otherwise if value is None else value


def radians_or(degrees: float | None, otherwise: float) -> float:
    """Return an angle in rad, or `otherwise` (rad) if it is left out."""
    return otherwise if degrees is None else float(np.radians(degrees))


def blade_keys(spec: Machine, own: BladeTable | None = None) -> dict[str, float | None]:
    """Return the keys of a blade: its values where given, else those of the cutter."""
    keys = {key: getattr(spec, key) for key in BLADE_KEYS}
    return keys if own is None else {key: or_none(getattr(own, key), value) for key, value in keys.items()}


def made_blade(
    name: str, cutting_edge: tuple[int, float, float], keys: dict[str, float | None], height: float, blank: BevelBlank
) -> Blade:
    """Return the blade of the keys of `name`.

    `cutting_edge`: its side, tip radius and angle, which holds at `height` unless the keys give another height.

    Raises DesignError for a blade that bends too much within the depth of the tooth, and for a toprem that does not
    fit.
    """
    radius, high = or_else(keys["blade_radius"], 0.0), or_else(keys["toprem_height"], 0.0)
    limit = 5.0 * blank.mean_depth
    if 0.0 < abs(radius) < limit:
        raise DesignError(
            f"{name}.blade_radius", radius, unit="mm", allowed=f"0 (straight) or more than {limit:.4g} mm either way"
        )
    side, tip_radius, angle = cutting_edge
    edge = or_else(keys["edge_radius"], blank.edge_radius)
    blade = Blade(side, tip_radius, angle, edge, radius, or_else(keys["blade_height"], height))
    return replace(blade, **_toprem(name, blade, keys, blank)) if high else blade


def _toprem(name: str, blade: Blade, keys: dict[str, float | None], blank: BevelBlank) -> dict[str, Any]:
    """Return toprem and edge radius of a blade. Raises DesignError if they do not fit each other."""
    high, arc = or_else(keys["toprem_height"], 0.0), or_else(keys["toprem_radius"], 0.0)
    straight, most = keys["toprem_angle"], 0.5 * blank.mean_depth
    if (straight is None) == (arc == 0.0):
        raise DesignError(
            f"{name}.toprem_height",
            high,
            unit="mm",
            reason="needs either toprem_angle (straight) or toprem_radius (an arc)",
        )
    if not high < most:
        raise DesignError(
            f"{name}.toprem_height", high, unit="mm", allowed=Allowed.less_than(most, "mm", "half the depth")
        )
    angle = blade.angle_at(high)
    if straight is not None and not np.radians(straight) < angle:
        raise DesignError(
            f"{name}.toprem_angle",
            straight,
            unit="deg",
            allowed=Allowed.less_than(np.degrees(angle), "deg", "the blade's"),
        )
    # the rounding touches the toprem, not the cutting edge above it
    most = high / (1.0 - float(np.sin(angle if straight is None else np.radians(straight))))
    edge = blade.edge_radius if keys["edge_radius"] is not None else min(blade.edge_radius, TOPREM_EDGE_SHARE * most)
    if not edge < most:
        raise DesignError(
            f"{name}.edge_radius",
            edge,
            unit="mm",
            reason="reaches beyond the toprem",
            allowed=Allowed.less_than(most, "mm"),
        )
    # an arc with a smaller radius would make the blade concave
    least = (high - edge) / float(np.sin(angle))
    if straight is None and not arc > least:
        raise DesignError(
            f"{name}.toprem_radius",
            arc,
            unit="mm",
            reason="the blade would be hollow",
            allowed=Allowed.more_than(least, "mm"),
        )
    return {"toprem": Toprem(high, 0.0 if straight is None else float(np.radians(straight)), arc), "edge_radius": edge}
