"""Flank forms of worms. ISO 10828:2015."""

from __future__ import annotations

from enum import StrEnum


class ThreadForm(StrEnum):
    """Flank forms of ISO 10828."""

    ZA = "ZA"
    ZN = "ZN"
    ZI = "ZI"
    ZK = "ZK"
    ZC = "ZC"
