"""Choice of the contact for local synthesis where a design leaves it open: mean point, direction of the path, parabola.

Local synthesis gives the requested contact at one point, to second order. Smooth transfer of load between teeth depends
on a pitch and more. Surface contact must last that long, with the mean point, the vertex of the parabola, in its
middle. The choice uses `ContactPreviews`, the paths of contact of possible requests:

1. Directions are tried, from across the profile to more and more lengthwise, until a path is long enough.

2. The mean point moves to the middle of the path, and the path to the middle of the flank.

3. The parabola is scaled until the gear has the requested lag at the change of tooth pairs, third order included.

4. The ellipse is shortened until no other point of the flanks touches before the path does.

5. The pinion of a face-hobbed gear that is not generated can be cut by the gear's own head, crowned. Its contact, which
   follows the directions of the head, is tried first: its flanks part from the path to all sides.

6. Modified roll gives its parabola instead, so that the head may be crowned for other directions of the path.

7. If none of these gives a good pair, modified roll removes the third and higher orders from the parabola.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.progress import tell
from gearmesh.records import dataclass
from gearmesh.systems.spiral_bevel.design import SYNTHESISED_KEYS
from gearmesh.systems.spiral_bevel.machine.pair import BLADE_SIDES
from gearmesh.systems.spiral_bevel.synthesis.contact_preview import ContactPreview, ContactPreviews
from gearmesh.systems.spiral_bevel.synthesis.flank_form import form_choice
from gearmesh.systems.spiral_bevel.synthesis.settings import ContactChoice, contact_asked

if TYPE_CHECKING:
    from gearmesh.systems.common.bevel.blank import BevelBlank
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign

#: directions of the path (deg) in the order of trial: across the profile is the least sensitive to misalignment
PATH_ANGLES_DEG = (90.0, 75.0, 105.0, 60.0, 120.0, 45.0, 135.0, 30.0, 150.0)
#: least length of surface contact, in pitches
MIN_SURFACE_PITCHES = 1.25
#: least length of surface contact on the shorter side of the mean point, in pitches
MIN_SIDE_PITCHES = 0.6
#: lengths of the ellipse that are tried, over its default length
ELLIPSE_SHARES = (1.0, 0.75, 0.55, 0.4, 0.3)
#: share of the lag at the change of teeth by which other points may touch before the path
MAX_AHEAD_SHARE = 0.03
#: largest relative error of the lag at the change of teeth
MAX_LAG_ERROR = 0.05
#: rounds of centring, scaling and bending a path
MAX_REFINE_ROUNDS = 5
#: distance (pitches) of the mean point from the middle of the path up to which it is not moved
CENTRE_TOLERANCE_PITCHES = 0.02
#: relative error of the lag up to which the parabola is not scaled
LAG_TOLERANCE = 2e-3
#: largest distances of the mean point from the middle of the flank, over face width and working depth
MAX_SHIFT_SHARES = (0.25, 0.35)
#: numbers of contact previews after which no other direction is tried: without modified roll, and in all with it
MAX_PREVIEW_COUNTS = (45, 70)
#: numbers of contact previews of the gear's own head with modified roll: of the second order, and with higher ones
MAX_ROLLED_COUNTS = (20, 16)
#: directions of the path that the gear's own head is crowned for, from across the profile to lengthwise
DIRECTION_SHARES = (0.1, 0.25, 0.4, 0.6, 0.8)
#: height from which these contacts are sought, over that of the pitch line, both from the middle of the depth
START_SHARE = 0.3
#: keys of a contact that follow where the gear's own head cuts the pinion
CROWNED_KEYS = ("path_angle", "semi_major_axis")
#: largest coefficient of modified roll
MAX_ROLL_COEFFICIENT = 1.0


def contact_said(design: FaceMilledDesign, blank: BevelBlank, name: str) -> ContactChoice:
    """Return the contact of the pinion's side `name` that a design in mm requests, with plain defaults for open keys."""
    if design.one_crown_gear:
        return ContactChoice(contact_asked(design, blank, name))
    target = design.ease_off(name)
    if target is not None:
        return form_choice(design, blank, name, target)
    spec = design.pinion.side(name)
    said = ContactChoice(contact_asked(design, blank, name), spec.mean_offset, spec.mean_shift)
    previews = ContactPreviews(design, blank, name)
    left_open = not any(design.sets(f"pinion.{name}.{key}") for key in CROWNED_KEYS)
    if not (previews.by_gear_head and left_open):
        return said
    rolled = replace(said, by_roll=not design.pinion.side(name).gives_roll)
    if rolled.by_roll and previews.in_gear_place(previews.of(rolled)):
        return rolled
    crowned = previews.crowned(said)
    return crowned if previews.in_gear_place(previews.of(crowned)) else said


def contact_choice(design: FaceMilledDesign, blank: BevelBlank, name: str) -> ContactChoice:
    """Contact of the pinion's side `name` ("concave", "convex") of a design in mm, with its open keys chosen.

    If no contact preview is good, the best one is chosen. A given ease-off leaves nothing open. `bevel_teeth` decides
    whether teeth with this contact close.
    """
    first = contact_said(design, blank, name)
    if not chooses(design, name):
        return first
    key, named = f"pinion.{name}", ("path_angle", "mean_offset", "mean_shift", "semi_major_axis", "ratio_derivative")
    free = {stem for stem in named if not design.sets(f"{key}.{stem}")}
    previews = ContactPreviews(design, blank, name)
    if not design.pinion.side(name).gives_roll:
        if not design.hobbed:
            free.add("roll")
        elif previews.by_gear_head and free.issuperset(CROWNED_KEYS):
            free.add("by_roll")
    return _Search(previews, frozenset(free)).best(first)


def chooses(design: FaceMilledDesign, name: str) -> bool:
    """Return True if parts of the contact of a side are chosen.

    Nothing is chosen if the side's settings are given, or if the design requests an ease-off or the mean point of [AB].
    """
    if design.one_crown_gear or design.ease_off(name) is not None:
        return False
    given = all(getattr(design.pinion.side(name), setting) is not None for setting in SYNTHESISED_KEYS)
    return not (given or design.completing or design.mean_point != "mean_cone_distance")


@dataclass(frozen=True)
class _Search:
    """Search for the contact of one side of a pinion."""

    #: contact previews of the side
    previews: ContactPreviews
    #: keys that may be chosen, and "roll"
    free: frozenset[str]

    def best(self, first: ContactChoice) -> ContactChoice:
        """Return the first good choice, or else the best one."""
        if "by_roll" not in self.free:
            return self._best_by_head(first)[0]
        rolled = replace(first, by_roll=True)
        best, best_score = first, (-np.inf, -np.inf)
        for tried in (
            partial(self._best_by_roll, rolled, rolled=False),
            partial(self._best_directed, rolled),
            partial(self._best_by_roll, rolled, rolled=True),
            partial(self._best_by_head, first),
        ):
            choice, score = tried()
            if sum(score) > sum(best_score):
                best, best_score = choice, score
            if sum(best_score) >= 1.0:
                break
        return best

    def _best_by_roll(self, first: ContactChoice, *, rolled: bool) -> tuple[ContactChoice, tuple[float, float]]:
        """Return the best choice by the gear's own head with modified roll, and its measures.

        `rolled`: with the orders of the roll above the second.
        """
        best, best_score, begun = first, (-np.inf, -np.inf), self.previews.count
        for direction in self._directions(first):
            if self.previews.count - begun >= MAX_ROLLED_COUNTS[rolled]:
                break
            for choice, path in self._ellipses(direction, rolled=rolled):
                score = self._good(path)
                if self.previews.in_gear_place(path) and sum(score) > sum(best_score):
                    best, best_score = choice, score
            if sum(best_score) >= 1.0:
                break
        return best, best_score

    def _best_directed(self, first: ContactChoice) -> tuple[ContactChoice, tuple[float, float]]:
        """Return the best choice by the gear's own head, crowned for a direction, with modified roll, and its measures."""
        best, best_score, blank = first, (-np.inf, -np.inf), self.previews.blank
        # heads far from the pitch line may have no machine in the gear's place
        nearer = START_SHARE * (blank.gear.mean_dedendum - 0.5 * blank.mean_depth)
        first = self._move(first, np.array([0.0, nearer]))
        for share in DIRECTION_SHARES:
            aligned = partial(self.previews.crowned, share=share)
            for part in ELLIPSE_SHARES:
                axis = part * first.asked.semi_major_axis
                start = replace(first, asked=replace(first.asked, semi_major_axis=axis))
                refined = self._refine(aligned(start), aligned=aligned)
                if refined is None:
                    continue
                score = self._good(refined[1])
                if sum(score) > sum(best_score):
                    best, best_score = refined[0], score
                # a shorter ellipse mends what touches before the path, and nothing else
                if score[0] < 1.0 or score[1] >= 0.0:
                    break
            if sum(best_score) >= 1.0:
                break
        return best, best_score

    def _best_by_head(self, first: ContactChoice) -> tuple[ContactChoice, tuple[float, float]]:
        """Return the best choice whose parabola the head gives, and its measures."""
        best, best_score = self._best_crowned(first)
        begun = self.previews.count if "by_roll" in self.free else 0
        for rolled in (False, True) if "roll" in self.free else (False,):
            # modified roll makes no path longer: it is not tried if a path is only too short
            if sum(best_score) >= 1.0 or (rolled and best_score[1] >= 0.0):
                break
            for direction in self._directions(first):
                if self.previews.count - begun >= MAX_PREVIEW_COUNTS[rolled]:
                    break
                for choice, path in self._ellipses(direction, rolled=rolled):
                    # the number of previews is not known in advance, but its limit is
                    tell(min(self.previews.count / max(MAX_PREVIEW_COUNTS), 1.0))
                    score = self._good(path)
                    if sum(score) > sum(best_score):
                        best, best_score = choice, score
                if sum(best_score) >= 1.0:
                    break
        return best, best_score

    def _best_crowned(self, first: ContactChoice) -> tuple[ContactChoice, tuple[float, float]]:
        """Return the best choice by the gear's own head, crowned, with its measures; `first` if there is none."""
        best, best_score = first, (-np.inf, -np.inf)
        if not (self.previews.by_gear_head and self.free.issuperset(CROWNED_KEYS)):
            return best, best_score
        for lengthwise in (True, False):
            aligned, last = partial(self.previews.crowned, lengthwise=lengthwise), None
            for share in ELLIPSE_SHARES:
                axis = share * first.asked.semi_major_axis
                choice = aligned(replace(first, asked=replace(first.asked, semi_major_axis=axis)))
                if choice == last:
                    continue
                last, refined = choice, self._refine(choice, aligned=aligned)
                if refined is None or not self.previews.in_gear_place(refined[1]):
                    continue
                score = self._good(refined[1])
                if sum(score) > sum(best_score):
                    best, best_score = refined[0], score
                if sum(best_score) >= 1.0:
                    return best, best_score
        return best, best_score

    def _good(self, path: ContactPreview) -> tuple[float, float]:
        """Return two measures of a path: its length (1 if long enough), and its faults (0 if there are none, else < 0).

        Faults are contact of other points before the path, and a wrong lag, each beyond its limit.
        """
        missed = abs(path.at_change / self.previews.wanted_lag - 1.0) if self._scales else 0.0
        ahead = float(np.clip(self.previews.apart(path) + MAX_AHEAD_SHARE, -1.0, 0.0))
        return (
            min(path.shorter / MIN_SIDE_PITCHES, 1.0),
            ahead - (1.0 if np.isnan(missed) else float(np.clip(missed - MAX_LAG_ERROR, 0.0, 1.0))),
        )

    @property
    def _scales(self) -> bool:
        """True if the parabola may be scaled to the requested lag."""
        return "ratio_derivative" in self.free and self.previews.wanted_lag > 0.0

    def _directions(self, first: ContactChoice) -> Iterator[ContactChoice]:
        """Yield the choices whose paths are long enough, then the others from the longest path to the shortest."""
        if "path_angle" not in self.free:
            yield first
            return
        short = []
        for angle in PATH_ANGLES_DEG:
            choice = replace(first, asked=replace(first.asked, path_angle=float(np.radians(angle))))
            path = self.previews.of(choice)
            if path is None:
                continue
            if path.end - path.begin >= MIN_SURFACE_PITCHES:
                yield choice
            else:
                short.append((path.begin - path.end, choice))
        yield from (choice for _, choice in sorted(short, key=lambda shortage: shortage[0]))

    def _ellipses(self, choice: ContactChoice, *, rolled: bool) -> Iterator[tuple[ContactChoice, ContactPreview]]:
        """Yield the choice of a direction with shorter and shorter ellipses, and their paths."""
        full_length, least = choice.asked.semi_major_axis, -np.inf
        for share in ELLIPSE_SHARES if "semi_major_axis" in self.free else (1.0,):
            choice = replace(choice, asked=replace(choice.asked, semi_major_axis=share * full_length))
            refined = self._refine(choice, rolled=rolled)
            if refined is None:
                continue
            choice, path = refined
            apart = self.previews.apart(path)
            # a fault that grows with a shorter ellipse has another cause
            if apart < least:
                return
            yield refined
            if apart >= -MAX_AHEAD_SHARE:
                return
            least = apart

    def _refine(
        self,
        choice: ContactChoice,
        *,
        rolled: bool = False,
        aligned: Callable[[ContactChoice], ContactChoice] | None = None,
    ) -> tuple[ContactChoice, ContactPreview] | None:
        """Return the choice with centred path and requested parabola, and its path; None if it has no path.

        `aligned`: returns a choice with the direction of the path that it keeps.
        """
        path = self.previews.of(choice)
        for _ in range(MAX_REFINE_ROUNDS):
            if path is None or (choice.by_roll and not self.previews.in_gear_place(path)):
                return None
            # corrections by the last path; the loop ends when they change nothing
            better = self._scale(self._centre(choice, path), path)
            if rolled:
                better = self._roll(better, path)
            if aligned is not None and better != choice:
                better = aligned(better)
            preview = None if better == choice else self.previews.of(better)
            if preview is None:
                break
            choice, path = better, preview
        return None if path is None else (choice, path)

    def _centre(self, choice: ContactChoice, path: ContactPreview) -> ContactChoice:
        """Return the choice with its mean point in the middle of the path, and the path in the middle of the flank."""
        if abs(path.begin + path.end) < 2.0 * CENTRE_TOLERANCE_PITCHES:
            return choice
        # move along the path to its middle, and across the path to the middle of the flank
        middle = path.at(0.5 * (path.begin + path.end))
        path_direction = path.at(path.end) - path.at(path.begin)
        across_path = np.array([-path_direction[1], path_direction[0]]) / max(
            float(np.hypot(*path_direction)), 1e-9 * self.previews.blank.mean_depth
        )
        return self._move(choice, middle - path.at(0.0) - (middle @ across_path) * across_path)

    def _move(self, choice: ContactChoice, step: Array) -> ContactChoice:
        """Return the choice with its mean point moved by `step` (2,), mm, as far as it is free and near the middle."""
        blank = self.previews.blank
        along, height = MAX_SHIFT_SHARES[0] * blank.gear.face_width, MAX_SHIFT_SHARES[1] * blank.mean_working_depth
        if "mean_shift" in self.free:
            choice = replace(choice, along=float(np.clip(choice.along + step[0], -along, along)))
        if "mean_offset" in self.free:
            choice = replace(choice, height=float(np.clip(choice.height + step[1], -height, height)))
        return choice

    def _scale(self, choice: ContactChoice, path: ContactPreview) -> ContactChoice:
        """Return the choice with a parabola scaled towards the requested lag at the change of teeth."""
        if (
            not self._scales
            or not path.at_change > 0.0
            or abs(path.at_change / self.previews.wanted_lag - 1.0) < LAG_TOLERANCE
        ):
            return choice
        share = float(np.clip(self.previews.wanted_lag / path.at_change, 0.5, 2.0))
        return replace(choice, asked=replace(choice.asked, ratio_derivative=share * choice.asked.ratio_derivative))

    def _roll(self, choice: ContactChoice, path: ContactPreview) -> ContactChoice:
        """Return the choice with modified roll that removes the third to fifth order from its lag.

        If the blank lags by c q^n / m at the cradle rotation q, the flank generated at q is set back by that angle. It
        is in contact about q / m from the mean point.
        """
        blank = self.previews.blank
        roll = path.pinion.settings.ratio_of_roll
        per_pitch, ratio = roll * 2.0 * np.pi / blank.pinion.teeth, blank.pinion.teeth / blank.gear.teeth
        changes = BLADE_SIDES[self.previews.name] * path.orders[3:6] * roll / (ratio * per_pitch ** np.array([3, 4, 5]))
        third, fourth, fifth = np.clip(
            np.array(choice.roll) + changes, -MAX_ROLL_COEFFICIENT, MAX_ROLL_COEFFICIENT
        ).tolist()
        return replace(choice, roll=(third, fourth, fifth))
