"""Arguments and options that several commands share."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import gearmesh as gm
from gearmesh.app.terminal import working
from gearmesh.errors import ArgumentError
from gearmesh.numerals import parse_number, parse_numbers, parse_whole_number, with_letters, with_point

if TYPE_CHECKING:
    from gearmesh import Design, Gears


def option(names: str, about: str, **more: Any) -> Any:
    """Return an option of a command.

    - names: the names and what follows them, as "-o --output FILE".
    - about: one line of help.
    - more: other arguments of `typer.Option`.
    """
    words = names.split(" ")
    flags = [word for word in words if word.startswith("-")]
    return typer.Option(*flags, metavar=" ".join(words[len(flags) :]) or None, help=about, **more)


def present(path: Path) -> Path:
    """Return the path of a design file that exists. Raises FileError.

    A missing file is refused before missing options, which say what to make of the design.
    """
    from gearmesh.design.files import is_input
    from gearmesh.files.reading import refuse_missing

    if not is_input(path):
        refuse_missing(path)
    return path


DesignFile = Annotated[
    Path,
    typer.Argument(
        metavar="DESIGN",
        help="Design file, TOML or JSON; - is standard input.",
        show_default=False,
        callback=present,
    ),
]
MeasuredFile = Annotated[
    Path | None,
    option(
        "--measured FILE",
        "Deviations or points of its flanks, in the form that the table measured of a design reads. "
        "[default: the files of this table]",
        show_default=False,
    ),
]
MeasuredFlanks = Annotated[
    str, option("--flank right|left|both", "Flanks to use; for a file without a column flank, the flank of its points.")
]
Member = Annotated[str, option("--member NAME", "Which gear.", show_default=False)]
PressureAngle = Annotated[float, option("--pressure-angle DEG", "Normal pressure angle.")]
Set = Annotated[
    list[str] | None, option("--set KEY=VALUE", "Set a key of the design, as pinion.teeth=25; may be repeated.")
]
Tolerance = Annotated[
    str | None,
    option("--tol LEN", "Largest distance between mesh and exact surface: 10um, 0.01mm, 0.0004in; bare = mm."),
]
Curves = Annotated[
    str | None,
    option(
        "--curves splines|arcs|polyline",
        "Curves of flanks and fillets in .dxf and .svg; with arcs and polyline a .dxf has one closed polyline "
        "for every contour. [default: splines]",
    ),
]
Offset = Annotated[
    str | None,
    option(
        "--offset LEN",
        "Move flanks, fillets, lands and roots along their normals; in .dxf and .svg, the contours. Positive, as 0.135mm: away "
        "from the gear's material, for grinding stock or the spark gap of an electrode (--space). Negative: clearance of printed "
        "teeth. End faces and bore stay. Bare = mm. [default: 0]",
    ),
]
Json = Annotated[str | None, option("--json FILE|-", "Write JSON; - is standard output.")]
Csv = Annotated[str | None, option("--csv FILE|-", "Write a table; - is standard output.")]
Timing = Annotated[
    bool, option("--timing/--no-timing", "Run times in the JSON, under the key timing.", show_default=False)
]
Pair = Annotated[
    str | None,
    option(
        "--pair A-B", "Which mesh: the names of its members, as sun-planet_1. [default: the first]", show_default=False
    ),
]

Positions = Annotated[
    str | None,
    option(
        "--phi1 DEG|START:STOP:COUNT", "Rotations of the pinion: one, or COUNT from START to STOP.", show_default=False
    ),
]


SheetTorque = Annotated[
    float | None, option("--torque NM", "Torque on the pinion (planetary: on the driving member): adds the forces.")
]

LoadLevel = Annotated[
    str,
    option(
        "--level full|quick",
        "Model of contact under load; quick is for sweeps, within 3 % in transmission error and load shares.",
    ),
]

Speed = Annotated[
    float | None,
    option("--speed RPM", "Speed of the pinion: velocities in m/s, pressure times velocity.", show_default=False),
]

SheetSpeed = Annotated[
    float | None, option("--speed RPM", "Speed of the member under --torque: adds speeds and power.")
]


Workers = Annotated[int | None, option("--workers N", "Processes. [default: the cores, 1 for small studies]")]
SchedulerAddress = Annotated[
    str | None,
    option(
        "--scheduler ADDRESS",
        "A Dask scheduler, as tcp://host:8786, or tls://host:8786 with the three files below or those of Dask's own "
        "configuration.",
    ),
]
TlsCaFile = Annotated[Path | None, option("--tls-ca-file FILE", "Certificate of the authority, PEM.")]
TlsClientCert = Annotated[Path | None, option("--tls-client-cert FILE", "Certificate of this client, PEM.")]
TlsClientKey = Annotated[Path | None, option("--tls-client-key FILE", "Its private key, PEM.")]


def tls_files(ca_file: Path | None, client_cert: Path | None, client_key: Path | None) -> dict[str, Path] | None:
    """Return the files for TLS, None without any. Raises ArgumentError if some are given, FileError for a missing file."""
    from gearmesh.files.reading import refuse_missing

    files = {"ca_file": ca_file, "client_cert": client_cert, "client_key": client_key}
    given = {name: file for name, file in files.items() if file is not None}
    for name in files if given else ():
        if name not in given:
            raise ArgumentError(f"tls_{name}", reason="missing; TLS needs all three files")
    for file in given.values():
        refuse_missing(file)
    return given or None


def unique_keys(option: str, texts: list[str] | None) -> dict[str, str]:
    """Return the texts behind "KEY=", by keys. Raises ArgumentError for a key that is given twice."""
    from gearmesh.study.plan import key_and_value

    values: dict[str, str] = {}
    for text in texts or ():
        key, rest = key_and_value(option, text)
        if key in values:
            raise ArgumentError(option, entry=key, reason="is given twice")
        values[key] = rest
    return values


def tolerances(option: str, texts: list[str] | None) -> dict[str, str] | str | None:
    """Return distributions by keys, or the name of a file of them; None without any."""
    if not texts:
        return None
    if len(texts) == 1 and "=" not in texts[0]:
        return texts[0]
    return unique_keys(option, [text.replace(":", "=", 1) if text.startswith("class:") else text for text in texts])


def sector_option(about: str) -> Any:
    """Return the option --sector of a command."""
    return option("--sector K", about)


def refuse_torque(torque: float | None) -> None:
    """Raise ArgumentError for a torque that is not a finite number above 0."""
    if torque is not None and not 0.0 < torque < math.inf:
        raise ArgumentError("torque", torque, must_be="a finite number of Nm above 0")


def torques_in_nm(text: str) -> list[float]:
    """Return the torques of --torque, Nm. Raises ArgumentError for other texts."""
    try:
        torques = parse_numbers(text.split(","))
    except ValueError:
        torques = []
    if not torques or not all(0.0 < torque < math.inf for torque in torques):
        remedy = "write bare numbers, in Nm" if any(map(with_letters, text.split(","))) else ""
        must_be = "finite numbers of Nm above 0, one or, with commas, several"
        raise ArgumentError("torque", text, must_be=must_be, remedy=remedy)
    return torques


def refuse_one_stream(json_file: str | None, csv_file: str | None) -> None:
    """Raise ArgumentError if document and table would both go to standard output."""
    if json_file == csv_file == "-":
        raise ArgumentError("csv", "-", reason="--json already uses standard output")


def positions_in_degrees(text: str | None) -> list[float] | None:
    """Return the rotations of --phi1, deg, evenly spaced with both ends, or None without the option.

    Raises ArgumentError for other texts, and for a range whose end is not above its start.
    """
    if text is None:
        return None
    from gearmesh.answers.gearset import MAX_POSITIONS

    start, *more = text.split(":")
    known = [parse_number(end) for end in (start, *more[:1])]
    ends = [end for end in known if end is not None]
    count = (parse_whole_number(more[1]) or 0) if len(more) == 2 else 1
    wrong = len(more) not in (0, 2) or len(ends) < len(known)
    if wrong or (more and not (ends[0] < ends[1] and 2 <= count <= MAX_POSITIONS)):
        raise ArgumentError(
            "phi1",
            text,
            must_be="a finite number of degrees, or START:STOP:COUNT with STOP above START and COUNT from 2 to "
            f"{MAX_POSITIONS}",
            remedy=_positions_remedy(text),
        )
    steps = max(count - 1, 1)
    return [(ends[0] * (steps - k) + ends[-1] * k) / steps for k in range(count)]


def _positions_remedy(text: str) -> str:
    """Return the remedy for positions with commas or with a unit, "" for others."""
    parts = text.split(",")
    if len(parts) > 1 and all(parse_number(part) is not None for part in parts):
        pointed = with_point(text)
        return f"{pointed + ' or ' if pointed else 'write '}{parts[0]}:{parts[-1]}:{len(parts)}"
    return "write a bare number, in deg" if with_letters(text) else ""


def stem(path: Path) -> str:
    """Return the stem of the files made from a design: the stem of its file, or "design" for standard input."""
    return "design" if str(path) == "-" else path.stem


def load_design(path: Path, overrides: list[str] | None, ask: Callable[[Gears], object] | None = None) -> Design:
    """Load the design of the command line and complete it, after `ask` has refused bad arguments."""
    from gearmesh.systems.system import complete_design

    with working("design"):
        design = gm.load(path, overrides or [], complete=False)
        if ask is not None:
            refuse_arguments(design, ask)
        return complete_design(design)


def load_gears(path: Path, overrides: list[str] | None, ask: Callable[[Gears], object]) -> Gears:
    """Load and build the gears of the command line, after `ask` has refused bad arguments."""
    design = load_design(path, overrides, ask)
    with working("gears"):
        return gm.build(design)


def load_alone(path: Path, overrides: list[str] | None, ask: Callable[[Gears], object], member: str) -> Gears:
    """Load the gears of the command line and build a member, with the others only if it needs them."""
    from gearmesh.systems.system import system_of

    with working("gears"):
        design = gm.load(path, overrides or [], complete=False)
        refuse_arguments(design, ask)
        alone = member in system_of(design).members
        gears = gm.build(design, alone=alone)
        if alone:
            gears.part(member)
        return gears


def refuse_arguments(design: Design, ask: Callable[[Gears], object]) -> None:
    """Raise GearmeshError for options that the question `ask` refuses before gears are built."""
    from gearmesh.systems.system import without_building

    with without_building():
        ask(gm.Gears(design))


def design_text(path: Path, overrides: list[str] | None) -> str:
    """Return the text of the design file of the command line, with its comments and the overridden keys."""
    from gearmesh.design.dotted import leaves
    from gearmesh.design.files import override, read, text_of
    from gearmesh.design.rewriting import rewritten

    return rewritten(text_of(path), dict(leaves(override(read(path), overrides)))) if overrides else text_of(path)


def is_train(path: Path) -> bool:
    """Return True for the file of a train; standard input is none."""
    from gearmesh.design.files import read
    from gearmesh.exchange.rexs_file import is_rexs
    from gearmesh.trains.file import TRAIN_KIND

    return str(path) != "-" and not is_rexs(path) and read(path).get("kind") == TRAIN_KIND


def chosen_pair(gears: Gears, names: str | None) -> str:
    """Return the name of the mesh chosen by --pair, by default the first mesh. Raises DesignError for other names."""
    return gears.names.pair_names[gears.names.pair_number(0 if names is None else names)]


def other_meshes(gears: Gears, mesh: str) -> list[str]:
    """Return one line with the other meshes of a gear set, nothing for a pair."""
    others = [pair.name for pair in gears.pairs if pair.name != mesh]
    return [f"the contact is that of {mesh}; --pair has the others: {', '.join(others)}"] if others else []


def meshes_not_loaded(gears: Gears, mesh: str) -> list[str]:
    """Return one line with the meshes that a contact under load leaves out; members that share the torque are all in it."""
    return [] if gears.train.shared else other_meshes(gears, mesh)
