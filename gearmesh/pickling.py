"""Gears and answers as bytes for other processes, including functions within functions.

Surfaces are functions that the code builds from other functions. `pickle` finds functions by their names in a module, which
these do not have. Here such a function is stored as the place of its code in the module and the values of its closure. Both
processes must run the same version of the program.
"""

from __future__ import annotations

import hashlib
import inspect
import io
import pickle
import sys
from collections.abc import Iterator
from importlib import import_module
from types import CellType, CodeType, FunctionType
from typing import Any, ClassVar

import numpy as np

from gearmesh import __version__
from gearmesh.errors import OutputError

#: significant digits of numbers in fingerprints, and size below which numbers are rounding errors
FINGERPRINT_DIGITS = 12
ROUNDING_ERROR = 1e-15
#: part of the qualified name of a function within another
_INNER_NAME = ".<locals>"
#: mark of a closure cell without a value
_EMPTY_CELL = "<empty>"

#: module, name of the outermost function, and path to the inner code by positions among constants
Place = tuple[str, str, tuple[int, ...]]


def as_bytes(value: Any) -> bytes:
    """Return a value as bytes for `from_bytes`."""
    file = io.BytesIO()
    _Pickler(file, pickle.HIGHEST_PROTOCOL).dump(value)
    return file.getvalue()


def from_bytes(version: str, content: bytes) -> Any:
    """Return the value of bytes from a version of the program. Raises OutputError for another version."""
    if version != __version__:
        raise OutputError("pickle", reason=f"made by gearmesh {version}; this is {__version__}, which cannot read it")
    return pickle.loads(content)


def fingerprint(value: Any) -> str:
    """Return a text that is equal for values which differ by the rounding of their numbers alone.

    It must be computed before an object remembers anything of its use.
    """
    file = io.BytesIO()
    _Fingerprinter(file, pickle.HIGHEST_PROTOCOL).dump(value)
    return hashlib.sha256(file.getvalue()).hexdigest()


class Picklable:
    """Base of objects that pickle with all their parts."""

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (type(self), __version__, as_bytes(vars(self)))


def _restore(kind: type, version: str, content: bytes) -> Any:
    made: Any = object.__new__(kind)
    vars(made).update(from_bytes(version, content))
    return made


class _Pickler(pickle.Pickler):
    """Pickler that also pickles functions within functions."""

    def reducer_override(self, value: Any) -> Any:
        return _reduced(value)


def _reduced(value: Any) -> Any:
    """Return how a function within another is pickled; NotImplemented for any other value."""
    if isinstance(value, FunctionType) and _INNER_NAME in value.__qualname__:
        cells = value.__closure__ or ()
        state = (value.__defaults__, value.__kwdefaults__, [_content(cell) for cell in cells])
        return _function, (_place(value), len(cells)), state, None, None, _fill
    return NotImplemented


class _Fingerprinter(pickle._Pickler):
    """Pickler that writes numbers as texts of fewer digits; nothing reads what it writes."""

    dispatch: ClassVar[dict[type, Any]] = dict(pickle._Pickler.dispatch)

    def reducer_override(self, value: Any) -> Any:
        if isinstance(value, np.ndarray) and value.dtype.kind == "f":
            return tuple, ((*value.shape, *map(_few_digits, value.ravel().tolist())),)
        return _reduced(value)

    def _save_number(self: Any, value: float) -> None:
        self.save(_few_digits(value))

    dispatch[float] = _save_number


def _few_digits(value: float) -> str:
    return f"{value:.{FINGERPRINT_DIGITS}g}" if abs(value) >= ROUNDING_ERROR else "0"


def _content(cell: Any) -> Any:
    try:
        return cell.cell_contents
    except ValueError:
        return _EMPTY_CELL


def _function(place: Place, cells: int) -> FunctionType:
    """Return a function without the values of its closure, which may contain the function itself."""
    module, name, path = place
    code = _code_of(module, name)
    for k in path:
        code = code.co_consts[k]
    closure = tuple(CellType() for _ in range(cells))
    return FunctionType(code, vars(sys.modules[module]), code.co_name, None, closure)


def _fill(function: FunctionType, state: tuple[Any, Any, list[Any]]) -> None:
    """Set defaults and closure values of a function."""
    function.__defaults__, function.__kwdefaults__, contents = state
    for cell, content in zip(function.__closure__ or (), contents, strict=True):
        if not (isinstance(content, str) and content == _EMPTY_CELL):
            cell.cell_contents = content


def _place(function: FunctionType) -> Place:
    """Return the place of a function's code."""
    name = function.__qualname__.split(_INNER_NAME)[0]
    outer = _code_of(function.__module__, name)
    for code, path in _codes(outer, ()):
        if code is function.__code__:
            return function.__module__, name, path
    raise pickle.PicklingError(f"{function.__module__}.{function.__qualname__} is not in the code of {name}")


def _codes(code: CodeType, path: tuple[int, ...]) -> Iterator[tuple[CodeType, tuple[int, ...]]]:
    """Yield the codes of all functions within a code, with their paths."""
    for k, constant in enumerate(code.co_consts):
        if isinstance(constant, CodeType):
            yield constant, (*path, k)
            yield from _codes(constant, (*path, k))


def _code_of(module: str, name: str) -> CodeType:
    """Return the code of a function by its name in a module."""
    owner: Any = import_module(module)
    for part in name.split("."):
        owner = inspect.getattr_static(owner, part)
        for inner in ("__func__", "func", "fget"):  # of a class method, a cached property, a property
            owner = getattr(owner, inner, owner)
    code: CodeType = inspect.unwrap(owner).__code__
    return code
