"""Design files: `load` one, or `parse` a mapping, and get a validated, immutable `Design` with all defaults filled in.

To add a gear system, write a module with a `Design` class and name it in `KINDS`.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

from gearmesh.design import files
from gearmesh.design.core import Design
from gearmesh.design.explain import nearest, shown
from gearmesh.design.files import toml
from gearmesh.design.keys import KeyLine
from gearmesh.errors import DesignError
from gearmesh.systems.beveloid.design import BeveloidDesign
from gearmesh.systems.circular_arc.design import CircularArcDesign
from gearmesh.systems.face_gear.design import FaceGearDesign
from gearmesh.systems.parabolic_helical.design import ModifiedInvoluteDesign, NovikovDesign
from gearmesh.systems.spiral_bevel.conjugate_design import ConjugateDesign
from gearmesh.systems.spiral_bevel.design import SpiralBevelDesign

KINDS: dict[str, type[Design]] = {
    "beveloid": BeveloidDesign,
    "circular_arc": CircularArcDesign,
    "novikov": NovikovDesign,
    "modified_involute": ModifiedInvoluteDesign,
    "spiral_bevel": SpiralBevelDesign,
    "spiral_bevel_conjugate": ConjugateDesign,
    "face_gear": FaceGearDesign,
}

__all__ = ["KINDS", "BeveloidDesign", "CircularArcDesign", "Design", "KeyLine", "kind_of", "load", "parse", "toml"]


def load(path: str | os.PathLike[str], overrides: Sequence[str] = ()) -> Design:
    """The design in a TOML or JSON file, `overrides` ("dotted.key=value") put in before validation.

    Raises DesignError with one line naming file or key, value and what is allowed.
    """
    return parse(files.override(files.read(path), overrides))


def parse(mapping: Mapping[str, Any]) -> Design:
    """The design in a plain mapping. Raises DesignError with one line naming key, value and what is allowed."""
    if "kind" not in mapping:
        raise DesignError(f"kind: missing; must be {_kinds()}")
    return kind_of(mapping["kind"]).from_mapping(mapping)


def kind_of(name: Any) -> type[Design]:
    """The class of a kind of design. Raises DesignError naming the nearest kind."""
    if isinstance(name, str) and name in KINDS:
        return KINDS[name]
    close = nearest(name, KINDS) if isinstance(name, str) else None
    hint = f'; did you mean "{close}"?' if close else ""
    raise DesignError(f"kind = {shown(name)}: must be {_kinds()}{hint}")


def _kinds() -> str:
    return "one of " + ", ".join(f'"{kind}"' for kind in KINDS)
