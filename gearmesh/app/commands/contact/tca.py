"""The command `tca`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from gearmesh.app.options import (
    Csv,
    DesignFile,
    Json,
    Pair,
    Set,
    Speed,
    Timing,
    chosen_pair,
    load_gears,
    option,
    other_meshes,
    refuse_one_stream,
    refuse_torque,
)
from gearmesh.app.terminal import refuse_unwritable, require_contact, show, warn, without_contact, working, write_text
from gearmesh.arguments import refuse_speed
from gearmesh.errors import ArgumentError

if TYPE_CHECKING:
    from gearmesh import Contact, Gears


def tca(
    design_file: DesignFile,
    json_file: Json = None,
    csv_file: Csv = None,
    torque: Annotated[
        float | None,
        option(
            "--torque NM", "Torque on the pinion: adds the Hertz pressure, with all of the torque on one tooth pair."
        ),
    ] = None,
    load_sharing: Annotated[
        bool, option("--load-sharing", "With --torque: use the load share of the tooth pair from loaded contact.")
    ] = False,
    turns: Annotated[
        bool,
        option(
            "--turns",
            "Transmission error of eccentric members over whole turns, until it repeats; --csv then writes this.",
        ),
    ] = False,
    speed: Speed = None,
    ease_off: Annotated[
        str | None, option("--ease-off FILE", "Write the ease-off map of the pinion's flank: .json or .vtu.")
    ] = None,
    pair: Pair = None,
    timing: Timing = True,
    settings: Set = None,
) -> None:
    """Tooth contact: path, transmission error, ellipses."""
    refuse_one_stream(json_file, csv_file)
    refuse_torque(torque)
    refuse_speed(speed)
    if load_sharing and torque is None:
        raise ArgumentError("load_sharing", must_be="left out without --torque, which is shared")
    for file in (json_file, csv_file, ease_off):
        refuse_unwritable(file)

    def ask(gears: Gears) -> Contact:
        return gears.contact(
            torque=torque, load_sharing=load_sharing, pair=chosen_pair(gears, pair), turns=turns, speed=speed
        )

    gears = load_gears(design_file, settings, ask)
    mesh = chosen_pair(gears, pair)
    with working("tooth contact"):
        contact = ask(gears)
    if not contact.stuck:
        require_contact(contact.path)
    write_text(json_file, lambda: contact.json(timing=timing))
    write_text(csv_file, contact.csv)
    if ease_off is not None:
        contact.ease_off().save(ease_off, timing=timing)
    if "-" not in (json_file, csv_file):
        show(contact.listings)
    missing = [] if contact.stuck else without_contact(contact.path)
    warn(contact.warnings, other_meshes(gears, mesh), missing)
    if contact.stuck:
        # what is known of them, as how deep teeth overlap, is written all the same
        require_contact(contact.path)
