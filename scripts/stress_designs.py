"""Random designs of every kind for the stress test, over sensible ranges and over edge ranges; seeded.

A design is a plain table as in its file, with nothing in it that its kind does not need or the dice did not choose. Lengths are
in multiples of the module first, so that all sizes are alike.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

RANGES = ("sensible", "edge")
Keys = dict[str, Any]


@dataclass(frozen=True)
class Dice:
    """Random choices: every number has a sensible and an edge range."""

    random: np.random.Generator
    edge: bool

    def between(self, sensible: tuple[float, float], edge: tuple[float, float] | None = None) -> float:
        low, high = edge if self.edge and edge is not None else sensible
        return float(f"{self.random.uniform(low, high):.5g}")

    def count(self, sensible: tuple[int, int], edge: tuple[int, int] | None = None) -> int:
        low, high = edge if self.edge and edge is not None else sensible
        return int(self.random.integers(low, high + 1))

    def one_of(self, *choices: Any) -> Any:
        return choices[int(self.random.integers(len(choices)))]

    def chance(self, probability: float) -> bool:
        return bool(self.random.random() < probability)

    def errors(self, **sizes: tuple[float, float]) -> Keys:
        """Errors of assembly: half of the designs have none, the others some of those given as (sensible, edge) sizes."""
        if self.chance(0.5):
            return {}
        strong = self.edge and self.chance(0.4)
        scale = 1.0 if strong else 0.2
        return {
            name: self.between((-s, s), (-scale * e, scale * e)) for name, (s, e) in sizes.items() if self.chance(0.4)
        }


def random_design(kind: str, seed: int, name: str) -> Keys:
    """The design of a kind with a seed in the range called `name`. Raises KeyError for a kind without ranges."""
    dice = Dice(np.random.default_rng([seed, zlib.crc32(kind.encode()), RANGES.index(name)]), name == "edge")
    low, high = (math.log(0.3), math.log(12.0)) if dice.edge else (math.log(1.0), math.log(8.0))
    module = float(f"{math.exp(dice.random.uniform(low, high)):.4g}")
    keys = {"kind": kind, "name": f"stress {kind} {name} {seed}", "module": module, **KINDS[kind](dice, module)}
    # a kind that has no module leaves it out
    return {key: value for key, value in keys.items() if value is not None}


def teeth(dice: Dice, first: tuple[int, int], edge: tuple[int, int], ratio: float, far: float) -> tuple[int, int]:
    one = dice.count(first, edge)
    return one, max(one, round(one * dice.between((1.0, ratio), (1.0, far))))


def cylindrical(dice: Dice, m: float) -> Keys:
    form = dice.one_of("external", "external", "internal", "ring drives")
    inside = form != "external"
    one, two = teeth(dice, (14, 40), (6, 70), 4.0, 12.0)
    if inside:
        two = max(two, round(one * dice.between((1.8, 4.0), (1.2, 8.0))), one + dice.count((16, 30), (8, 40)))
    helix = dice.one_of(0.0, dice.between((5.0, 30.0), (1.0, 45.0)))
    width = dice.between((4.0, 12.0), (1.0, 30.0)) * m
    small: Keys = {"teeth": one, "face_width": float(f"{width:.4g}")}
    large: Keys = {
        "teeth": -two if inside else two,
        "face_width": float(f"{width * dice.between((0.9, 1.1), (0.3, 1.5)):.4g}"),
    }
    keys: Keys = {
        "assembly": dice.errors(
            dx=(0.01 * m, 0.2 * m), dy=(0.01 * m, 0.2 * m), dz=(0.1 * m, m), gamma_h=(0.05, 0.5), gamma_v=(0.05, 0.5)
        )
    }
    reference = 0.5 * m * (two - one if inside else two + one) / math.cos(math.radians(helix))
    if dice.chance(0.35):
        small["profile_shift"] = dice.between((-0.1, 0.4), (-0.5, 0.8))
        large["profile_shift"] = dice.between((-0.3, 0.3), (-0.6, 0.6))
    elif dice.chance(0.5):
        keys["assembly"]["center_distance"] = float(f"{reference + m * dice.between((-0.1, 0.4), (-0.4, 0.9)):.7g}")
        if dice.chance(0.5):
            keys["shift_sharing"] = dice.one_of("sliding", "equal", "teeth")
    if dice.chance(0.2):
        small["shaper"] = {"teeth": dice.count((18, 40), (12, 80))}
    if inside and dice.chance(0.3):
        large["shaper"] = {"teeth": dice.count((15, 30), (10, max(11, two - 15)))}
    if dice.chance(0.25):
        dice.one_of(small, large)[dice.one_of("tip_chamfer", "tip_rounding")] = float(
            f"{dice.between((0.03, 0.1), (0.01, 0.2)) * m:.3g}"
        )
    if dice.chance(0.7):
        backlash = float(f"{dice.between((0.01, 0.05), (0.0, 0.3)) * m:.3g}")
        keys[dice.one_of("backlash", "circumferential_backlash")] = backlash
    first, second = (large, small) if form == "ring drives" else (small, large)
    return {
        "pressure_angle": dice.one_of(20.0, dice.between((15.0, 25.0), (10.0, 30.0))),
        "profile": dice.one_of("A", "A", "B", "C", "D"),
        "helix_angle": helix,
        "hand": dice.one_of("right", "left"),
        **keys,
        "pinion": first,
        "gear": second,
        "contact": {"flank": dice.one_of("right", "left")},
        **coast_side(dice),
        **rows(dice, helix, small, large),
        **crowned(dice, m, small),
    }


def coast_side(dice: Dice) -> Keys:
    """Asymmetric teeth, of a fifth of the designs."""
    return {"coast_pressure_angle": dice.between((18.0, 28.0), (12.0, 35.0))} if dice.chance(0.2) else {}


def rows(dice: Dice, helix: float, *members: Keys) -> Keys:
    """Double helical teeth, of a fifth of the designs with oblique teeth: a face as wide as both halves and the gap."""
    if not helix or not dice.chance(0.2):
        return {}
    width = min(member["face_width"] for member in members)
    for member in members:
        member["face_width"] = float(f"{2.2 * width:.4g}")
    return {"arrangement": "double_helical", "gap": float(f"{0.2 * width:.4g}")}


def crowned(dice: Dice, m: float, member: Keys) -> Keys:
    """A crowning of a member by the radial feed of a tool, of a fifth of the designs; no keys of the pair."""
    if not dice.chance(0.2) or member["teeth"] < 0:
        return {}
    tool: Keys = dice.one_of({"crowning_tool": "worm"}, {"crowning_tool": "disk", "crowning_disk_diameter": 60.0 * m})
    amount = float(f"{1e-3 * m * dice.between((1.0, 4.0), (0.1, 10.0)):.3g}")
    member["modifications"] = {"helix_crowning": amount, **tool}
    return {}


def planetary(dice: Dice, m: float) -> Keys:
    sun, planet = dice.count((14, 40), (8, 60)), dice.count((14, 40), (8, 60))
    planets = dice.count((2, 4), (1, 6))
    ring = sun + 2 * planet
    # the next ring that lets the planets in evenly
    ring += -(sun + ring) % planets
    width = float(f"{dice.between((4.0, 12.0), (1.0, 25.0)) * m:.4g}")
    keys: Keys = {"planets": planets, "helix_angle": dice.one_of(0.0, dice.between((5.0, 30.0), (1.0, 40.0)))}
    if dice.chance(0.7):
        keys["backlash"] = float(f"{dice.between((0.01, 0.05), (0.0, 0.2)) * m:.3g}")
    return {
        **keys,
        "hand": dice.one_of("right", "left"),
        "sun": {"teeth": sun, "face_width": width},
        "planet": {"teeth": planet, "face_width": width},
        "ring": {"teeth": dice.one_of(-1, 1) * ring, "face_width": width},
        "contact": {"flank": dice.one_of("right", "left")},
        **coast_side(dice),
    }


def rack(dice: Dice, m: float) -> Keys:
    teeth = dice.count((14, 40), (6, 120))
    helix = dice.one_of(0.0, dice.between((5.0, 30.0), (1.0, 45.0)))
    width = dice.between((4.0, 12.0), (1.0, 30.0)) * m
    pitch = math.pi * m / math.cos(math.radians(helix))
    pinion: Keys = {"teeth": teeth, "face_width": float(f"{width:.4g}")}
    bar: Keys = {"face_width": float(f"{width * dice.between((0.9, 1.1), (0.3, 1.5)):.4g}")}
    if dice.chance(0.7):
        bar["teeth"] = dice.count((8, 40), (1, 90))
    if "teeth" not in bar or dice.chance(0.2):
        bar["length"] = float(f"{pitch * (bar.get('teeth', 10) + dice.between((0.5, 6.0), (0.1, 20.0))):.5g}")
    if dice.chance(0.4):
        bar["height"] = float(f"{m * dice.between((4.0, 12.0), (2.9, 30.0)):.4g}")
    if dice.chance(0.2):
        bar["addendum"], bar["dedendum"] = dice.between((0.8, 1.0), (0.5, 1.2)), dice.between((1.15, 1.3), (0.9, 1.6))
    keys: Keys = {
        "assembly": dice.errors(dx=(0.01 * m, 0.2 * m), dz=(0.1 * m, m), gamma_h=(0.05, 0.5), gamma_v=(0.05, 0.5))
    }
    shift = dice.between((-0.1, 0.5), (-0.5, 0.8))
    if dice.chance(0.5):
        pinion["profile_shift"] = shift
    elif dice.chance(0.5) and "height" in bar:
        above = 0.5 * m * teeth / math.cos(math.radians(helix)) + shift * m
        keys["assembly"]["mounting_distance"] = float(f"{above + bar['height'] - m * bar.get('addendum', 1.0):.7g}")
    if dice.chance(0.2):
        pinion["shaper"] = {"teeth": dice.count((18, 40), (12, 80))}
    if dice.chance(0.2):
        pinion[dice.one_of("tip_chamfer", "tip_rounding")] = float(f"{dice.between((0.03, 0.1), (0.01, 0.2)) * m:.3g}")
    if dice.chance(0.2):
        crowning = float(f"{m * dice.between((0.002, 0.006), (0.001, 0.02)):.3g}")
        pinion["modifications"] = {dice.one_of("helix_crowning", "profile_crowning"): crowning}
    if dice.chance(0.7):
        backlash = float(f"{dice.between((0.01, 0.05), (0.0, 0.3)) * m:.3g}")
        keys[dice.one_of("backlash", "circumferential_backlash")] = backlash
    return {
        "pressure_angle": dice.one_of(20.0, dice.between((15.0, 25.0), (10.0, 30.0))),
        "profile": dice.one_of("A", "A", "B", "C", "D"),
        "helix_angle": helix,
        "hand": dice.one_of("right", "left"),
        **keys,
        "pinion": pinion,
        "rack": bar,
        "contact": {"flank": dice.one_of("right", "left")},
        **coast_side(dice),
        **rows(dice, helix, pinion, bar),
    }


def beveloid(dice: Dice, m: float) -> Keys:
    form = dice.one_of("spur", "helical", "helical", "tapered", "intersected", "crossed", "ring")
    one, two = teeth(dice, (14, 40), (5, 70), 4.0, 12.0)
    helix = cone = 0.0
    if form == "ring":
        two = max(two, round(one * dice.between((1.8, 4.0), (1.3, 8.0))), one + dice.count((16, 30), (10, 40)))
    if form in ("helical", "crossed", "ring"):
        helix = dice.one_of(-1, 1) * dice.between((5.0, 30.0), (1.0, 50.0))
    if form in ("tapered", "intersected", "crossed"):
        cone = dice.between((3.0, 25.0), (1.0, 45.0))
    width = dice.between((4.0, 12.0), (1.0, 40.0)) if cone == 0.0 else dice.between((2.0, 3.5), (1.0, 8.0))
    width = float(f"{width * m:.4g}")
    other = -helix if form in ("spur", "helical") else helix
    if form == "ring":
        other -= dice.one_of(0.0, dice.between((2.0, 15.0), (0.5, 30.0))) * math.copysign(1.0, helix)
    pinion: Keys = {"teeth": one, "face_width": width}
    gear: Keys = {
        "teeth": -two if form == "ring" else two,
        "face_width": float(f"{width * dice.between((0.9, 1.0), (0.3, 1.5)):.4g}"),
    }
    assembly: Keys = dice.errors(
        dx=(0.01 * m, 0.2 * m), dy=(0.01 * m, 0.2 * m), dz=(0.1 * m, m), gamma_h=(0.05, 1.0), gamma_v=(0.05, 1.0)
    )
    for member, value, angle in ((pinion, helix, cone), (gear, other, cone)):
        member |= {"helix_angle": value} if value else {}
        member |= {"cone_angle": angle} if angle else {}
    if form == "tapered":
        assembly["turned_over"] = True
    if dice.chance(0.4):
        shift = dice.between((-0.2, 0.4), (-0.8, 1.0))
        pinion["profile_shift"] = shift
        gear["profile_shift"] = dice.one_of(-shift, 0.0, dice.between((-0.2, 0.2), (-0.8, 0.8)))
    elif form in ("spur", "helical") and dice.chance(0.4):
        distance = 0.5 * m * (one + two) / math.cos(math.radians(helix))
        assembly["center_distance"] = float(f"{distance + m * dice.between((-0.02, 0.1), (-0.3, 0.6)):.7g}")
    if dice.edge and dice.chance(0.3):
        for member in (pinion, gear):
            member["addendum"], member["dedendum"] = dice.between((0, 0), (0.5, 1.4)), dice.between((0, 0), (0.7, 1.6))
    if dice.chance(0.15) and not cone:
        pinion[dice.one_of("tip_chamfer", "tip_rounding")] = float(f"{dice.between((0.03, 0.1), (0.01, 0.3)) * m:.3g}")
    if form == "ring":
        # full teeth of rings touch at the ends of their faces on crossed axes
        pinion["modifications"] = {"helix_crowning": float(f"{m * dice.between((0.002, 0.006), (0.001, 0.02)):.3g}")}
    return {
        **coast_side(dice),
        "pressure_angle": dice.one_of(20.0, dice.between((15.0, 25.0), (8.0, 35.0))),
        "backlash": float(f"{dice.one_of(0.0, dice.between((0.0, 0.05), (0.0, 0.3)) * m):.3g}"),
        "pinion": pinion,
        "gear": gear,
        "assembly": assembly,
        "contact": {"flank": dice.one_of("right", "left")},
    }


def circular_arc(dice: Dice, m: float) -> Keys:
    one, two = teeth(dice, (10, 25), (6, 50), 6.0, 10.0)
    lead = dice.between((65.0, 82.0), (50.0, 88.0))
    width = float(f"{dice.between((8.0, 16.0), (2.0, 40.0)) * m:.4g}")
    return {
        "pressure_angle": dice.one_of(30.0, dice.between((25.0, 33.0), (15.0, 45.0))),
        "backlash": float(f"{dice.one_of(0.0, dice.between((0.0, 0.05), (0.0, 0.2)) * m):.3g}"),
        "pinion": {"teeth": one, "face_width": width, "lead_angle": lead},
        "gear": {"teeth": two, "face_width": width, "lead_angle": lead},
        "assembly": dice.errors(dC=(0.005 * m, 0.1 * m), dgamma=(0.1, 1.0)),
        "contact": {
            "flank": dice.one_of("right", "left"),
            "count_phi1": dice.one_of("generation", "rotation"),
        },
    }


def parabolic(dice: Dice, m: float, concave: bool) -> Keys:
    one, two = teeth(dice, (15, 30), (8, 60), 5.0, 10.0)
    width = float(f"{dice.between((10.0, 18.0), (3.0, 35.0)) * m:.4g}")
    parabola = dice.between((0.06, 0.1), (0.01, 0.3))
    pinion: Keys = {
        "teeth": one,
        "face_width": width,
        "dedendum": dice.between((0.85, 1.1), (0.6, 1.4)),
        "parabola": float(f"{parabola / m:.5g}"),
        "crowning": dice.one_of("worm_plunge", "worm_roll", "disk", "none"),
        "plunge_coefficient": float(f"{dice.between((0.003, 0.03), (0.0, 0.2)) * m / (0.5 * width) ** 2:.4g}"),
    }
    gear: Keys = {"teeth": two, "face_width": width, "addendum": dice.between((0.6, 0.85), (0.4, 1.2))}
    if concave or dice.chance(0.3):
        gear["parabola"] = float(f"{parabola * dice.between((0.85, 0.95), (0.3, 0.99)) / m:.5g}")
    more: Keys = {"coast_pressure_angle": dice.between((20.0, 28.0), (12.0, 35.0))} if dice.chance(0.2) else {}
    return {
        "pressure_angle": dice.one_of(25.0, dice.between((20.0, 28.0), (12.0, 35.0))),
        "helix_angle": dice.one_of(-1, 1) * dice.between((10.0, 28.0), (3.0, 45.0)),
        "rack_parameter": dice.between((0.65, 1.0), (0.4, 1.8)),
        "pinion": pinion,
        "gear": gear,
        "assembly": dice.errors(
            dE=(0.01 * m, 0.2 * m), d_gamma=(0.05, 0.5), d_lambda1=(0.05, 0.5), d_lambda2=(0.05, 0.5)
        ),
        "contact": {"flank": dice.one_of("right", "left")},
        **more,
    }


def bevel_errors(dice: Dice, m: float) -> Keys:
    found = dice.errors(dA=(0.01 * m, 0.1 * m), dG=(0.01 * m, 0.1 * m), dV=(0.01 * m, 0.1 * m), d_delta=(0.05, 0.5))
    for member in ("pinion", "gear"):
        if dice.chance(0.1):
            size = dice.between((0.0, 0.005), (0.0, 0.05)) * m
            found |= {f"{member}_eccentricity": float(f"{size:.3g}"), f"{member}_phase": dice.between((-180.0, 180.0))}
    return found


def bevel_face_width(dice: Dice, m: float, teeth: tuple[int, int], angle: float) -> Keys:
    """The face width as a part of the outer cone distance at a shaft angle, deg; most designs leave it to its default."""
    one, two = teeth
    delta = math.atan2(math.sin(math.radians(angle)), two / one + math.cos(math.radians(angle)))
    outer = 0.5 * m * one / math.sin(delta)
    if not dice.chance(0.4):
        return {}
    return {"face_width": float(f"{outer * dice.between((0.2, 0.32), (0.08, 0.45)):.4g}")}


def spiral_bevel(dice: Dice, m: float) -> Keys:
    one, two = teeth(dice, (12, 25), (8, 45), 4.5, 8.0)
    angle = dice.one_of(90.0, 90.0, dice.between((70.0, 110.0), (35.0, 140.0)))
    more = bevel_face_width(dice, m, (one, two), angle)
    pinion: Keys = {"teeth": one}
    if dice.chance(0.2):
        side = {
            "te_at_change": dice.between((3.0, 30.0), (-20.0, 200.0)),
            "path_angle": dice.between((60, 120), (0, 180)),
        }
        pinion[dice.one_of("concave", "convex")] = side
    return {
        "spiral_angle": dice.one_of(0.0, 35.0, dice.between((5.0, 40.0), (0.0, 48.0))),
        "shaft_angle": angle,
        "pressure_angle": dice.one_of(20.0, dice.between((17.5, 22.5), (12.0, 28.0))),
        "hand": dice.one_of("left", "right"),
        "pinion": pinion,
        "gear": {"teeth": two},
        "assembly": bevel_errors(dice, m),
        "contact": {"side": dice.one_of("pinion_concave", "pinion_convex")},
        **more,
        **hobbed(dice, m, (one, two), angle),
    }


def hobbed(dice: Dice, m: float, teeth: tuple[int, int], angle: float) -> Keys:
    """A head for face hobbing, of a quarter of the designs: about as large as the mean cone distance."""
    if not dice.chance(0.25):
        return {}
    one, two = teeth
    delta = math.atan2(math.sin(math.radians(angle)), two / one + math.cos(math.radians(angle)))
    mean = 0.43 * m * one / math.sin(delta)
    groups = dice.one_of(5, 7, 11, 13, 17)
    return {
        "process": "face_hobbed",
        "head": {"blade_groups": groups, "radius": float(f"{mean * dice.between((0.8, 1.3), (0.5, 2.5)):.4g}")},
    }


def straight_bevel(dice: Dice, m: float) -> Keys:
    one, two = teeth(dice, (13, 30), (8, 60), 4.0, 8.0)
    angle = dice.one_of(90.0, 90.0, dice.between((60.0, 120.0), (30.0, 140.0)))
    more = bevel_face_width(dice, m, (one, two), angle)
    form = dice.one_of("octoid", "octoid", "spherical_involute")
    pinion: Keys = {"teeth": one}
    if form == "octoid" and dice.chance(0.4):
        pinion["disc"] = {"dish_angle": dice.between((1.0, 5.0), (0.0, 15.0))}
    return {
        "form": form,
        "taper": dice.one_of("standard", "standard", "tilted_root_line", "uniform"),
        "shaft_angle": angle,
        "pressure_angle": dice.one_of(20.0, dice.between((17.5, 25.0), (12.0, 30.0))),
        "backlash": float(f"{dice.one_of(0.0, dice.between((0.01, 0.05), (0.0, 0.2)) * m):.3g}"),
        "pinion": pinion,
        "gear": {"teeth": two},
        "assembly": bevel_errors(dice, m),
        **more,
    }


def hypoid(dice: Dice, m: float) -> Keys:
    one, two = teeth(dice, (9, 16), (5, 25), 4.5, 8.0)
    diameter, angle = m * two, dice.one_of(90.0, 90.0, dice.between((80.0, 100.0), (60.0, 120.0)))
    offset = diameter * dice.between((0.05, 0.18), (-0.15, 0.25))
    spiral = dice.between((40.0, 50.0), (20.0, 60.0)) if offset > 0.0 else dice.between((20.0, 35.0), (5.0, 45.0))
    return {
        "offset": float(f"{offset:.4g}"),
        "spiral_angle": spiral,
        "shaft_angle": angle,
        "pressure_angle": dice.one_of(20.0, dice.between((18.0, 22.5), (14.0, 28.0))),
        "taper": dice.one_of("standard", "standard", "tilted_root_line", "uniform"),
        "hand": dice.one_of("left", "right"),
        "backlash": float(f"{dice.one_of(0.0, dice.between((0.01, 0.05), (0.0, 0.2)) * m):.3g}"),
        "pinion": {"teeth": one},
        "gear": {"teeth": two},
        "assembly": bevel_errors(dice, m),
        "contact": {"side": dice.one_of("pinion_concave", "pinion_convex")},
        **({"taper": None, **head} if (head := hobbed(dice, m, (one, two), angle)) else {}),
    }


def spiral_bevel_conjugate(dice: Dice, m: float) -> Keys:
    one, two = teeth(dice, (16, 28), (10, 45), 3.0, 6.0)
    radius = dice.between((17.0, 21.0), (8.0, 40.0)) * m
    second = dice.one_of(True, False)
    larger = radius if second else radius * dice.between((1.01, 1.05), (1.001, 1.3))
    more: Keys = {"rho": float(f"{m * dice.between((80.0, 200.0), (20.0, 600.0)):.5g}")} if second else {}
    if dice.chance(0.3):
        more["addendum"], more["dedendum"] = (
            dice.between((0.7, 0.9), (0.4, 1.1)),
            dice.between((0.95, 1.15), (0.8, 1.4)),
        )
    return {
        "beta": dice.one_of(35.0, dice.between((25.0, 40.0), (0.0, 48.0))),
        "psi_c": dice.one_of(20.0, dice.between((17.0, 23.0), (10.0, 32.0))),
        "shaft_angle": dice.one_of(90.0, dice.between((75.0, 105.0), (50.0, 130.0))),
        "hand": dice.one_of("left", "right"),
        "face_width": float(f"{dice.between((4.0, 7.0), (1.5, 12.0)) * m:.4g}"),
        "pinion": {"teeth": one, "r_d": float(f"{radius:.6g}")},
        "gear": {"teeth": two, "r_d": float(f"{larger:.6g}")},
        "assembly": bevel_errors(dice, m),
        "contact": {"side": dice.one_of("pinion_concave", "pinion_convex")},
        **more,
    }


def face_gear(dice: Dice, m: float) -> Keys:
    one, two = teeth(dice, (18, 28), (10, 45), 6.0, 10.0)
    shaper = one + dice.one_of(0, 1, 2, 3)
    pinion: Keys = {"teeth": one}
    if dice.chance(0.2):
        pinion["profile_shift"] = dice.between((-0.1, 0.2), (-0.5, 0.6))
    return {
        "pressure_angle": dice.one_of(25.0, dice.between((20.0, 27.5), (14.0, 32.0))),
        "shaft_angle": dice.one_of(90.0, dice.between((80.0, 100.0), (60.0, 125.0))),
        "backlash": float(f"{dice.one_of(0.0, dice.between((0.0, 0.05), (0.0, 0.2)) * m):.3g}"),
        "pinion": pinion,
        "gear": {"teeth": max(shaper, two, round(3.5 * one) if not dice.edge else 0)},
        "shaper": {"teeth": shaper},
        "assembly": dice.errors(dE=(0.01 * m, 0.1 * m), dq=(0.02 * m, 0.2 * m), d_gamma=(0.05, 0.5)),
        "contact": {"flank": dice.one_of("right", "left")},
    }


def worm_drive(dice: Dice, m: float) -> Keys:
    threads, quotient = dice.count((1, 4), (1, 6)), dice.between((8.0, 16.0), (6.0, 20.0))
    worm: Keys = {
        "threads": threads,
        "form": dice.one_of("ZA", "ZN", "ZI", "ZK", "ZC"),
        "right_hand": dice.chance(0.7),
        "quotient": quotient,
    }
    wheel: Keys = {"teeth": dice.count((28, 60), (20, 80))}
    if worm["form"] == "ZC":
        wheel["profile_shift"] = dice.between((0.4, 0.9), (0.0, 1.2))
    elif dice.chance(0.4):
        wheel["profile_shift"] = dice.between((-0.3, 0.5), (-0.7, 1.0))
    if dice.chance(0.2):
        wheel["tip_form"] = "cylindrical"
    if dice.chance(0.3):
        wheel["face_width"] = float(f"{m * (quotient + 2.0) * dice.between((0.5, 0.72), (0.3, 0.9)):.4g}")
    keys: Keys = {
        "pressure_angle": dice.one_of(20, dice.between((15.0, 25.0), (12.0, 30.0))),
        "backlash": dice.one_of(0.0, float(f"{m * dice.between((0.01, 0.05), (0.0, 0.1)):.3g}")),
        "worm": worm,
        "wheel": wheel,
        "assembly": dice.errors(da=(0.02, 0.2), dz1=(0.1, 1.0), dz2=(0.1, 1.0), d_sigma=(0.05, 0.5)),
    }
    if dice.chance(0.6):
        keys["hob"] = {"reference_diameter": float(f"{m * quotient * dice.between((1.02, 1.08), (1.0, 1.2)):.5g}")}
    if dice.chance(0.2):
        keys["shaft_angle"] = dice.between((80.0, 100.0), (60.0, 120.0))
    return keys


def cycloidal(dice: Dice, m: float) -> Keys:
    difference = dice.one_of(1, 1, 2)
    disc, form = dice.count((9, 39), (5, 60)), dice.one_of("pins_in_ring", "pins_in_ring", "pins_in_disc")
    circle = 10.0 * m * dice.between((1.0, 4.0), (1.0, 8.0))
    pins = disc if form == "pins_in_disc" else disc + difference
    shortening = dice.between((0.4, 0.75), (0.1, 0.95))
    return {
        "module": None,
        "eccentricity": float(f"{0.5 * circle * difference * shortening / pins:.5g}"),
        "pin_circle": float(f"{circle:.5g}"),
        "pin_diameter": float(f"{circle * math.sin(math.pi / pins) * dice.between((0.45, 0.65), (0.2, 0.95)):.5g}"),
        "form": form,
        "disc": {"teeth": disc, "face_width": float(f"{m * dice.between((3.0, 10.0), (1.0, 20.0)):.4g}")},
        "ring": {"teeth": disc + difference, "face_width": float(f"{m * dice.between((3.0, 10.0), (1.0, 20.0)):.4g}")},
        "modification": dice.one_of(
            {},
            {"equidistant": float(f"{1e-3 * m * dice.between((1.0, 10.0), (0.1, 40.0)):.3g}")},
            {"rotation": dice.between((0.005, 0.05), (0.001, 0.2))},
        ),
        "assembly": dice.errors(dx=(1e-3 * m, 0.02 * m), dy=(1e-3 * m, 0.02 * m), dz=(0.1 * m, m)),
        "contact": {"flank": dice.one_of("right", "left")},
    }


def spline(dice: Dice, m: float) -> Keys:
    profiles = ("DIN 5480", "ISO 4156 30 flat", "ISO 4156 30 fillet", "ISO 4156 37.5 fillet", "ISO 4156 45 fillet")
    width = m * dice.between((5.0, 15.0), (1.0, 30.0))
    thinner = m * dice.between((0.01, 0.03), (0.0, 0.1))
    shaft: Keys = {
        "face_width": float(f"{width:.4g}"),
        "thickness_allowance": {"upper": 0.0, "lower": -float(f"{thinner:.3g}")},
    }
    if dice.chance(0.5):
        shaft["modifications"] = {"helix_crowning": float(f"{m * dice.between((0.001, 0.005), (0.0001, 0.02)):.3g}")}
    return {
        "profile": dice.one_of(*profiles),
        "teeth": dice.count((12, 40), (6, 80)),
        "profile_shift": dice.one_of(0.0, dice.between((-0.05, 0.45), (-0.3, 0.5))),
        "shaft": shaft,
        "hub": {"face_width": float(f"{width * dice.between((0.8, 1.2), (0.3, 2.0)):.4g}")},
        "assembly": dice.errors(
            dx=(1e-4 * m, 1e-3 * m),
            dy=(1e-4 * m, 1e-3 * m),
            dz=(0.1 * m, m),
            gamma_h=(0.005, 0.05),
            gamma_v=(0.005, 0.05),
        ),
        "contact": {"flank": dice.one_of("right", "left")},
    }


KINDS: Mapping[str, Callable[[Dice, float], Keys]] = {
    "cylindrical": cylindrical,
    "planetary": planetary,
    "rack": rack,
    "beveloid": beveloid,
    "circular_arc": circular_arc,
    "novikov": lambda dice, m: parabolic(dice, m, True),
    "modified_involute": lambda dice, m: parabolic(dice, m, False),
    "spiral_bevel": spiral_bevel,
    "straight_bevel": straight_bevel,
    "hypoid": hypoid,
    "spiral_bevel_conjugate": spiral_bevel_conjugate,
    "face_gear": face_gear,
    "worm_drive": worm_drive,
    "cycloidal": cycloidal,
    "spline": spline,
}
