"""Keys of measurements: points or deviations of the flanks of the members, their pitch deviations and runout."""

from __future__ import annotations

import inspect
from typing import Any

from gearmesh.design import keys
from gearmesh.design.keys import Table
from gearmesh.records import dataclass

#: longest list of deviations of teeth
MAX_LISTED_TEETH = 1000
#: largest deviation in a list
MAX_DEVIATION_UM = 1000.0
#: largest seed of random pitch deviations
MAX_SEED = 999_999


def measured_file(member: str, flank: str) -> Any:
    """Return the key of the file of a flank."""
    return keys.file(f"points or deviations measured on the {member}'s {flank} flank", None, default="as designed")


def pitch_file(member: str) -> Any:
    """Return the key of the file of a member's pitch deviations."""
    return keys.file(
        f"pitch deviations and runout of all teeth of the {member}: columns tooth, right_um, left_um, runout_um",
        None,
        default="as designed",
    )


def pitch_list(member: str, flank: str) -> Any:
    """Return the key of the index deviations of the flanks of one side."""
    return keys.number(
        f"index deviations of the {flank} flanks of the {member}, um, one for each tooth from the tooth on x, in the sense of "
        "growing angles; arcs of the reference circle; their mean does not count",
        None,
        low=-MAX_DEVIATION_UM,
        high=MAX_DEVIATION_UM,
        most=MAX_LISTED_TEETH,
        default="those of the other side and the runout",
        source="[ISO 1328-1] 3",
    )


def radial_list(member: str) -> Any:
    """Return the key of the distances by which pins are farther from the axis than their circle says."""
    return keys.number(
        f"radial deviations of the pins of the {member}, um, positive outwards, from the pin on x; their mean counts, too",
        None,
        low=-MAX_DEVIATION_UM,
        high=MAX_DEVIATION_UM,
        most=MAX_LISTED_TEETH,
        default="none; of the member with pins alone",
    )


def runout_list(member: str) -> Any:
    """Return the key of the runout of all spaces."""
    return keys.number(
        f"radial position of a ball in each space of the {member}, um, positive outwards, from the space before the tooth on x; "
        "their mean does not count",
        None,
        low=-MAX_DEVIATION_UM,
        high=MAX_DEVIATION_UM,
        most=MAX_LISTED_TEETH,
        default="none",
        source="[ISO 1328-1] 3",
    )


def pitch_class(member: str) -> Any:
    """Return the key of the tolerance class of random pitch deviations."""
    return keys.count(
        f"tolerance class within which pitch deviations of the {member} are drawn, in the place of measured ones",
        None,
        low=1,
        high=12,
        default="accuracy_class or accuracy_grade where pitch_seed is given",
        source="[ISO 1328-1], [ISO 17485]",
    )


def pitch_seed(member: str) -> Any:
    """Return the key of the seed of random pitch deviations."""
    return keys.count(
        f"seed of the drawn pitch deviations of the {member}: the same seed gives the same gear",
        None,
        low=0,
        high=MAX_SEED,
        default="none; 0 where pitch_class is given",
    )


@dataclass(frozen=True)
class MeasuredMember:
    """Keys of a member in the table `measured`."""

    #: name of the member's table in the design
    name: str
    #: True if its flanks may be measured
    flanks: bool = True
    #: True if the positions of its teeth may be measured
    positions: bool = True
    #: True if its positions may be runout or drawn ones, too
    drawn: bool = True
    #: True if its teeth may be farther from the axis, as pins
    radial: bool = False

    def flank(self, side: str) -> str:
        """Return the key of the file of the "right" or "left" flank."""
        return f"{self.name}_{side}"

    @property
    def pitch_file(self) -> str:
        """Key of the file of pitch deviations."""
        return f"{self.name}_pitch"

    def deviations(self, side: str) -> str:
        """Return the key of the list of index deviations of the "right" or "left" flanks."""
        return f"{self.name}_pitch_{side}_um"

    @property
    def runout(self) -> str:
        """Key of the list of runout."""
        return f"{self.name}_runout_um"

    @property
    def lists(self) -> tuple[str, str, str]:
        """Keys of the lists: deviations of right and left flanks, runout."""
        return self.deviations("right"), self.deviations("left"), self.runout

    @property
    def farther_out(self) -> str:
        """Key of the list of distances from the axis."""
        return f"{self.name}_radial_um"

    @property
    def drawn_class(self) -> str:
        """Key of the tolerance class of random deviations."""
        return f"{self.name}_pitch_class"

    @property
    def drawn_seed(self) -> str:
        """Key of the seed of random deviations."""
        return f"{self.name}_pitch_seed"

    def flank_keys(self) -> dict[str, tuple[Any, Any]]:
        """Return types and descriptions of the keys of the member's flanks."""
        if not self.flanks:
            return {}
        return {self.flank(side): (str | None, measured_file(self.name, side)) for side in ("right", "left")}

    def position_keys(self) -> dict[str, tuple[Any, Any]]:
        """Return types and descriptions of the keys of the positions of the member's teeth."""
        if not self.positions:
            return {}
        found: dict[str, tuple[Any, Any]] = {self.pitch_file: (str | None, pitch_file(self.name))}
        for side in ("right", "left"):
            found[self.deviations(side)] = tuple[float, ...] | None, pitch_list(self.name, side)
        if self.radial:
            found[self.farther_out] = tuple[float, ...] | None, radial_list(self.name)
        if self.drawn:
            found[self.runout] = tuple[float, ...] | None, runout_list(self.name)
            found[self.drawn_class] = int | None, pitch_class(self.name)
            found[self.drawn_seed] = int | None, pitch_seed(self.name)
        return found


class MeasuredMembersTable(Table):
    """Keys of measured members, which a subclass names: flanks of all members first, then positions of teeth."""

    def __init_subclass__(cls, members: tuple[MeasuredMember, ...] = (), **options: Any) -> None:
        """Declare the keys of the members, before they are collected as those in a class body are."""
        super().__init_subclass__(**options)
        annotations = inspect.get_annotations(cls)
        for keys_of in (MeasuredMember.flank_keys, MeasuredMember.position_keys):
            for member in members:
                for key, (kind, described) in keys_of(member).items():
                    annotations[key] = kind
                    setattr(cls, key, described)
        cls.__annotations__ = annotations


class MeasuredTable(MeasuredMembersTable):
    """Reading of files of measured flanks."""

    axial_position: str = keys.choice(
        "axial position of measured points: as in the file, or by best fit; rotation about the axis is always free",
        ("measured", "free"),
        "measured",
    )
    stiffness: float | None = keys.number(
        "stiffness of the smoothing spline through the deviations; 0 = none",
        None,
        low=0,
        high=1e3,
        default="0 for whole grids, else by cross-validation",
    )


class PairMeasured(MeasuredTable, members=(MeasuredMember("pinion"), MeasuredMember("gear"))):
    """Measured flanks and teeth of pinion and gear."""


class WormDriveMeasured(MeasuredTable, members=(MeasuredMember("worm"), MeasuredMember("wheel"))):
    """Measured flanks and teeth of worm and wheel."""


class CycloidalMeasured(
    MeasuredMembersTable,
    members=tuple(MeasuredMember(name, flanks=False, drawn=False, radial=True) for name in ("disc", "ring")),
):
    """Measured places of the lobes of a cycloidal drive and of its pins."""


class RackMeasured(MeasuredTable, members=(MeasuredMember("pinion"), MeasuredMember("rack", positions=False))):
    """Measured flanks of pinion and rack, and teeth of the pinion."""


class PlanetaryMeasured(
    MeasuredTable, members=(MeasuredMember("sun"), MeasuredMember("planet"), MeasuredMember("ring"))
):
    """Measured flanks and teeth of the members of a planetary gear set; all planets have the same."""
