"""Registry of formats for finite-element models: each format module registers itself once, under a name.

To add a format, write a module with a writer, `register` it there, and name the module in
`gearmesh/fe/decks/__init__.py`.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from gearmesh.errors import OutputError
from gearmesh.fe.model import Model
from gearmesh.io.atomic import PathLike
from gearmesh.records import dataclass

Writer = Callable[[Model, Path], None]


@dataclass(frozen=True)
class DeckFormat:
    """A format of models. Several formats may share a suffix."""

    #: suffix of the files
    suffix: str
    #: name of the format in words
    description: str
    #: function that writes a whole file or none
    write: Writer
    #: raises OutputError where a package that the format needs is missing
    require: Callable[[Path], None]
    #: True if a file holds the cyclic symmetry of a sector, or has no supports at all
    sectors: bool


#: registered formats, by name
_DECK_FORMATS: dict[str, DeckFormat] = {}


def _needs_nothing(_: Path) -> None:
    """Accept any path: the format needs no package."""


def register(
    name: str,
    suffix: str,
    description: str,
    write: Writer,
    require: Callable[[Path], None] = _needs_nothing,
    *,
    sectors: bool = True,
) -> None:
    """Register a format; the first format with a suffix is the default for this suffix."""
    _DECK_FORMATS[name] = DeckFormat(suffix, description, write, require, sectors)


def formats() -> dict[str, DeckFormat]:
    """Return all registered formats by name ("calculix", ...)."""
    return dict(_DECK_FORMATS)


def format_of(path: PathLike, name: str | None = None) -> DeckFormat:
    """Return the format called `name`, by default the format of the suffix.

    Raises the OutputError of `write_model`, also where a package is missing.
    """
    entry = _by_suffix(path) if name is None else _by_name(name, path)
    entry.require(Path(path))
    return entry


def write_model(model: Model, path: PathLike, name: str | None = None) -> None:
    """Write a model in the format called `name`, by default the format of the suffix of `path`.

    Raises OutputError for an unknown name or suffix, and for a suffix that the named format does not have. It also
    raises OutputError for a model with a set that its mesh does not have, and for a file that cannot be written.
    """
    entry = format_of(path, name)
    _refuse_unknown_sets(model, path)
    entry.write(model, Path(path))


def _by_suffix(path: PathLike) -> DeckFormat:
    suffix = Path(path).suffix.lower()
    for entry in _DECK_FORMATS.values():
        if entry.suffix == suffix:
            return entry
    fault = f"unknown suffix {suffix}" if suffix else "no suffix"
    allowed = ", ".join(sorted({entry.suffix for entry in _DECK_FORMATS.values()}))
    raise OutputError("cannot write", path, reason=f"{fault}; allowed for finite-element models are {allowed}")


def _by_name(name: str, path: PathLike) -> DeckFormat:
    if name not in _DECK_FORMATS:
        raise OutputError(
            "cannot write", path, reason=f"unknown format {name}", allowed=f"one of {', '.join(sorted(_DECK_FORMATS))}"
        )
    entry = _DECK_FORMATS[name]
    if Path(path).suffix.lower() != entry.suffix:
        raise OutputError("cannot write", path, reason=f"the suffix of {name} files is {entry.suffix}")
    return entry


def _refuse_unknown_sets(model: Model, path: PathLike) -> None:
    mesh = model.mesh
    named = [("node set", support.node_set, mesh.node_sets) for support in model.supports]
    named += [("node set", tie.node_set, mesh.node_sets) for tie in model.ties]
    named += [("face set", name, mesh.face_sets) for pair in model.contacts for name in (pair.slave, pair.master)]
    named += [("element set", name, mesh.element_sets) for name in model.materials]
    for kind, name, sets in named:
        if name not in sets:
            raise OutputError(
                "cannot write", path, reason=f"the mesh has no {kind} {name}; it has {', '.join(sets) or 'none'}"
            )
