"""One gear, or a rack, in one call: its design from a few figures, and the gears built of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from gearmesh.api.gears import Gears, build
from gearmesh.arguments import checks_arguments
from gearmesh.design.keys import MM_PER
from gearmesh.errors import ArgumentError, DesignError
from gearmesh.lengths import Length, in_mm

#: face width, in normal modules, of a gear whose face width is not given
WIDTH = 10.0
#: tables of members in designs of one gear or of a pair
MEMBERS = ("gear", "rack", "pinion")


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
    """One spur or helical gear without a mating gear, or a rack.

    Parameters
    ----------
    teeth : int
        Number of teeth.
    module, diametral_pitch
        Normal module, mm, or instead normal diametral pitch, 1/inch.
    helix, hand
        Helix angle, deg, and its hand, "right" or "left".
    face
        Face width, mm; 10 modules.
    bore
        Diameter of the bore, mm; 0: none; 40 % of the root diameter.
    shift
        Profile shift coefficient x.
    pressure_angle
        Normal pressure angle, deg.
    internal, rack
        An internal gear; a rack with so many teeth.
    settings
        Any other keys of the design, as of `gm.load`: "gear.tip_chamfer=0.2", of a rack "rack.height=20".

    Returns
    -------
    Gears
        `gear(...).solid("gear")`, `.section("gear")`, `.sheet()`, `.limits()`, ...; a rack is the member "rack". What needs a
        mating gear raises DesignError.

    Raises
    ------
    DesignError
        One line with key, value and what is allowed, of a gear that cannot exist.

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
    """The gears of the keys of a design, with `settings` put in. Raises DesignError as `gear`."""
    from gearmesh.design.files import overridden_keys, override
    from gearmesh.systems.designs import parse_as_stated

    table = next(name for name in MEMBERS if name in keys)
    for key in overridden_keys(settings):
        member, dot, rest = key.partition(".")
        if member in MEMBERS and member != table:
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
    """The keys of the design of `gear`. Raises DesignError for arguments that exclude each other."""
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
        # of a module that will be refused, none that would be refused beside it
        "face_width": WIDTH * (millimetres if millimetres > 0.0 else 1.0) if face is None else in_mm("face", face),
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
    """A diametral pitch. Raises DesignError for one that is none."""
    if not isinstance(diametral_pitch, int | float) or not 0.0 < diametral_pitch < float("inf"):
        raise ArgumentError("diametral_pitch", diametral_pitch, must_be="a number per inch above 0")
    return float(diametral_pitch)
