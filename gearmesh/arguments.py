"""Check of the arguments of public calls: an argument of another type than its annotation is refused in one line.

Annotations are read at the first call of a function, not at import. Classes that a module imports for annotations alone are
compared by name, so no call loads a module that it does not need.
"""

from __future__ import annotations

import builtins
import functools
import inspect
import math
import numbers
import os
import sys
import types
import typing
from collections import abc
from collections.abc import Callable, Iterator
from typing import Any, TypeVar

from gearmesh.errors import ArgumentError
from gearmesh.records import dataclass

FunctionT = TypeVar("FunctionT", bound=Callable[..., Any])
ClassT = TypeVar("ClassT", bound=type)

#: characters of a refused value in messages
MAX_SHOWN_CHARACTERS = 60
#: types of values that are never arrays of numbers
NO_ARRAYS = (str, bytes, set, frozenset, dict)
#: units of numeric arguments, for messages
ARGUMENT_UNITS = {"phi1": "deg", "torque": "Nm"}
#: attribute of classes that stand for a name in an annotation
_NAME_ATTRIBUTE = "_stands_for"


def checks_arguments(function: FunctionT) -> FunctionT:
    """Decorate a function: it raises ArgumentError for an argument of another type than its annotation."""
    return checks_arguments_with()(function)


def checks_arguments_with(**remedies: str) -> Callable[[FunctionT], FunctionT]:
    """Return the decorator `checks_arguments` with remedies, by names of arguments, for its messages."""

    def decorate(function: FunctionT) -> FunctionT:
        @functools.wraps(function)
        def call(*arguments: Any, **named: Any) -> Any:
            positional, hints = _signature(function)
            for name, value in (*zip(positional, arguments, strict=False), *named.items()):
                if name in hints:
                    _refuse(name, hints[name], value, remedies.get(name, ""))
            return function(*arguments, **named)

        return typing.cast(FunctionT, call)

    return decorate


def checks_methods(owner: ClassT) -> ClassT:
    """Decorate a class: its public methods check their arguments."""
    for name, method in list(vars(owner).items()):
        if inspect.isfunction(method) and (name == "__init__" or not name.startswith("_")):
            setattr(owner, name, checks_arguments(method))
    return owner


def refuse_speed(speed: float | None) -> None:
    """Raise ArgumentError for a speed that is not a finite number above 0."""
    if speed is not None and not 0.0 < speed < math.inf:
        raise ArgumentError("speed", speed, must_be="a finite number of revolutions per minute above 0")


def _refuse(name: str, hint: Any, value: Any, remedy: str) -> None:
    """Raise ArgumentError for an argument that is not of its type."""
    fault = _fault(hint, value, "")
    if fault is not None:
        words = list(dict.fromkeys(_words(fault.hint)))
        # a path may be a text
        must_be = " or ".join(
            word for word in words if word != _TYPE_WORDS[str] or _TYPE_WORDS["PathLike"] not in words
        )
        if name in ARGUMENT_UNITS:
            must_be = must_be.replace(_TYPE_WORDS["ArrayLike"], f"a number in {ARGUMENT_UNITS[name]}, or several")
        shown = _short_text(fault.value)
        raise ArgumentError(name, fault.value, entry=fault.entry, shown=shown, must_be=must_be, remedy=remedy)


def _short_text(value: Any) -> str:
    """A value in one short line."""
    try:
        text = (
            value if isinstance(value, str) and value.isprintable() and value.strip() else " ".join(repr(value).split())
        )
    except Exception:  # of a class that cannot be shown
        text = f"<{type(value).__name__}>"
    return text if len(text) <= MAX_SHOWN_CHARACTERS else f"{text[: MAX_SHOWN_CHARACTERS - 3]}..."


# ---------------------------------------------------------------- annotations


class _Names(dict[str, Any]):
    """Names in annotations; a name that the module does not have when it runs stands for the class of this name."""

    def __missing__(self, name: str) -> Any:
        if hasattr(builtins, name):
            raise KeyError(name)
        made = self[name] = type(name, (), {_NAME_ATTRIBUTE: name})
        return made


@functools.cache
def _signature(function: Callable[..., Any]) -> tuple[tuple[str, ...], dict[str, Any]]:
    """Names of the positional parameters of a function, and the types of all that have annotations."""
    names = _Names(vars(sys.modules[function.__module__]))
    # these are unions, in which they would not be known again
    names |= {alias: type(alias, (), {_NAME_ATTRIBUTE: alias}) for alias in ("ArrayLike", "Length", "Progress")}
    parameters = inspect.signature(function).parameters.values()
    hints = {}
    for one in parameters:
        if one.annotation is not inspect.Parameter.empty:
            text = one.annotation
            hints[one.name] = eval(text, {}, names) if isinstance(text, str) else text
    kinds = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    return tuple(one.name for one in parameters if one.kind in kinds), hints


# ---------------------------------------------------------------- values


@dataclass(frozen=True)
class _Fault:
    """A value of a wrong type: the argument or a value inside it."""

    #: key of the mapping that holds the value
    entry: str
    #: the value
    value: Any
    #: the type that it should have
    hint: Any


@functools.cache
def _parts(hint: Any) -> tuple[Any, tuple[Any, ...]]:
    """Return a type without its parameters, and the parameters."""
    return typing.get_origin(hint), typing.get_args(hint)


def _fault(hint: Any, value: Any, entry: str) -> _Fault | None:
    """Return the value that is not of a type; None if there is none."""
    if type(value) is hint:
        return None
    origin, parts = _parts(hint)
    if origin in (typing.Union, types.UnionType):
        inner = None
        for part in parts:
            fault = _fault(part, value, entry)
            if fault is None:
                return None
            # the wrong part of a container tells more than the container
            inner = fault if inner is None and fault.value is not value else inner
        return inner or _Fault(entry, value, hint)
    if not _is_a(origin or hint, parts, value):
        return _Fault(entry, value, hint)
    if origin is None:
        return None
    return next((fault for part in _inside(origin, parts, value, entry) if (fault := _fault(*part)) is not None), None)


def _inside(origin: Any, parts: tuple[Any, ...], value: Any, entry: str) -> Iterator[tuple[Any, Any, str]]:
    """Types, values and keys of what a container holds."""
    if origin is abc.Mapping or origin is dict:
        for key, one in value.items():
            yield parts[0], key, entry
            yield parts[1], one, str(key)
    elif origin in (abc.Sequence, list) or (origin is tuple and parts[1:] == (...,)):
        yield from ((parts[0], one, entry) for one in value)
    elif origin is tuple:
        yield from ((part, one, entry) for part, one in zip(parts, value, strict=True))


def _is_a(kind: Any, parts: tuple[Any, ...], value: Any) -> bool:
    """True where a value is of a type, whatever it holds."""
    if kind in (Any, object):
        return True
    if kind is None or kind is types.NoneType:
        return value is None
    if kind is typing.Literal:
        return isinstance(value, str | int) and value in parts
    if kind in (int, float):
        if getattr(value, "ndim", None) == 0 and hasattr(value, "item"):
            value = value.item()
        wanted = numbers.Integral if kind is int else numbers.Real
        return isinstance(value, wanted) and not isinstance(value, bool)
    if kind is bool:
        return isinstance(value, bool) or getattr(getattr(value, "dtype", None), "kind", "") == "b"
    if kind in (abc.Sequence, list, tuple):
        row = isinstance(value, abc.Sequence) and not isinstance(value, str | bytes | bytearray)
        row |= hasattr(value, "dtype")
        # a fixed number of values
        fixed = kind is tuple and parts[1:] != (...,)
        return row and getattr(value, "ndim", 1) == 1 and (not fixed or len(value) == len(parts))
    if kind is dict:
        kind = abc.Mapping
    if kind is abc.Callable:
        return callable(value)
    name = getattr(kind, _NAME_ATTRIBUTE, None)
    if name is not None:
        return _has_name(name, value)
    return isinstance(value, kind)


def _has_name(name: str, value: Any) -> bool:
    """True where a value is of the type that a name in an annotation stands for."""
    if name == "ArrayLike":
        return _is_array(value)
    if name == "Length":
        return isinstance(value, str) or _is_a(float, (), value)
    if name == "Progress":
        return callable(value)
    return any(one.__name__ == name for one in type(value).__mro__)


def _is_array(value: Any) -> bool:
    """True where a value is a real number, or an array of them."""
    if value is None or isinstance(value, NO_ARRAYS):
        return False
    if isinstance(value, range):
        return True
    import numpy as np

    try:
        kind = np.asarray(value).dtype.kind
    except (ValueError, TypeError):  # rows of different lengths
        return False
    return kind in "iuf"


# ---------------------------------------------------------------- words

#: words for a value of a type
_TYPE_WORDS: dict[Any, str] = {
    int: "a whole number",
    float: "a number",
    str: "a text",
    bool: "True or False",
    None: "None",
    types.NoneType: "None",
    "ArrayLike": "a number or an array of real numbers",
    "Length": "a length as 5, 10um or 0.1in",
    "Progress": "a function of a share and a text",
    "PathLike": "a path",
    abc.Callable: "a function",
}
#: words for several values of a type
_PLURAL_WORDS: dict[Any, str] = {int: "whole numbers", float: "numbers", str: "texts", bool: "truth values"}


def _words(hint: Any) -> Iterator[str]:
    """Yield the words for a value of a type, one for each alternative."""
    origin, parts = typing.get_origin(hint), typing.get_args(hint)
    kind = origin or hint
    if origin in (typing.Union, types.UnionType):
        for part in parts:
            yield from _words(part)
    elif kind is typing.Literal:
        yield ", ".join(map(repr, parts))
    elif kind is os.PathLike:
        yield _TYPE_WORDS["PathLike"]
    elif kind in (abc.Mapping, dict):
        yield f"a mapping of {_several(parts[0])} to {_several(parts[1])}" if parts else "a mapping"
    elif kind in (abc.Sequence, list) or (kind is tuple and parts[1:] == (...,)):
        yield f"a sequence of {_several(parts[0])}"
    elif kind is tuple:
        yield f"{len(parts)} {_several(parts[0])}"
    else:
        name = getattr(kind, _NAME_ATTRIBUTE, None)
        yield str(_TYPE_WORDS.get(name or kind) or f"a {name or kind.__name__}")


def _several(hint: Any) -> str:
    """Return the words for several values of a type."""
    if typing.get_origin(hint) in (typing.Union, types.UnionType):
        return " or ".join(dict.fromkeys(_several(part) for part in typing.get_args(hint)))
    if typing.get_origin(hint) is not None:
        return " or ".join(dict.fromkeys(_words(hint))).replace("a sequence", "sequences", 1)
    return str(_PLURAL_WORDS.get(hint) or ("values" if hint is Any else getattr(hint, "__name__", hint)))
