"""Designs of any gear system: from a file, from a mapping."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from gearmesh.design import files
from gearmesh.design.core import Design
from gearmesh.design.template import template
from gearmesh.errors import DesignError
from gearmesh.systems.system import complete_design, design_class, kinds, one_of_kinds, system


def load(path: str | os.PathLike[str], overrides: Sequence[str] = (), *, complete: bool = True) -> Design:
    """The design in a TOML or JSON file, or on standard input.

    Parameters
    ----------
    path : str or os.PathLike
        The file; "-" is standard input. Names of other files in it are counted from its own folder.
    overrides : sequence of str
        Keys that are put in before validation, as "pinion.teeth=25".
    complete : bool
        Whether defaults that only geometry knows are filled in; else they are left open until gears are built of it.

    Returns
    -------
    Design
        Of the class of its `kind`.

    Raises
    ------
    DesignError
        One line naming file or key, value and what is allowed.

    Examples
    --------
    >>> design = gm.load("samples/helical.toml", ["pinion.teeth=25"])
    >>> design.pinion.teeth
    25
    """
    data = files.read(path)
    kind = files.override(data, overrides).get("kind")
    if isinstance(kind, str) and kind in kinds():
        data = files.anchor(data, system(kind).of_keys(data).design, Path(path).parent)
    design = parse_as_stated(files.override(data, overrides)).with_changed_keys(files.overridden_keys(overrides))
    return complete_design(design) if complete else design


def parse(mapping: Mapping[str, Any]) -> Design:
    """The design in a plain mapping.

    Parameters
    ----------
    mapping : mapping
        Keys as in a design file, with "kind".

    Returns
    -------
    Design
        Of the class of its `kind`.

    Raises
    ------
    DesignError
        One line naming key, value and what is allowed.

    Examples
    --------
    >>> gear = {"teeth": 30, "face_width": 10}
    >>> gm.parse({"kind": "cylindrical", "module": 1, "pinion": gear, "gear": gear}).kind
    'cylindrical'
    """
    return complete_design(parse_as_stated(mapping))


def parse_as_stated(mapping: Mapping[str, Any]) -> Design:
    """As `parse`, without the defaults that only geometry knows: the geometry may be impossible."""
    if "kind" not in mapping:
        raise DesignError("kind", reason="missing", must_be=one_of_kinds())
    design: Design = system(mapping["kind"]).of_keys(mapping).design(**mapping)
    return design


def new(kind: str) -> str:
    """A commented design file of a kind: what it needs with values to begin with, every other key with its default.

    Parameters
    ----------
    kind : str
        One of `kinds()`.

    Returns
    -------
    str
        TOML text, which loads as it stands.

    Raises
    ------
    DesignError
        Naming the nearest kind.

    Examples
    --------
    >>> text = gm.new("worm_drive")
    """
    return template(design_class(kind))
