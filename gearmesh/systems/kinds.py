"""The kinds of designs that come with gearmesh: description and modules of each. No gear system is loaded here."""

from __future__ import annotations

from gearmesh.records import dataclass


@dataclass(frozen=True)
class OwnKind:
    """A kind that comes with gearmesh.

    - about: its description in one line.
    - design: module below `gearmesh.systems` and class of its designs.
    """

    about: str
    design: tuple[str, str]

    @property
    def system(self) -> str:
        """Module with everything else, beside the module of the designs."""
        return f"{self.design[0].rpartition('.')[0]}.system"


#: the kinds by name
OWN_KINDS = {
    "cylindrical": OwnKind(
        "spur and helical gears on parallel axes, external and internal, or one gear alone [ISO 21771]",
        ("cylindrical.design", "CylindricalDesign"),
    ),
    "planetary": OwnKind(
        "planetary sets: sun, planets and internal gear, spur, helical or double helical [ISO 21771]",
        ("cylindrical.planetary.design", "PlanetaryDesign"),
    ),
    "rack": OwnKind(
        "pinion and rack of finite length, or a rack alone, spur or helical [ISO 21771]",
        ("cylindrical.rack.design", "RackDesign"),
    ),
    "beveloid": OwnKind(
        "involute spur, helical and beveloid (conical involute) gears on any axes [LT02]",
        ("beveloid.design", "BeveloidDesign"),
    ),
    "circular_arc": OwnKind(
        "circular-arc (Wildhaber-Novikov) helical gears on parallel axes [LT85]",
        ("circular_arc.design", "CircularArcDesign"),
    ),
    "novikov": OwnKind(
        "Novikov-Wildhaber helical gears, parabolic rack cutters in internal tangency [LF04 17]",
        ("parabolic_helical.design", "NovikovDesign"),
    ),
    "modified_involute": OwnKind(
        "modified involute helical gears: crowned pinion, involute gear [LF04 17]",
        ("parabolic_helical.design", "ModifiedInvoluteDesign"),
    ),
    "spiral_bevel": OwnKind(
        "spiral, zerol and straight bevel gears cut by head cutters on a cradle [AB; ISO 23509]",
        ("spiral_bevel.design", "SpiralBevelDesign"),
    ),
    "straight_bevel": OwnKind(
        "straight bevel gears: octoids of a flat crown gear, planed or cut by discs, or spherical involutes [ISO 23509]",
        ("straight_bevel.design", "StraightBevelDesign"),
    ),
    "spiral_bevel_conjugate": OwnKind(
        "conjugate spiral bevel gears, Geometry I and II [CR3553]",
        ("spiral_bevel.conjugate.design", "ConjugateDesign"),
    ),
    "hypoid": OwnKind(
        "hypoid gears: bevel gears on offset axes, cut by head cutters on a cradle [ISO 23509; AB]",
        ("spiral_bevel.design", "HypoidDesign"),
    ),
    "face_gear": OwnKind(
        "face gear cut by an involute shaper, and a spur pinion, on intersected or crossed axes [LF04 18]",
        ("face_gear.design", "FaceGearDesign"),
    ),
    "worm_drive": OwnKind(
        "worm drives: worms ZA, ZN, ZI, ZK and ZC [ISO 10828], the wheel as its hob generates it",
        ("worm_drive.design", "WormDriveDesign"),
    ),
    "spline": OwnKind(
        "involute splines: shaft and hub on one axis, by designation or by keys [DIN 5480, ISO 4156, ANSI B92.1]",
        ("cylindrical.spline.design", "SplineDesign"),
    ),
    "cycloidal": OwnKind(
        "cycloidal drives: pins on a circle and the lobes that they generate, difference of one or two teeth",
        ("cycloidal.design", "CycloidalDesign"),
    ),
}

#: terms of the field, without "gear" and the like, and the kind and keys that make such gears
FIELD_WORDS = {
    "spur": 'kind = "cylindrical"',
    "helical": 'kind = "cylindrical" with helix_angle',
    "involute": 'kind = "cylindrical"',
    "parallel": 'kind = "cylindrical"',
    "external": 'kind = "cylindrical"',
    "double helical": 'kind = "cylindrical" with helix_angle and arrangement = "double_helical"',
    "herringbone": 'kind = "cylindrical" with helix_angle and arrangement = "double_helical"',
    "internal": 'kind = "cylindrical" with negative gear.teeth, or gear.internal = true',
    "ring": 'kind = "cylindrical" with negative gear.teeth, or gear.internal = true',
    "annulus": 'kind = "cylindrical" with negative gear.teeth, or gear.internal = true',
    "planet": 'kind = "planetary"',
    "sun": 'kind = "planetary"',
    "epicyclic": 'kind = "planetary"',
    "rack and pinion": 'kind = "rack"',
    "crossed": 'kind = "beveloid" with pinion.helix_angle and gear.helix_angle, whose sum is the shaft angle',
    "crossed helical": 'kind = "beveloid" with pinion.helix_angle and gear.helix_angle, whose sum is the shaft angle',
    "screw": 'kind = "beveloid" with pinion.helix_angle and gear.helix_angle, whose sum is the shaft angle',
    "conical involute": 'kind = "beveloid" with pinion.cone_angle and gear.cone_angle',
    "wildhaber": 'kind = "novikov"',
    "wildhaber novikov": 'kind = "novikov"',
    "circular arc helical": 'kind = "circular_arc"',
    "bevel": 'kind = "spiral_bevel", or "straight_bevel"',
    "straight bevel": 'kind = "straight_bevel"',
    "octoid": 'kind = "straight_bevel"',
    "spherical involute": 'kind = "straight_bevel" with form = "spherical_involute"',
    "coniflex": 'kind = "straight_bevel" with pinion.disc and gear.disc',
    "zerol": 'kind = "spiral_bevel" with spiral_angle = 0',
    "zerol bevel": 'kind = "spiral_bevel" with spiral_angle = 0',
    "miter": 'kind = "spiral_bevel" or "straight_bevel" with as many teeth on the pinion as on the gear',
    "crown": 'kind = "face_gear"',
    "face": 'kind = "face_gear"',
    "contrate": 'kind = "face_gear"',
    "worm": 'kind = "worm_drive"',
    "worm wheel": 'kind = "worm_drive"',
    "worm and wheel": 'kind = "worm_drive"',
    "splined shaft": 'kind = "spline"',
    "splined hub": 'kind = "spline"',
    "involute spline": 'kind = "spline"',
    "serration": 'kind = "spline" with profile = "ISO 4156 45 fillet"',
    "cycloid": 'kind = "cycloidal"',
    "cycloidal drive": 'kind = "cycloidal"',
    "cycloidal reducer": 'kind = "cycloidal"',
    "pin": 'kind = "cycloidal"',
    "pin wheel": 'kind = "cycloidal"',
    "trochoidal": 'kind = "cycloidal"',
    "train": "a train of several stages has a command of its own, gearmesh train",
    "gear train": "a train of several stages has a command of its own, gearmesh train",
    "gearbox": "a train of several stages has a command of its own, gearmesh train",
    "gerotor": 'kind = "cycloidal" with form = "pins_in_disc" or "pins_in_ring"',
}
#: words beside a kind that say nothing about it
_BESIDE_KIND = ("gears", "gear", "gearing", "pair", "set", "wheels")


def kind_of_words(kind: str) -> str:
    """Return the kind for a term of the field, as "bevel: kind = ..."; empty for an unknown term."""
    words = kind.lower().replace("_", " ").replace("-", " ").split()
    whole = " ".join(words)
    bare = " ".join(word for word in words if word not in _BESIDE_KIND)
    name = next((name for name in (whole, bare) if name in FIELD_WORDS), None)
    if name is not None:
        return f"{name}: {FIELD_WORDS[name]}"
    # the name of a kind in another spelling
    joined = next((known for known in ("_".join(words), bare.replace(" ", "_")) if known in OWN_KINDS), None)
    return "" if joined is None else f'did you mean "{joined}"?'
