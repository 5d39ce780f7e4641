"""The kinds of designs that come with gearmesh: what each is and where it is found. Nothing of a gear system is loaded here."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class OwnKind:
    """A kind: one line `about` it, its `design` (module below `gearmesh.systems` and class), and the module of
    `gearmesh.systems.registered` that has all else."""

    about: str
    design: tuple[str, str]
    registered: str


KINDS = {
    "cylindrical": OwnKind(
        "spur and helical gears on parallel axes, external and internal, or one gear alone [ISO 21771]",
        ("cylindrical.design", "CylindricalDesign"),
        "cylindrical",
    ),
    "planetary": OwnKind(
        "planetary sets: sun, planets and internal gear, spur, helical or double helical [ISO 21771]",
        ("cylindrical.planetary.design", "PlanetaryDesign"),
        "planetary",
    ),
    "rack": OwnKind(
        "pinion and rack of finite length, or a rack alone, spur or helical [ISO 21771]",
        ("cylindrical.rack.design", "RackDesign"),
        "rack",
    ),
    "beveloid": OwnKind(
        "involute spur, helical and beveloid (conical involute) gears on any axes [LT02]",
        ("beveloid.design", "BeveloidDesign"),
        "beveloid",
    ),
    "circular_arc": OwnKind(
        "circular-arc (Wildhaber-Novikov) helical gears on parallel axes [LT85]",
        ("circular_arc.design", "CircularArcDesign"),
        "circular_arc",
    ),
    "novikov": OwnKind(
        "Novikov-Wildhaber helical gears, parabolic rack cutters in internal tangency [LF04 17]",
        ("parabolic_helical.design", "NovikovDesign"),
        "parabolic_helical",
    ),
    "modified_involute": OwnKind(
        "modified involute helical gears: crowned pinion, involute gear [LF04 17]",
        ("parabolic_helical.design", "ModifiedInvoluteDesign"),
        "parabolic_helical",
    ),
    "spiral_bevel": OwnKind(
        "spiral, zerol and straight bevel gears cut by head cutters on a cradle [AB; ISO 23509]",
        ("spiral_bevel.design", "SpiralBevelDesign"),
        "spiral_bevel",
    ),
    "spiral_bevel_conjugate": OwnKind(
        "conjugate spiral bevel gears, Geometry I and II [CR3553]",
        ("spiral_bevel.conjugate.design", "ConjugateDesign"),
        "spiral_bevel",
    ),
    "hypoid": OwnKind(
        "hypoid gears: bevel gears on offset axes, cut by head cutters on a cradle [ISO 23509; AB]",
        ("spiral_bevel.hypoid_design", "HypoidDesign"),
        "spiral_bevel",
    ),
    "face_gear": OwnKind(
        "face gear cut by an involute shaper, and a spur pinion, on intersected or crossed axes [LF04 18]",
        ("face_gear.design", "FaceGearDesign"),
        "face_gear",
    ),
    "worm_drive": OwnKind(
        "worm drives: worms ZA, ZN, ZI, ZK and ZC [ISO 10828], the wheel as its hob generates it",
        ("worm_drive.design", "WormDriveDesign"),
        "worm_drive",
    ),
}
