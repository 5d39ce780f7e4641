"""Undercut and pointing of the members of a train, as a document and as tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearmesh.answers.result import Result, columns, header
from gearmesh.answers.tables import Listing, figures, plain, rounded
from gearmesh.design.core import Design
from gearmesh.errors import DesignError
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.systems.system import build_without_one
from gearmesh.teeth.limits import MemberLimits, SideLimits, member_limits
from gearmesh.teeth.train import Member, Train

#: decimals of the tables, mm
DIGITS = 5


@dataclass(frozen=True, repr=False)
class Limits(Result):
    """Undercut and pointing of all members, by their names; `land` (mm) is the smallest top land that was allowed."""

    design: Design
    train: Train
    land: float
    limits: dict[str, MemberLimits]

    @property
    def headline(self) -> str:
        undercut = [name for name, found in self.limits.items() if any(s.undercut.any() for s in found.sides.values())]
        return f"undercut: {', '.join(undercut) or 'none'}"

    @property
    def warnings(self) -> tuple[str, ...]:
        """Those of the gear set, and a line for every flank that is undercut, every member of which half is shown, and every one
        whose flanks begin at a sharp edge that its tools leave: undercut is then not seen where flank and fillet part."""
        found = []
        for name, limits in self.limits.items():
            for other in self.train.members[name].halves[1:]:
                found.append(
                    f"the limits of the {name} are those of its first half; the other half is its mirror image about z = "
                    f"{other.plane:.6g} mm"
                )
            tooth = self.train.members[name].tooth
            if tooth.right.sharp or tooth.left.sharp:
                begins = max(2.0 * float(side.flank_radius.max()) for side in limits.sides.values())
                found.append(
                    f"the flanks of the {name} begin at a sharp edge of diameter {begins:.6g} mm: undercut by the tip rounding of "
                    "the tool alone is not shown here; `gearmesh describe` lists the reserve against it"
                )
            for key, side in limits.sides.items():
                if not side.undercut.any():
                    continue
                at, h1 = limits.stations[side.undercut], side.h1[side.undercut]
                line = f"the {key} flank of the {name} is undercut from {at.min():.6g} to {at.max():.6g} mm"
                line += f" ({_coordinate(self.train.members[name])})"
                if np.isfinite(h1).any():
                    line += (
                        f": the limit of the tool's depth is {np.nanmin(h1):.4g} mm below the pitch plane, the flank extends to "
                        f"{side.joint_depth[side.undercut].max():.4g} mm"
                    )
                found.append(line)
        return (*self.train.warnings, *found)

    @property
    def listings(self) -> list[Listing]:
        """Of every member its figures, its flanks against undercut, its tip against pointing."""
        tables = []
        for name, found in self.limits.items():
            member = self.train.members[name]
            data, place = _rounded(plain(_member(member, found))), f"{_coordinate(member)} mm"
            single = {key: value for key, value in data.items() if not isinstance(value, list | dict)}
            tables.append(figures(name.capitalize(), single))
            rows = [
                [station, key, *values]
                for key, side in data["sides"].items()
                for station, *values in zip(data["stations_mm"], *_columns(side), strict=True)
            ]
            heads = [key.replace("_", " ") for key in _columns(data["sides"]["right"], names=True)]
            tables.append(Listing(f"Undercut of the {name}", (place, "side", *heads), rows))
            tips = {key: values for key, values in data.items() if isinstance(values, list) and key != "stations_mm"}
            rows = [list(row) for row in zip(data["stations_mm"], *tips.values(), strict=True)]
            tables.append(Listing(f"Pointing of the {name}", (place, *(key.replace("_", " ") for key in tips)), rows))
        return tables

    def to_dict(self) -> dict[str, list[Any]]:
        rows = []
        for name, found in self.limits.items():
            data = plain(_member(self.train.members[name], found))
            for side, values in data["sides"].items():
                for k, station in enumerate(data["stations_mm"]):
                    at = {key: value[k] for key, value in values.items() if isinstance(value, list)}
                    rows.append({"member": name, "side": side, "station_mm": station, **at})
        return columns(rows)

    def document(self) -> dict[str, Any]:
        members = {name: _member(self.train.members[name], found) for name, found in self.limits.items()}
        return {
            **header(self.design),
            "least_top_land_mm": self.land,
            "warnings": list(self.warnings),
            "members": members,
        }


def limits_of(design: Design, train: Train, land: float = 0.0) -> Limits:
    """Limits of all members of a gear set; `land` in the design's modules is the smallest top land."""
    sized = design.in_mm()
    least = land * sized.given_module
    found = {name: member_limits(member, least) for name, member in train.members.items()}
    return Limits(design, train, least, found)


def limits_beyond(design: Design, refused: DesignError, land: float = 0.0) -> Limits:
    """Limits for a design that is beyond them: those of the teeth that it has without the key that makes it infeasible.

    Their first warning is the refusal. Raises it where no single key makes the design infeasible.
    """
    found = build_without_one(design)
    if found is None:
        raise refused
    whole, train, key = found
    beyond = f"{refused}; the limits shown are for the design without {key}"
    return limits_of(whole, replace(train, warnings=(beyond, *train.warnings)), land)


def _rounded(value: Any) -> Any:
    """Nested data for people: what is zero but for rounding reads as zero."""
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_rounded(item) for item in value]
    return rounded(value, DIGITS) if isinstance(value, float) else value


def _columns(side: Mapping[str, Any], names: bool = False) -> Sequence[Any]:
    """What a table shows of a side: everything with one number a station."""
    flat = {key: value for key, value in side.items() if isinstance(value, list)}
    flat |= side["limiting_line"]["parameters"]
    return list(flat) if names else list(flat.values())


def _member(member: Member, found: MemberLimits) -> dict[str, Any]:
    """Limits of a member, keys with their units."""
    radial = station_normal(member.tooth.blank.axial) == (1.0, 0.0)
    inner = [side.undercut_from for side in found.sides.values()]
    # where stations are cylinders, as on a face gear, the two ends of a whole tooth are radii
    # flanks on crossed axes are undercut from different ones, and one of them may be so nowhere near the face
    radii = {"inner_radius_mm": float(np.fmax.reduce(inner)), "outer_radius_mm": found.pointed_from} if radial else {}
    diameters = {"tip_diameter_mm": 2.0 * found.tip_radius, "largest_tip_diameter_mm": 2.0 * found.land_radius}
    if member.tooth.joint.travel is not None:
        # a rack has heights, over its reference plane
        diameters = {"tip_height_mm": found.tip_radius, "largest_tip_height_mm": found.land_radius}
    return {
        "teeth": member.tooth.teeth,
        "fewest_teeth": found.fewest_teeth,
        "undercut": any(bool(side.undercut.any()) for side in found.sides.values()),
        "h1_mm": _least(side.h1 for side in found.sides.values()),
        "h2_mm": _least(side.h2 for side in found.sides.values()),
        "pointed_from_mm": found.pointed_from,
        **radii,
        "stations_mm": found.stations,
        "top_land_mm": found.top_land,
        "room_over_tip_mm": found.rise,
        **({} if radial else diameters),
        "sides": {key: _side(member, side) for key, side in found.sides.items()},
    }


def _side(member: Member, side: SideLimits) -> dict[str, Any]:
    places = {"flank_from_diameter_mm": 2.0 * side.flank_radius, "singular_diameter_mm": 2.0 * side.singular_radius}
    if member.tooth.joint.travel is not None:
        places = {"flank_from_height_mm": side.flank_radius, "singular_height_mm": side.singular_radius}
    return {
        "undercut": side.undercut,
        "undercut_from_mm": side.undercut_from,
        "h1_mm": side.h1,
        "joint_depth_mm": side.joint_depth,
        "h2_mm": side.h2,
        **places,
        "lost_height_mm": side.lost,
        "limiting_line": {
            "parameters": (member.tool_parameters or member.source_parameters)(side.p, side.v),
            "on_tool_mm": side.on_tool,
            "on_tooth_mm": side.on_tooth,
        },
    }


def _least(values: Any) -> float:
    """The smallest finite number of several arrays, NaN if there is none."""
    every = np.concatenate([np.ravel(value) for value in values])
    return float(np.nanmin(every)) if np.isfinite(every).any() else float("nan")


def _coordinate(member: Member) -> str:
    """What the stations of a member are."""
    rho, z = station_normal(member.tooth.blank.axial)
    if rho == 0.0:
        return "z"
    return "radius" if z == 0.0 else "cone distance"
