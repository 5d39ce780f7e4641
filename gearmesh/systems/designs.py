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
    """The design in a TOML or JSON file, or on standard input if that is "-".

    `overrides` are keys ("dotted.key=value") that are put in before validation.

    Names of other files in it are counted from its own folder. Unless it is to be `complete`, defaults that only geometry knows are
    left open until gears are built of it. Raises DesignError with one line naming file or key, value and what is allowed.
    """
    data = files.read(path)
    kind = files.override(data, overrides).get("kind")
    if isinstance(kind, str) and kind in kinds():
        data = files.anchor(data, system(kind).of_keys(data).design, Path(path).parent)
    design = parse_as_stated(files.override(data, overrides)).with_changed_keys(files.overridden_keys(overrides))
    return complete_design(design) if complete else design


def parse(mapping: Mapping[str, Any]) -> Design:
    """The design in a plain mapping. Raises DesignError with one line naming key, value and what is allowed."""
    return complete_design(parse_as_stated(mapping))


def parse_as_stated(mapping: Mapping[str, Any]) -> Design:
    """As `parse`, without the defaults that only geometry knows: the geometry may be impossible."""
    if "kind" not in mapping:
        raise DesignError("kind", reason="missing", must_be=one_of_kinds())
    design: Design = system(mapping["kind"]).of_keys(mapping).design(**mapping)
    return design


def new(kind: str) -> str:
    """A commented design file of a kind, as text: what it needs with values to begin with, every other key with its default.

    It loads as it stands. Raises DesignError naming the nearest kind.
    """
    return template(design_class(kind))
