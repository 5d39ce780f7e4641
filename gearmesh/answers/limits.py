"""Limits of the members of a gear set, undercut and pointing, as a document and as tables."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh.answers.result import Result, columns, header
from gearmesh.answers.tables import Listing, figures, plain, round_to
from gearmesh.design.core import Design
from gearmesh.errors import DesignError
from gearmesh.figures import Content, Entry, Figures, Summary, figure
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.records import dataclass
from gearmesh.systems.system import build_without_one
from gearmesh.teeth.gear_train import GearTrain, Member
from gearmesh.teeth.limits import MemberLimits, SideLimits, member_limits

#: decimals of lengths (mm) in tables
TABLE_DECIMALS = 5
#: headings of keys that still contain an older word
COLUMN_HEADINGS = {"joint_depth_mm": "form point depth mm"}


@dataclass(frozen=True)
class LimitingLineFigures(Figures):
    """The limiting line of a tool: its points that generate singular points, one per station."""

    parameters: Mapping[str, Array] = figure("parameters of the tool's surface, named as in the source")
    on_tool: Array = figure("limiting line on the tool, frame of the tool", "mm")
    on_tooth: Array = figure("singular points of the tooth, own frame of the member", "mm")


@dataclass(frozen=True)
class SideLimitFigures(Figures):
    """Undercut of one side of the teeth, one number per station."""

    undercut: NDArray[np.bool_] = figure("whether undercut removes part of the flank")
    undercut_from: float = figure("station at which undercut begins or ends", "mm")
    h1: Array = figure("depth of the limiting line below the pitch plane", "mm", "h_1")
    form_point_depth: Array = figure(
        "depth of the end of the tool's flank below the pitch plane", "mm", key="joint_depth_mm"
    )
    h2: Array = figure("height of the tool's point that generates a tip with the least top land", "mm", "h_2")
    flank_from_diameter: Array | None = figure("root form diameter, at which the flank begins", "mm", optional=True)
    singular_diameter: Array | None = figure("diameter of the singular points", "mm", optional=True)
    flank_from_height: Array | None = figure(
        "height over the reference plane of a rack from which the flank is", "mm", optional=True
    )
    singular_height: Array | None = figure(
        "height of the singular points over the reference plane of a rack", "mm", optional=True
    )
    lost_height: Array = figure("height of the tool's flank that generates nothing that remains", "mm")
    lost_share: float = figure(
        "share of the area of the tool's flank, over the face, that generates nothing that remains"
    )
    undercut_face_share: float = figure("share of the face width that is undercut")
    greatest_lost_share: float = figure(
        "greatest share of the tool's flank across a station that generates nothing that remains"
    )
    greatest_lost_at: float = figure("station at which that is", "mm")
    limiting_line: LimitingLineFigures = figure("the tool's points that generate singular points")

    @property
    def columns(self) -> dict[str, NDArray[Any]]:
        """Values per station, by keys."""
        return _by_station(self)

    @property
    def table(self) -> dict[str, NDArray[Any]]:
        """Values per station and the parameters of the limiting line, by keys."""
        return {**self.columns, **self.limiting_line.parameters}

    @property
    def losses(self) -> dict[str, float]:
        """Parts of the flank that undercut removes over the whole face, by keys."""
        keys = ("lost_share", "undercut_face_share", "greatest_lost_share", "greatest_lost_at_mm")
        values = {entry.key: entry.value for entry in self.entries}
        return {key: values[key] for key in keys}


@dataclass(frozen=True)
class MemberLimitFigures(Figures):
    """Undercut and pointing of a member; of stations one number each."""

    teeth: int = figure("number of teeth", symbol="z", whole=True)
    fewest_teeth: int | None = figure("fewest teeth that the same rack cuts without undercut", whole=True)
    undercut: bool = figure("whether a flank is undercut anywhere")
    h1: float = figure("least depth of the limiting line below the pitch plane", "mm", "h_1")
    h2: float = figure("least height of the tool's point that generates a tip with the least top land", "mm", "h_2")
    pointed_from: float = figure("station from which the top land is less than the least", "mm")
    inner_radius: float | None = figure(
        "inner radius of whole teeth, up to which they are undercut", "mm", optional=True
    )
    outer_radius: float | None = figure("outer radius of whole teeth, from which they are pointed", "mm", optional=True)
    stations: Array = figure("stations along the face", "mm")
    top_land: Array = figure("width of the top land", "mm", "s_a")
    room_over_tip: Array = figure("height over the tip at which the top land is the least", "mm")
    tip_diameter: Array | None = figure("tip diameter", "mm", "d_a", optional=True)
    largest_tip_diameter: Array | None = figure("tip diameter with the least top land", "mm", optional=True)
    tip_height: Array | None = figure("height of a rack's tip over its reference plane", "mm", optional=True)
    largest_tip_height: Array | None = figure(
        "height of a rack's tip with the least top land over its reference plane", "mm", optional=True
    )
    sides: Mapping[str, SideLimitFigures] = figure("undercut of right and left flanks")

    @property
    def single(self) -> list[Entry]:
        """Figures of the whole member."""
        return [entry for entry in self.entries if not isinstance(entry.value, np.ndarray | Mapping)]

    @property
    def columns(self) -> dict[str, NDArray[Any]]:
        """Values per station, by keys."""
        return {key: values for key, values in _by_station(self).items() if values is not self.stations}


def _by_station(figures: Figures) -> dict[str, NDArray[Any]]:
    return {entry.key: entry.value for entry in figures.entries if isinstance(entry.value, np.ndarray)}


@dataclass(frozen=True, repr=False)
class Limits(Result):
    """Undercut and pointing of all members."""

    #: the design
    design: Design
    #: the built gears
    train: GearTrain
    #: smallest top land that was allowed, mm
    land: float
    #: limits of the members, by their names
    limits: dict[str, MemberLimits]

    @property
    def headline(self) -> str:
        undercut = [
            name
            for name, limits_of_member in self.limits.items()
            if any(s.undercut.any() for s in limits_of_member.sides.values())
        ]
        return f"undercut: {', '.join(undercut) or 'none'}"

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of the gear set and of its limits, one line each.

        There is a line for every flank that is undercut, and for every member of which only one half is shown. There is
        also a line for every member whose flanks begin at a sharp edge that its tools leave: undercut is then not
        visible where flank and fillet meet.
        """
        lines = []
        for name, limits in self.limits.items():
            for other in self.train.members[name].halves[1:]:
                lines.append(
                    f"the limits of the {name} are those of its first half; the other half is its mirror image about z = "
                    f"{other.plane:.6g} mm"
                )
            tooth = self.train.members[name].tooth
            if tooth.right.sharp or tooth.left.sharp:
                begins = max(2.0 * float(side.flank_radius.max()) for side in limits.sides.values())
                lines.append(
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
                        f"{side.form_point_depth[side.undercut].max():.4g} mm"
                    )
                lost = side.lost_flank
                if lost.share > 0.0:
                    line += (
                        f"; {100.0 * lost.share:.3g} % of the tool's flank generates nothing that remains, over "
                        f"{100.0 * lost.face:.3g} % of the face width, most at {lost.at:.6g} mm: {100.0 * lost.most:.3g} % of it"
                    )
                lines.append(line)
        return (*self.train.warnings, *lines)

    @cached_property
    def members(self) -> dict[str, MemberLimitFigures]:
        """Figures of every member, by names."""
        return {name: _figures(self.train.members[name], limits) for name, limits in self.limits.items()}

    @property
    def listings(self) -> list[Listing]:
        """Tables of every member: its figures, undercut of its flanks, pointing of its tips."""
        tables = []
        for name, data in self.members.items():
            place = f"{_coordinate(self.train.members[name])} mm"
            single, tips = data.single, data.columns
            tables.append(figures(name.capitalize(), Summary(replace(e, value=_round(e.value)) for e in single)))
            sides = {key: side.table for key, side in data.sides.items()}
            rows = [
                [station, key, *values]
                for key, columns in sides.items()
                for station, *values in _rows(data.stations, columns.values())
            ]
            tables.append(Listing(f"Undercut of the {name}", (place, "side", *_heads(sides["right"])), rows))
            if any(side.undercut.any() and side.lost_share > 0.0 for side in data.sides.values()):
                rows = [[key, *map(_round, side.losses.values())] for key, side in data.sides.items()]
                heads = ("side", *_heads(data.sides["right"].losses))
                tables.append(Listing(f"Undercut of the {name}: what of the tool's flank is lost", heads, rows))
            rows = [list(row) for row in _rows(data.stations, tips.values())]
            tables.append(Listing(f"Pointing of the {name}", (place, *_heads(tips)), rows))
        return tables

    def to_dict(self) -> dict[str, list[Any]]:
        rows = []
        for name, data in self.members.items():
            for key, side in data.sides.items():
                for k, station in enumerate(data.stations):
                    at = {head: plain(values[k]) for head, values in side.columns.items()}
                    rows.append({"member": name, "side": key, "station_mm": station, **at})
        return columns(rows)

    @property
    def sections(self) -> Mapping[str, Content]:
        return {
            **header(self.design),
            "least_top_land_mm": self.land,
            "warnings": self.warnings,
            "members": self.members,
        }


def limits_of(design: Design, train: GearTrain, land: float = 0.0) -> Limits:
    """Return the limits of all members of a gear set; `land` is the smallest top land in modules of the design."""
    sized = design.in_mm()
    least = land * sized.given_module
    by_member = {name: member_limits(member, least) for name, member in train.members.items()}
    return Limits(design, train, least, by_member)


def limits_beyond(design: Design, refused: DesignError, land: float = 0.0) -> Limits:
    """Return limits for a design that exceeds them: limits of the teeth without the key that makes the design
    infeasible.

    The first warning is the refusal. Raises the refusal if no single key makes the design infeasible.
    """
    without_key = build_without_one(design)
    if without_key is None:
        raise refused
    whole, train, key = without_key
    beyond = f"{refused}; the limits shown are for the design without {key}"
    return limits_of(whole, replace(train, warnings=(beyond, *train.warnings)), land)


def _round(value: Any) -> Any:
    """Return a value for a table, rounded, so that rounding errors are shown as 0."""
    value = plain(value)
    return round_to(value, TABLE_DECIMALS) if isinstance(value, float) else value


def _rows(stations: Array, columns: Iterable[NDArray[Any]]) -> Iterator[list[Any]]:
    """Yield the rows of a table by stations."""
    for values in zip(stations, *columns, strict=True):
        yield [_round(value) for value in values]


def _heads(columns: Iterable[str]) -> list[str]:
    return [COLUMN_HEADINGS.get(key, key.replace("_", " ")) for key in columns]


def _figures(member: Member, limits: MemberLimits) -> MemberLimitFigures:
    """Return the limits of a member as figures."""
    radial = station_normal(member.tooth.blank.axial) == (1.0, 0.0)
    joint = member.tooth.joint
    inner = [side.undercut_from for side in limits.sides.values()]
    return MemberLimitFigures(
        teeth=member.tooth.teeth,
        fewest_teeth=limits.fewest_teeth,
        undercut=any(bool(side.undercut.any()) for side in limits.sides.values()),
        h1=_least(side.h1 for side in limits.sides.values()),
        h2=_least(side.h2 for side in limits.sides.values()),
        pointed_from=limits.pointed_from,
        # if stations are cylinders, as on a face gear, both ends of a whole tooth are radii; flanks on crossed axes are
        # undercut from different radii, and one of them may not be undercut near the face
        inner_radius=float(np.fmax.reduce(inner)) if radial else None,
        outer_radius=limits.pointed_from if radial else None,
        stations=limits.stations,
        top_land=limits.top_land,
        room_over_tip=limits.rise,
        tip_diameter=None if radial else joint.diameter(limits.tip_radius),
        largest_tip_diameter=None if radial else joint.diameter(limits.land_radius),
        tip_height=None if radial else joint.height(limits.tip_radius),
        largest_tip_height=None if radial else joint.height(limits.land_radius),
        sides={key: _side_figures(member, side) for key, side in limits.sides.items()},
    )


def _side_figures(member: Member, side: SideLimits) -> SideLimitFigures:
    joint = member.tooth.joint
    return SideLimitFigures(
        undercut=side.undercut,
        undercut_from=side.undercut_from,
        h1=side.h1,
        form_point_depth=side.form_point_depth,
        h2=side.h2,
        flank_from_diameter=joint.diameter(side.flank_radius),
        singular_diameter=joint.diameter(side.singular_radius),
        flank_from_height=joint.height(side.flank_radius),
        singular_height=joint.height(side.singular_radius),
        lost_height=side.lost,
        lost_share=side.lost_flank.share,
        undercut_face_share=side.lost_flank.face,
        greatest_lost_share=side.lost_flank.most,
        greatest_lost_at=side.lost_flank.at,
        limiting_line=LimitingLineFigures(
            (member.tool_parameters or member.source_parameters)(side.p, side.v), side.on_tool, side.on_tooth
        ),
    )


def _least(values: Any) -> float:
    """Return the smallest finite number of several arrays, NaN if there is none."""
    numbers = np.concatenate([np.ravel(value) for value in values])
    return float(np.nanmin(numbers)) if np.isfinite(numbers).any() else float("nan")


def _coordinate(member: Member) -> str:
    """Return the name of the coordinate that the stations of a member have."""
    rho, z = station_normal(member.tooth.blank.axial)
    if rho == 0.0:
        return "z"
    return "radius" if z == 0.0 else "cone distance"
