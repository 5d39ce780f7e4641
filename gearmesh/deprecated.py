"""Attributes of public classes that go: for two versions they work as before, with a warning (CHANGES.md, "What stays")."""

from __future__ import annotations

import warnings
from typing import Any


class Deprecated:
    """An attribute that goes with version `gone`; until then it is what `now` is. `instead`: what takes its place, in words."""

    def __init__(self, now: str, gone: str, instead: str) -> None:
        self._now, self._gone, self._instead = now, gone, instead
        self._name = now

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = f"{owner.__name__}.{name}"

    def __get__(self, instance: object | None, owner: type) -> Any:
        if instance is None:
            return self
        words = f"{self._name} is deprecated and goes with version {self._gone}; {self._instead}"
        warnings.warn(words, DeprecationWarning, stacklevel=2)
        return getattr(instance, self._now)
