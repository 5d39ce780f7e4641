"""Data classes of gearmesh against those of the standard library."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import pickle
import subprocess
import sys
from typing import ClassVar

import pytest

from gearmesh import records

WAYS = {"standard library": dataclasses.dataclass, "gearmesh": records.dataclass}


def classes(dataclass):
    """A class with every kind of field, one derived from it, a changeable one, and two that write methods themselves."""

    @dataclass(frozen=True)
    class Point:
        """A point."""

        count: ClassVar[int] = 2
        x: float
        y: float = 0.5
        labels: list[str] = dataclasses.field(default_factory=list, compare=False)
        unit: str = dataclasses.field(default="mm", kw_only=True, repr=False)
        norm: float = dataclasses.field(init=False)

        def __post_init__(self) -> None:
            object.__setattr__(self, "norm", abs(self.x) + abs(self.y))

    @dataclass(frozen=True)
    class Weighted(Point):
        """A point with a weight."""

        weight: float = 1.0

    @dataclass
    class Changeable:
        """Values that change."""

        values: list[float] = dataclasses.field(default_factory=lambda: [1.0])
        inner: object = None

    @dataclass(frozen=True, eq=False)
    class Same:
        """Equal to itself only."""

        x: float = 0.0

    @dataclass(frozen=True, repr=False)
    class Written:
        """Methods of its own."""

        x: float = 0.0

        def __repr__(self) -> str:
            return "written"

        def __eq__(self, other: object) -> bool:
            return isinstance(other, Written)

    class Plain(Point):
        """Derived without a decorator."""

    return Point, Weighted, Changeable, Same, Written, Plain


def asked(way):
    """Return the answers of the classes of one way."""
    Point, Weighted, Changeable, Same, Written, Plain = classes(WAYS[way])
    signatures = [str(inspect.signature(kind)) for kind in (Point, Weighted, Changeable, Same, Written, Plain)]
    point, weighted = Point(1.0, labels=["a"]), Weighted(1.0, -2.0, weight=3.0, unit="inch")
    changeable, other = Changeable(), Changeable()
    changeable.values.append(2.0)
    changeable.inner = changeable
    answers = [
        signatures,
        repr(point),
        repr(weighted),
        repr(changeable),
        repr(Written()),
        other.values,
        [field.name for field in dataclasses.fields(Weighted)],
        point == Point(1.0),
        point == Point(1.0, 0.6),
        point == weighted,
        hash(point) == hash(Point(1.0)),
        hash(point),
        len({point, Point(1.0), Point(2.0)}),
        Same() == Same(),
        Written(1.0) == Written(2.0),
        hash(Written(1.0)) == hash(Written(1.0)),
        Changeable.__hash__,
        dataclasses.replace(weighted, x=5.0).norm,
        copy.deepcopy(weighted) == weighted,
        dataclasses.asdict(weighted),
        Point.__match_args__,
        Plain(3.0).norm,
    ]
    for change in (
        lambda: setattr(point, "x", 2.0),
        lambda: setattr(point, "new", 2.0),
        lambda: setattr(weighted, "weight", 2.0),
        lambda: delattr(point, "x"),
        lambda: Point(),
        lambda: Point(1.0, 2.0, [], "mm"),
        lambda: setattr(Plain(1.0), "x", 2.0),
        lambda: hash(changeable),
        lambda: WAYS[way](type("Loose", (Point,), {})),
    ):
        with pytest.raises((AttributeError, TypeError)) as refused:
            change()
        answers.append((refused.type, str(refused.value)))
    plain = Plain(1.0)
    plain.new = 2.0
    return [*answers, plain.new]


def test_same_answers():
    """Signatures, texts, comparison, hashes, copies, defaults and refusals are those of the standard library."""
    assert asked("gearmesh") == asked("standard library")


@pytest.mark.parametrize("base", WAYS)
def test_either_kind_derives_from_the_other(base):
    """A frozen class may derive from a frozen class of the other kind, and no changeable class from a frozen one."""
    derive = next(WAYS[way] for way in WAYS if way != base)
    Point = classes(WAYS[base])[0]

    class Named(Point):
        name: str = "P"

    Named.__annotations__ = {"name": "str"}
    named = derive(frozen=True)(Named)(1.0, name="Q")
    assert (named.x, named.norm, named.name) == (1.0, 1.5, "Q")
    with pytest.raises(dataclasses.FrozenInstanceError):
        named.name = "R"
    with pytest.raises(TypeError, match="non-frozen"):
        derive(type("Loose", (Point,), {}))


@records.dataclass(frozen=True)
class Kept:
    """A value that is pickled before its class has made an instance in the other process."""

    x: float


def test_pickled_before_the_first_instance():
    """An instance that comes from bytes is compared and printed before its class has compiled its __init__."""
    content = pickle.dumps(Kept(2.0))
    program = (
        f"import sys, pickle; sys.path[:0] = {sys.path!r}\n"
        f"k = pickle.loads({content!r}); kind = type(k)\n"
        "print(k == pickle.loads(pickle.dumps(k)), k, type(vars(kind)['__init__']).__name__, kind(2.0) == k)"
    )
    ran = subprocess.run([sys.executable, "-c", program], cwd="tests", capture_output=True, text=True, check=True)
    assert ran.stdout.split() == ["True", "Kept(x=2.0)", "_Later", "True"]
