"""The command `settings`: machine settings that give the requested contact.

Building the gears reports progress. A sheet or a compensation takes less than a second and solves equations in an unknown number of
steps; its bar pulses.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import gearmesh as gm
from gearmesh.app.options import DesignFile, Json, Set, SheetTorque, load_gears, option, refuse_torque
from gearmesh.app.terminal import refuse_unwritable, show, warn, working, write_text
from gearmesh.errors import ArgumentError
from gearmesh.formats import TOML_SUFFIX, refuse_suffix

if TYPE_CHECKING:
    from gearmesh import Gears
    from gearmesh.answers.sheet import Compensation, DesignSheet


def settings(
    design_file: DesignFile,
    output: Annotated[Path | None, option("-o --output NEW.toml", "Write the design with these settings.")] = None,
    compensate: Annotated[
        bool,
        option(
            "--compensate",
            "Compensate the assembly errors of the design: restore path of contact and transmission error.",
        ),
    ] = False,
    refinish: Annotated[
        str | None, option("--refinish MEMBER", "circular_arc: the member whose settings change, pinion or gear.")
    ] = None,
    json_file: Json = None,
    torque: SheetTorque = None,
    settings: Set = None,
) -> None:
    """Machine settings for the requested contact.

    Spiral bevel gears: the settings sheet, or with --compensate the settings that compensate the assembly errors of the
    design. Circular-arc gears: always the compensating settings; they restore pressure_angle at the point of contact, too.
    """
    refuse_torque(torque)
    compensate = compensate or refinish is not None
    if torque is not None and compensate:
        raise ArgumentError("torque", torque, reason="the settings sheet has the forces; leave out --compensate")
    if output is not None:
        refuse_suffix(output, TOML_SUFFIX)
    for file in (output, json_file):
        refuse_unwritable(file)

    def ask(gears: Gears) -> DesignSheet | Compensation:
        own = gm.system(gears.design.kind)
        # refinished gears have only the settings of the compensation
        has_sheet = own.sheet is not None and own.refinish is None and not compensate
        sheet = gears.sheet(torque=torque) if has_sheet or torque is not None else None
        # a sheet without values for keys of the design has no settings: `describe` prints it
        return sheet if sheet is not None and sheet.values else gears.compensate(refinish)

    gears = load_gears(design_file, settings, ask)
    with working("settings"):
        filling = ask(gears)
    if output is not None:
        filling.save(output)
    write_text(json_file, filling.json)
    if json_file != "-":
        show(filling.listings)
    warn(filling.warnings)
