"""Attributes that go work as before for two versions and say so."""

from __future__ import annotations

import inspect

import pytest
from oracles.built import built_sample

import gearmesh as gm
from gearmesh.deprecated import Deprecated


def version(words: str) -> tuple[int, ...]:
    return tuple(map(int, words.split(".")))


#: (class, attribute) of all public classes
GOING = sorted(
    (owner, name)
    for owner in gm.__all__
    if inspect.isclass(getattr(gm, owner))
    for name, value in vars(getattr(gm, owner)).items()
    if isinstance(value, Deprecated)
)


@pytest.mark.parametrize(("owner", "name"), GOING)
def test_what_goes_is_there_until_its_version(owner: str, name: str) -> None:
    """Whoever raises the version to the one in which an attribute goes takes it away."""

    class Stand(getattr(gm, owner)):  # type: ignore[misc]
        def __init__(self) -> None:
            object.__setattr__(self, f"_{name}", 42)

    with pytest.warns(
        DeprecationWarning, match=rf"^{owner}\.{name} is deprecated and goes with version \d+\.\d+\.\d+; \S"
    ) as told:
        assert getattr(Stand(), name) == 42
    (warning,) = told
    assert warning.filename == __file__
    gone = str(warning.message).split("version ")[1].split(";")[0]
    assert version(gm.__version__) < version(gone)


def test_what_went_is_not_there() -> None:
    assert GOING
    assert not hasattr(built_sample("spur").picture("section"), "scene")
