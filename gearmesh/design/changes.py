"""Changed defaults and changed meanings of keys, by version: the warnings for a design that states its version.

Whoever changes a default raises the version and adds an entry here and to gearmesh/CHANGES.md.
"""

from __future__ import annotations

import re

from gearmesh.records import dataclass

#: a version as a file states it
_VERSION_PATTERN = re.compile(r"\d+\.\d+(\.\d+)?", re.ASCII)
#: kinds that are cut as spiral bevel gears
BEVEL_KINDS = ("spiral_bevel", "hypoid")


@dataclass(frozen=True)
class Change:
    """A changed default."""

    #: version that changed it
    version: str
    #: kinds whose default changed; empty for all kinds
    kinds: tuple[str, ...]
    #: dotted key
    key: str
    #: default before, in words
    old: str
    #: default since then, in words
    new: str
    #: reason
    why: str


def _of_both_sides(key: str, old: str, new: str, why: str) -> tuple[Change, ...]:
    """Return the change of a key of both flanks of a bevel pinion."""
    return tuple(Change("0.2.0", BEVEL_KINDS, f"pinion.{side}.{key}", old, new, why) for side in ("concave", "convex"))


#: changed defaults, the newest version last
DEFAULT_CHANGES: tuple[Change, ...] = (
    Change(
        "0.2.0",
        (),
        "contact.delta",
        "0.00635 mm",
        "0.00635 mm, at most 0.01 modules",
        "no ellipse outgrows small teeth",
    ),
    *_of_both_sides("path_angle", "90", "chosen, 90 or as far from it as the contact ratio needs", "contact ratio"),
    *_of_both_sides("mean_offset", "0", "chosen, the middle of the path", "the path fits the active flank"),
    *_of_both_sides("mean_shift", "0", "chosen, the middle of the path", "the path fits the active flank"),
    Change(
        "0.2.0",
        BEVEL_KINDS,
        "depth_factor",
        "k_d by pinion teeth",
        "k_d by pinion teeth, less against undercut",
        "undercut",
    ),
    Change(
        "0.2.0", BEVEL_KINDS, "addendum_factor", "c_ham by ratio", "c_ham by ratio, less against undercut", "undercut"
    ),
    Change(
        "0.2.0",
        BEVEL_KINDS,
        "backlash",
        "0, the gear alone thinned",
        "by module and accuracy_grade, half of it from each member",
        "AGMA 2005; ISO 23509 shares it",
    ),
    Change(
        "0.2.0",
        ("face_gear",),
        "pinion.dedendum",
        "1.25",
        "1.25, or what clears the gear's tips",
        "the gear's tips were up to 23 um inside the pinion's fillet",
    ),
    Change(
        "0.2.0",
        ("face_gear",),
        "pinion.tool_tip_radius",
        "0.25",
        "0.25, or what the rack has room for and clears the gear's tips",
        "the gear's tips were up to 23 um inside the pinion's fillet",
    ),
    Change(
        "0.2.0",
        ("face_gear",),
        "gear.inner_radius",
        "2 % of the width between undercut and pointing",
        "the same, from where the shaper's involute reaches the tips",
        "the flank goes up to the tip",
    ),
    Change(
        "0.4.0",
        ("spiral_bevel_conjugate",),
        "contact.side",
        "pinion_convex, or pinion_concave where another key of contact is set",
        "pinion_convex",
        "a key does not change the default of another one",
    ),
    Change(
        "0.9.0",
        ("worm_drive",),
        "wheel.profile_shift",
        "by center_distance, without it 0",
        "by center_distance, without it 0, of ZC 0.75",
        "wheels of ZC worms are undercut without it",
    ),
    Change(
        "0.9.0",
        ("worm_drive",),
        "wheel.face_width",
        "2 m (sqrt(q + 1) + 0.5)",
        "2 m (sqrt(q + 1) + 0.5), ZC: 2 m (sqrt(q + 1) - 0.5)",
        "flanks of ZC wheels began beyond the tip at the toe",
    ),
    Change(
        "0.11.0",
        ("worm_drive",),
        "wheel.face_width",
        "2 m (sqrt(q + 1) + 0.5), ZC: 2 m (sqrt(q + 1) - 0.5)",
        "the same, less where flanks end sooner",
        "wheels of steep threads were refused",
    ),
    Change(
        "0.11.0",
        ("worm_drive",),
        "center_distance",
        "(d_1 + m z2) / 2 + x m",
        "the same at a shaft_angle of 90, else with the wheel's reference diameter m_n z2 / cos(beta_2)",
        "tips and roots in place at other shaft angles",
    ),
    Change(
        "0.12.0",
        ("worm_drive",),
        "wheel.face_width",
        "the standard's, less where flanks end sooner",
        "the same, less too where teeth are pointed or undercut removes the whole flank between the stations of the proof",
        "solids of such wheels failed",
    ),
    Change(
        "0.13.0",
        ("worm_drive",),
        "worm.root_rounding",
        "0.2",
        "0.2, less where the space has no room for it",
        "worms of ZC threads with large pressure angles were refused",
    ),
    Change(
        "0.14.0",
        ("worm_drive",),
        "wheel.addendum",
        "1",
        "1, less where teeth would be pointed or flanks would not reach the tip",
        "such wheels were refused for an addendum that nobody set",
    ),
    Change(
        "0.14.0",
        ("worm_drive",),
        "worm.dedendum",
        "1.2",
        "1.2, less where the flanks end above the rounding of the root",
        "steep worms were refused for a root that nobody set",
    ),
    Change(
        "0.14.0",
        ("worm_drive",),
        "wheel.face_width",
        "the standard's, at least half of it where flanks end sooner",
        "the same, down to a fifth of it where no tooth is sound on half",
        "such wheels were refused for a face that nobody set",
    ),
    Change(
        "0.16.0",
        ("worm_drive",),
        "hob.pitch_height",
        "0: hobs had the worm's normal module on their reference cylinder",
        "the pitch point's, x2 of axes at right angles; of lead angles above 20 deg at least 0",
        "wheels with a profile shift that a larger hob cuts were not uniform, and jammed",
    ),
    Change(
        "0.16.0",
        ("worm_drive",),
        "hob.swivel_angle",
        "gamma_0 - gamma, on the reference cylinders",
        "gamma_w0 - gamma_w, at the height of the pitch point",
        "threads of worm and larger hob were not tangent where they work",
    ),
    Change(
        "0.17.0",
        ("worm_drive",),
        "wheel.face_width",
        "DIN 3975's, or less where flanks end sooner or teeth are pointed, as the stations of a proof show",
        "the same, as also the ends of the throat show, where lands are least",
        "of steep threads a few were pointed there, and no fine mesh was found",
    ),
    Change(
        "0.17.0",
        ("worm_drive",),
        "wheel.addendum",
        "1, or what the tooth has room for at the stations of a proof",
        "the same, also where the throat ends",
        "of steep threads a few were pointed there, and no fine mesh was found",
    ),
    *(
        Change(
            "0.18.0",
            BEVEL_KINDS,
            f"pinion.{side}.mesh_angle",
            "where it touches the gear at the mean point",
            'the same; 0, as it is cut, of given settings with mean_point = "cradle_zero"',
            "given machines define phi1 = 0",
        )
        for side in ("concave", "convex")
    ),
)


@dataclass(frozen=True)
class Meaning:
    """A changed meaning of keys of a member's table."""

    #: version that changed it
    version: str
    #: attribute of the table that is True for the members concerned
    flag: str
    #: names of the keys in the table
    keys: tuple[str, ...]
    #: new meaning, in words
    what: str


#: changed meanings, the newest version last
KEY_MEANING_CHANGES = (
    Meaning(
        "0.11.0",
        "internal",
        (
            *(f"end_{edge}_{end}" for edge in ("chamfer", "rounding") for end in ("toe", "heel")),
            *("toe_bore.diameters", "heel_bore.diameters", "bolts.depth"),
        ),
        "the toe of an internal gear is its end at z < 0, and no longer the other one",
    ),
)


def parse_version(version: str) -> tuple[int, int, int]:
    """Return a version as numbers, "0.2" as (0, 2, 0). Raises ValueError for any other text."""
    if not _VERSION_PATTERN.fullmatch(version):
        raise ValueError(version)
    major, minor, *patch = map(int, version.split("."))
    return major, minor, (patch or [0])[0]


def changes_since(version: str, kind: str) -> tuple[Change, ...]:
    """Return the defaults of a kind that changed after a version."""
    return tuple(
        change
        for change in DEFAULT_CHANGES
        if parse_version(change.version) > parse_version(version) and (not change.kinds or kind in change.kinds)
    )


def meanings_since(version: str) -> tuple[Meaning, ...]:
    """Return the meanings of keys that changed after a version."""
    return tuple(meaning for meaning in KEY_MEANING_CHANGES if parse_version(meaning.version) > parse_version(version))


def unknown_version(stated: str, own: str) -> str:
    """Return the reason to refuse a stated version: no version, or newer than the program's version `own`; empty if valid."""
    try:
        newer = parse_version(stated) > parse_version(own)
    except ValueError:
        return f'must be a version, as "{own}"'
    return f'newer than this program, {own}, which may have other defaults; allowed is at most "{own}"' if newer else ""
