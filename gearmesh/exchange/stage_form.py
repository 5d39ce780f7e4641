"""How a gear system reads and writes its stages in REXS models."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gearmesh.exchange.model import Component
    from gearmesh.exchange.stage import StageReader
    from gearmesh.exchange.stage_writer import StageWriter


@dataclass(frozen=True)
class StageForm:
    """`stages`: types of stages; `read` gives the dotted keys of a design of one, lengths in mm; `write` puts a complete design in
    mm, of whose keys the writer has all leaves, into the stage that is known, or a new one. `is_of`: whether a stage is of this
    system, where several have stages of that type."""

    stages: tuple[str, ...]
    read: Callable[[StageReader], dict[str, Any]]
    write: Callable[[StageWriter, Any, Component | None], Component]
    is_of: Callable[[StageReader], bool] = lambda file: True
