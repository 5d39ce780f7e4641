"""One gear or rack in one call: its design from a few values, and the gears built from the design."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from gearmesh.api.gears import Gears, build
from gearmesh.arguments import checks_arguments
from gearmesh.design.keys import MM_PER
from gearmesh.errors import ArgumentError, DesignError
from gearmesh.lengths import Length, in_mm

#: default of the face width, in normal modules
FACE_WIDTH_MODULES = 10.0
#: tables of the members of a design of one gear or of a pair
MEMBER_TABLES = ("gear", "rack", "pinion")


@checks_arguments
def gear(
    teeth: int,
    *,
    module: Length | None = None,
    diametral_pitch: float | None = None,
    helix: float = 0.0,
    hand: str = "right",
    face: Length | None = None,
    bore: Length | None = None,
    shift: float = 0.0,
    pressure_angle: float = 20.0,
    internal: bool = False,
    rack: bool = False,
    settings: Sequence[str] = (),
) -> Gears:
    """Build one spur or helical gear without a mating gear, or a rack.

    Parameters
    ----------
    teeth : int
        Number of teeth.
    module, diametral_pitch
        Normal module, mm, or normal diametral pitch, 1/inch.
    helix, hand
        Helix angle, deg, and its hand, "right" or "left".
    face
        Face width, mm; by default 10 modules.
    bore
        Diameter of the bore, mm, 0 for none; by default 40 % of the root diameter.
    shift
        Profile shift coefficient x.
    pressure_angle
        Normal pressure angle, deg.
    internal, rack
        True for an internal gear; True for a rack.
    settings
        Other keys of the design, as in `gm.load`: "gear.tip_chamfer=0.2", for a rack "rack.height=20".

    Returns
    -------
    Gears
        Gears with the member "gear" or "rack": `gear(...).solid("gear")`, `.section("gear")`, `.sheet()`, `.limits()`, ...
        Questions about a mating gear raise DesignError.

    Raises
    ------
    DesignError
        With key, value and limit in one line, for a gear that cannot exist.

    Examples
    --------
    >>> gear = gm.gear(30, module=1, helix=15, hand="left")
    >>> gear.solid("gear", tolerance="10um").save("gear.stl").name
    'gear.stl'
    """
    keys = gear_keys(
        teeth,
        module=module,
        diametral_pitch=diametral_pitch,
        helix=helix,
        hand=hand,
        face=face,
        bore=bore,
        shift=shift,
        pressure_angle=pressure_angle,
        internal=internal,
        rack=rack,
    )
    return gear_of(keys, settings)


def gear_of(keys: dict[str, Any], settings: Sequence[str] = ()) -> Gears:
    """Build the gears from the keys of a design with `settings`. Raises DesignError as `gear`."""
    from gearmesh.design.files import overridden_keys, override
    from gearmesh.systems.designs import parse_as_stated

    table = next(name for name in MEMBER_TABLES if name in keys)
    for key in overridden_keys(settings):
        member, dot, rest = key.partition(".")
        if member in MEMBER_TABLES and member != table:
            raise DesignError(key, reason=f"there is only one member, {table}; did you mean {table}{dot}{rest}?")
    return build(parse_as_stated(override(keys, settings)).with_changed_keys(overridden_keys(settings)))


def gear_keys(
    teeth: int,
    *,
    module: Length | None = None,
    diametral_pitch: float | None = None,
    helix: float = 0.0,
    hand: str = "right",
    face: Length | None = None,
    bore: Length | None = None,
    shift: float = 0.0,
    pressure_angle: float = 20.0,
    internal: bool = False,
    rack: bool = False,
) -> dict[str, Any]:
    """Return the keys of the design of `gear`. Raises ArgumentError for arguments that exclude each other."""
    sizes = {"module": module, "diametral_pitch": diametral_pitch}
    given = {name: value for name, value in sizes.items() if value is not None}
    if len(given) != 1:
        reason = "cannot be given together with module" if given else "missing; give module or diametral_pitch"
        raise ArgumentError("diametral_pitch" if given else "module", diametral_pitch, reason=reason)
    if rack:
        for name, value in (("internal", internal), ("shift", shift), ("bore", bore)):
            if value:
                raise ArgumentError(name, value, must_be="left out for a rack")
    if module is not None:
        given["module"] = millimetres = in_mm("module", module)
    else:
        millimetres = MM_PER["inch"] / _pitch(diametral_pitch)
    table: dict[str, Any] = {
        "teeth": teeth,
        # a module that is not positive is refused later: give a face width that is not refused before it
        "face_width": FACE_WIDTH_MODULES * (millimetres if millimetres > 0.0 else 1.0)
        if face is None
        else in_mm("face", face),
    }
    if internal:
        table["internal"] = True
    if bore is not None and not rack:
        table["bore"] = in_mm("bore", bore)
    if shift:
        table["profile_shift"] = shift
    keys: dict[str, Any] = {"kind": "rack" if rack else "cylindrical", **given}
    if pressure_angle != 20.0:
        keys["pressure_angle"] = pressure_angle
    if helix or hand != "right":
        keys |= {"helix_angle": helix, "hand": hand}
    return {**keys, "rack" if rack else "gear": table}


def _pitch(diametral_pitch: float | None) -> float:
    """Return the diametral pitch, 1/inch. Raises ArgumentError unless it is a finite number above 0."""
    if not isinstance(diametral_pitch, int | float) or not 0.0 < diametral_pitch < float("inf"):
        raise ArgumentError("diametral_pitch", diametral_pitch, must_be="a number per inch above 0")
    return float(diametral_pitch)
