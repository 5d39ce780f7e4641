"""The registry of gear systems, which tests that register a system leave as it was."""

from __future__ import annotations

import pytest

from gearmesh.systems import system


def keep_registry(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let systems that the test registers go with the test."""
    monkeypatch.setattr(system, "_REGISTERED_SYSTEMS", dict(system._REGISTERED_SYSTEMS))
