"""Figures of a row of a study over whole turns: the long-period transmission error and the pitch deviations."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gearmesh.answers.contact.turns import TurnsSummary
from gearmesh.contact.engagement.pitch_turns import whole_turns
from gearmesh.design.core import Design
from gearmesh.figures import Figures, Summary, figure
from gearmesh.metrology.measured_teeth import pitch_radius
from gearmesh.metrology.pitch import PitchDeviations
from gearmesh.records import dataclass
from gearmesh.systems import system as systems
from gearmesh.teeth.gear_train import GearPair, GearTrain

#: micrometres per millimetre
UM_PER_MM = 1e3


@dataclass(frozen=True)
class RowPitch(Figures):
    """Pitch deviations of the flanks in contact, by members."""

    single_pitch: Mapping[str, float] = figure(
        "largest single pitch deviation of the flanks in contact", "um", "f_p", key="{member}_single_pitch_um"
    )
    cumulative_pitch: Mapping[str, float] = figure(
        "total cumulative pitch deviation of the flanks in contact", "um", "F_p", key="{member}_cumulative_pitch_um"
    )


def turns_figures(design: Design, train: GearTrain, pair: GearPair) -> Summary:
    """Return the figures of a pair over the turns after which it repeats. Raises the errors of `whole_turns`."""
    inspection = systems.system_of(design).inspection
    single, total = {}, {}
    for member, side in zip(pair.both, pair.flanks, strict=True):
        basis = None if inspection is None else inspection(design, train, member.name)
        angles = member.index.of(side, member.tooth.teeth)
        pitch = PitchDeviations(np.asarray(angles * pitch_radius(member.tooth, basis)))
        single[member.name], total[member.name] = UM_PER_MM * pitch.single_pitch, UM_PER_MM * pitch.cumulative
    return Summary(TurnsSummary.of(pair, whole_turns(pair)), RowPitch(single, total))
