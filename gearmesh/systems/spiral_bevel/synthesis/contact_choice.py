"""The contact that is asked of local synthesis where a design leaves it open: mean point, direction of the path, parabola.

Local synthesis gives what is asked at one point, to second order. Whether teeth hand over smoothly is decided over a pitch and
more: surface contact has to last that long, and as long before the mean point, where the parabola has its vertex, as after it.
Of `ContactPreviews`, the paths of contact of what may be asked,

1. directions are tried, from across the profile on ever more lengthwise, until a path is long enough;
2. the mean point goes where the path has its middle, and the path where the flank has its own;
3. the parabola becomes the one that lags as was asked where neighbouring pairs change over, third order included;
4. the ellipse becomes so short that nothing else of the flanks touches before the path does;
5. where that does not give a good pair, modified roll takes the third and higher orders out of the parabola.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.progress import tell
from gearmesh.systems.spiral_bevel.design import ORDERS, SYNTHESISED
from gearmesh.systems.spiral_bevel.machine.pair import BLADE_SIDES
from gearmesh.systems.spiral_bevel.synthesis.contact_preview import ContactPreview, ContactPreviews
from gearmesh.systems.spiral_bevel.synthesis.flank_form import form_choice
from gearmesh.systems.spiral_bevel.synthesis.settings import ContactChoice, contact_asked

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.blank.blank import BevelBlank
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign

#: directions of the path (deg) that are tried, in this order: across the profile is the least sensitive to misalignment
ANGLES = (90.0, 75.0, 105.0, 60.0, 120.0, 45.0, 135.0, 30.0, 150.0)
#: pitches of surface contact that are long enough, and those on the shorter side of the mean point
ENOUGH, ENOUGH_ASIDE = 1.25, 0.6
#: lengths of the ellipse that are tried, as parts of what it is by default
SHORTER = (1.0, 0.75, 0.55, 0.4, 0.3)
#: part of the lag at the change of teeth by which anything else may touch before the path does, and by which that lag may be missed
AHEAD, MISSED = 0.03, 0.05
#: rounds of centring, of scaling the parabola and of bending it, and what of them is small enough to leave (pitches; part)
ROUNDS, CENTRED, CLOSE = 5, 0.02, 2e-3
#: farthest from the middle of the flank that the mean point goes, as parts of face width and working depth
FARTHEST = (0.25, 0.35)
#: contact previews after which no other direction is tried, without modified roll and, all in all, with it
MOST = (45, 70)
#: largest coefficient of modified roll
MOST_ROLL = 1.0


def contact_said(design: FaceMilledDesign, blank: BevelBlank, name: str) -> ContactChoice:
    """The contact of the pinion's side `name` as a design in mm says, and by plain defaults what it leaves out."""
    target = design.ease_off(name)
    if target is not None:
        return form_choice(design, blank, name, target)
    spec = design.pinion.side(name)
    return ContactChoice(contact_asked(design, blank, name), spec.mean_offset, spec.mean_shift)


def contact_choice(design: FaceMilledDesign, blank: BevelBlank, name: str) -> ContactChoice:
    """The contact of the pinion's side `name` ("concave", "convex") of a design in mm: as it says, and what it leaves out chosen.

    Where no contact preview is good the best is taken; a given ease-off determines all. Whether teeth with it
    close is for `bevel_teeth` to say.
    """
    first = contact_said(design, blank, name)
    if not chooses(design, name):
        return first
    key, named = f"pinion.{name}", ("path_angle", "mean_offset", "mean_shift", "semi_major_axis", "ratio_derivative")
    free = {stem for stem in named if not design.sets(f"{key}.{stem}")}
    if not any(design.sets(f"{key}.modified_roll_c{k}") for k in range(2, ORDERS + 1)):
        free.add("roll")
    return _Search(ContactPreviews(design, blank, name), frozenset(free)).best(first)


def chooses(design: FaceMilledDesign, name: str) -> bool:
    """Whether anything is chosen of the contact of a side: not where its settings are given, or an ease-off or [AB]'s mean point is
    asked for."""
    if design.ease_off(name) is not None:
        return False
    given = all(getattr(design.pinion.side(name), setting) is not None for setting in SYNTHESISED)
    return not (given or design.completing or design.mean_point != "mean_cone_distance")


@dataclass(frozen=True)
class _Search:
    """The search for one side of a pinion; `free`: what it may choose."""

    previews: ContactPreviews
    free: frozenset[str]

    def best(self, first: ContactChoice) -> ContactChoice:
        """The first choice that is good, or the one that is least bad."""
        best, most = first, (-np.inf, -np.inf)
        for rolled in (False, True) if "roll" in self.free else (False,):
            # roll makes no path longer
            if sum(most) >= 1.0 or (rolled and most[1] >= 0.0):
                break
            for direction in self._directions(first):
                if self.previews.count >= MOST[rolled]:
                    break
                for choice, path in self._ellipses(direction, rolled=rolled):
                    # of previews the most are known, how many are enough is not
                    tell(min(self.previews.count / max(MOST), 1.0))
                    good = self._good(path)
                    if sum(good) > sum(most):
                        best, most = choice, good
                if sum(most) >= 1.0:
                    break
        return best

    def _good(self, path: ContactPreview) -> tuple[float, float]:
        """How long a path is, 1 where it is long enough, and by how much other places touch before it and its parabola is missed,
        0 where all is as asked for."""
        missed = abs(path.at_change / self.previews.wanted_lag - 1.0) if self._scales else 0.0
        ahead = float(np.clip(self.previews.apart(path) + AHEAD, -1.0, 0.0))
        return (
            min(path.shorter / ENOUGH_ASIDE, 1.0),
            ahead - (1.0 if np.isnan(missed) else float(np.clip(missed - MISSED, 0.0, 1.0))),
        )

    @property
    def _scales(self) -> bool:
        return "ratio_derivative" in self.free and self.previews.wanted_lag > 0.0

    def _directions(self, first: ContactChoice) -> Iterator[ContactChoice]:
        """Choices whose paths are long enough in all, then the others."""
        if "path_angle" not in self.free:
            yield first
            return
        short = []
        for angle in ANGLES:
            choice = replace(first, asked=replace(first.asked, path_angle=float(np.radians(angle))))
            path = self.previews.of(choice)
            if path is None:
                continue
            if path.end - path.begin >= ENOUGH:
                yield choice
            else:
                short.append((path.begin - path.end, choice))
        yield from (choice for _, choice in sorted(short, key=lambda shortage: shortage[0]))

    def _ellipses(self, choice: ContactChoice, *, rolled: bool) -> Iterator[tuple[ContactChoice, ContactPreview]]:
        """A choice of direction with ever shorter ellipses, and their paths."""
        whole, least = choice.asked.semi_major_axis, -np.inf
        for share in SHORTER if "semi_major_axis" in self.free else (1.0,):
            choice = replace(choice, asked=replace(choice.asked, semi_major_axis=share * whole))
            refined = self._refine(choice, rolled=rolled)
            if refined is None:
                continue
            choice, path = refined
            apart = self.previews.apart(path)
            # what a shorter ellipse makes worse is none of the ellipse's
            if apart < least:
                return
            yield refined
            if apart >= -AHEAD:
                return
            least = apart

    def _refine(self, choice: ContactChoice, *, rolled: bool) -> tuple[ContactChoice, ContactPreview] | None:
        """The choice centred and with the parabola asked for, and its path; None where it has none."""
        path = self.previews.of(choice)
        for _ in range(ROUNDS):
            if path is None:
                return None
            better = self._scale(self._centre(choice, path), path)
            if rolled:
                better = self._roll(better, path)
            preview = None if better == choice else self.previews.of(better)
            if preview is None:
                break
            choice, path = better, preview
        return None if path is None else (choice, path)

    def _centre(self, choice: ContactChoice, path: ContactPreview) -> ContactChoice:
        """The choice with its mean point in the middle of the path, and the path in the middle of the flank."""
        if abs(path.begin + path.end) < 2.0 * CENTRED:
            return choice
        middle = path.at(0.5 * (path.begin + path.end))
        way = path.at(path.end) - path.at(path.begin)
        aside = np.array([-way[1], way[0]]) / max(float(np.hypot(*way)), 1e-9 * self.previews.blank.mean_depth)
        return self._move(choice, middle - path.at(0.0) - (middle @ aside) * aside)

    def _move(self, choice: ContactChoice, step: Array) -> ContactChoice:
        """The mean point moved by `step` (2,), mm, as far as it is free and near the middle."""
        blank = self.previews.blank
        along, height = FARTHEST[0] * blank.gear.face_width, FARTHEST[1] * blank.mean_working_depth
        if "mean_shift" in self.free:
            choice = replace(choice, along=float(np.clip(choice.along + step[0], -along, along)))
        if "mean_offset" in self.free:
            choice = replace(choice, height=float(np.clip(choice.height + step[1], -height, height)))
        return choice

    def _scale(self, choice: ContactChoice, path: ContactPreview) -> ContactChoice:
        """The choice with the parabola that lags by what was asked at the change of teeth."""
        if not self._scales or not path.at_change > 0.0 or abs(path.at_change / self.previews.wanted_lag - 1.0) < CLOSE:
            return choice
        share = float(np.clip(self.previews.wanted_lag / path.at_change, 0.5, 2.0))
        return replace(choice, asked=replace(choice.asked, ratio_derivative=share * choice.asked.ratio_derivative))

    def _roll(self, choice: ContactChoice, path: ContactPreview) -> ContactChoice:
        """The choice with modified roll that takes the orders from the third to the fifth out of its lag.

        A blank that lags by c q^n / m when the cradle has turned by q has a flank that is so much behind where q generated it,
        which is in contact about q / m from the mean point.
        """
        blank = self.previews.blank
        roll = path.pinion.settings.ratio_of_roll
        per_pitch, ratio = roll * 2.0 * np.pi / blank.pinion.teeth, blank.pinion.teeth / blank.gear.teeth
        changes = BLADE_SIDES[self.previews.name] * path.orders[3:6] * roll / (ratio * per_pitch ** np.array([3, 4, 5]))
        third, fourth, fifth = np.clip(np.array(choice.roll) + changes, -MOST_ROLL, MOST_ROLL).tolist()
        return replace(choice, roll=(third, fourth, fifth))
