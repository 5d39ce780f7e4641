"""The command `gear`: one gear, or a rack, from a few options."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from gearmesh.app.options import Curves, Offset, PressureAngle, option
from gearmesh.app.parts import PartFile
from gearmesh.app.terminal import refuse_unwritable, show, warn, write_text
from gearmesh.errors import ArgumentError, GearmeshError
from gearmesh.formats import TOML_SUFFIX

if TYPE_CHECKING:
    from gearmesh import Gears

#: options by the keys of the design that they set; keys of a member without the name of the member
KEY_OPTIONS = {
    "teeth": "--teeth",
    "face_width": "--face",
    "bore": "--bore",
    "profile_shift": "--shift",
    "module": "--module",
    "diametral_pitch": "--diametral-pitch",
    "helix_angle": "--helix",
    "hand": "--hand",
    "pressure_angle": "--pressure-angle",
}


def gear(
    teeth: Annotated[int, option("--teeth Z", "Number of teeth.")],
    module: Annotated[str | None, option("--module LEN", "Normal module; bare = mm.")] = None,
    diametral_pitch: Annotated[
        float | None, option("--diametral-pitch P", "Normal diametral pitch, 1/inch, instead of the module.")
    ] = None,
    helix: Annotated[float, option("--helix DEG", "Helix angle.")] = 0.0,
    hand: Annotated[str, option("--hand right|left", "Hand of the helix.")] = "right",
    face: Annotated[str | None, option("--face LEN", "Face width; bare = mm. [default: 10 modules]")] = None,
    bore: Annotated[
        str | None, option("--bore LEN", "Bore diameter, 0: none. [default: 40 % of the root diameter]")
    ] = None,
    shift: Annotated[float, option("--shift X", "Profile shift coefficient.")] = 0.0,
    pressure_angle: PressureAngle = 20.0,
    internal: Annotated[bool, option("--internal", "An internal gear.")] = False,
    rack: Annotated[bool, option("--rack", "A rack with this number of teeth.")] = False,
    tol: Annotated[str | None, option("--tol LEN", "Largest distance from the exact surface: 10um; bare = mm.")] = None,
    output: Annotated[
        Path | None,
        option(
            "-o --output FILE",
            "Mesh, CAD solid or section; the suffix is the format, as for `solid`; .toml: the design. [default: print the sheet]",
        ),
    ] = None,
    curves: Curves = None,
    offset: Offset = None,
    settings: Annotated[
        list[str] | None,
        option(
            "--set KEY=VALUE",
            "Set any other key of the design, as gear.tip_chamfer=0.2, or rack.height=20 for a rack; may be repeated.",
        ),
    ] = None,
) -> None:
    """One spur or helical gear without a mating gear, or a rack: its solid, its section, its design, or its data sheet."""
    from gearmesh.api.gear import gear_keys

    name = "rack" if rack else "gear"
    is_design = output is not None and output.suffix.lower() == TOML_SUFFIX
    file = None if output is None or is_design else PartFile(output, tol, curves=curves, offset=offset)
    for argument, value in (("tol", tol), ("curves", curves), ("offset", offset)):
        if value is not None and file is None:
            raise ArgumentError(argument, value, reason="needs -o with the file of a mesh, a CAD solid or a section")
    if file is not None:
        file.refuse(name, (TOML_SUFFIX,))
    refuse_unwritable(output)
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
    gears = _gears(name, keys, settings or [])
    if file is not None:
        file.write(gears, name)
    elif output is not None:
        from gearmesh.design.files import override, with_version

        write_text(str(output), lambda: with_version(override(keys, settings or [])))
        warn(gears.warnings)
    else:
        sheet = gears.sheet()
        show(sheet.listings)
        warn(sheet.warnings)


def _gears(name: str, keys: dict[str, Any], settings: list[str]) -> Gears:
    """Build the gears; refusals name the options of the command."""
    from gearmesh.api.gear import gear_of

    try:
        return gear_of(keys, settings)
    except GearmeshError as failure:
        option = KEY_OPTIONS.get(failure.key.removeprefix(f"{name}."))
        if option is None or any(setting.partition("=")[0].strip() == failure.key for setting in settings):
            raise
        raise failure.rename(option) from failure
