"""Designs of any gear system, from a file or a mapping."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from gearmesh.arguments import checks_arguments, checks_arguments_with
from gearmesh.design import files
from gearmesh.design.core import Design
from gearmesh.design.template import template
from gearmesh.errors import DesignError
from gearmesh.systems.system import complete_design, design_class, kinds, loaded_kinds, one_of_kinds, system


@checks_arguments_with(path="gm.parse makes a design of a mapping")
def load(path: str | os.PathLike[str], overrides: Sequence[str] = (), *, complete: bool = True) -> Design:
    """Return the design in a TOML or JSON file. Names of other files in it are relative to its own folder.

    Parameters
    ----------
    path : str or os.PathLike
        The file; "-" is standard input.
    overrides : sequence of str
        Keys that are put in before validation, as "pinion.teeth=25".
    complete : bool
        Whether defaults that only geometry knows are filled in now, or left open until gears are built of it.

    Returns
    -------
    Design
        Lengths and angles are in the file's units.

    Raises
    ------
    DesignError
        One line naming file or key, value and what is allowed.

    Examples
    --------
    >>> gm.load("samples/helical.toml", ["pinion.teeth=25"]).pinion.teeth
    25
    """
    data = files.read(path)
    kind = files.override(data, overrides).get("kind")
    # kinds of gearmesh are known without a search of installed packages
    if isinstance(kind, str) and (kind in loaded_kinds() or kind in kinds()):
        data = files.anchor(data, system(kind).of_keys(data).design, Path(path).parent)
    changed = tuple(files.overridden_keys(overrides))
    try:
        design = parse_as_stated(files.override(data, overrides)).with_changed_keys(changed)
    except DesignError as refusal:
        raise refusal.facing(changed) from None
    return complete_design(design) if complete else design


@checks_arguments_with(mapping="gm.load reads files")
def parse(mapping: Mapping[str, Any]) -> Design:
    """Return the design in a plain mapping.

    Parameters
    ----------
    mapping : mapping of str to values
        Keys and tables as in a design file; lengths in its units, or texts with theirs.

    Returns
    -------
    Design
        With the defaults that only geometry knows.

    Raises
    ------
    DesignError
        One line naming key, value and what is allowed.

    Examples
    --------
    >>> tables = {"pinion": {"teeth": 18, "face_width": 10}, "gear": {"teeth": 24, "face_width": 10}}
    >>> gm.parse({"kind": "cylindrical", "module": "2mm", **tables}).gear.teeth
    24
    """
    return complete_design(parse_as_stated(mapping))


def parse_as_stated(mapping: Mapping[str, Any]) -> Design:
    """Return the design as `parse` does, without the defaults that only geometry knows.

    The geometry may be impossible.
    """
    if "kind" not in mapping:
        raise DesignError("kind", reason="missing", must_be=one_of_kinds())
    design: Design = system(mapping["kind"]).of_keys(mapping).design(**mapping)
    return design


@checks_arguments
def new(kind: str, *, short: bool = False) -> str:
    """Return a commented design file of a kind: required keys with initial values, every other key with its default.

    Parameters
    ----------
    kind : str
        One of `kinds`.
    short : bool, optional
        Leave out the keys that few designs set.

    Returns
    -------
    str
        TOML; it loads as it stands.

    Raises
    ------
    DesignError
        For another kind, naming the nearest.

    Examples
    --------
    >>> print(gm.new("hypoid").splitlines()[0])
    # hypoid gears: bevel gears on offset axes, cut by head cutters on a cradle [ISO 23509; AB]
    """
    return template(design_class(kind), short=short)
