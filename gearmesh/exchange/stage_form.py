"""Functions with which a gear system reads and writes its stages in REXS models."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from gearmesh.records import dataclass

if TYPE_CHECKING:
    from gearmesh.exchange.model import Component
    from gearmesh.exchange.stage import StageReader
    from gearmesh.exchange.stage_writer import StageWriter


@dataclass(frozen=True)
class StageForm:
    """Reading and writing of the stages of one gear system."""

    #: types of stages
    stages: tuple[str, ...]
    #: returns the dotted keys of a design from a stage, lengths in mm
    read: Callable[[StageReader], dict[str, Any]]
    #: writes a complete design in mm into the known stage, or a new one; the writer has all leaves of its keys
    write: Callable[[StageWriter, Any, Component | None], Component]
    #: True if a stage belongs to this system, where several systems have stages of that type
    is_of: Callable[[StageReader], bool] = lambda file: True
