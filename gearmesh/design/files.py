"""Design files as plain data: reading TOML and JSON, overrides `dotted.key=value`, writing TOML."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearmesh import __version__
from gearmesh.arguments import checks_arguments
from gearmesh.design.keys import Table
from gearmesh.design.shown import value_text
from gearmesh.errors import ArgumentError, FileError
from gearmesh.files.reading import DEEPEST, INPUT, MIB, file_text, input_text, json_value, toml_value

#: largest design file, bytes
LARGEST = MIB
WANTED = "design file"

if TYPE_CHECKING:
    from gearmesh.design.core import Design


def read(path: str | os.PathLike[str]) -> dict[str, Any]:
    """The table in a TOML file, or in a JSON file if its name ends so.

    Of "-" that on standard input, JSON if it begins with a brace. Raises DesignError naming file and line.
    """
    text = text_of(path)
    name = INPUT if is_input(path) else path
    is_json = text.lstrip().startswith(("{", "[")) if is_input(path) else Path(path).suffix.lower() == ".json"
    data = (json_value if is_json else toml_value)(text, name)
    if not isinstance(data, dict):
        raise FileError(name, reason=f"a design is a table (an object in JSON), not {value_text(data)}")
    return data


def anchor(data: Mapping[str, Any], table: type[Table], folder: Path) -> dict[str, Any]:
    """`data` of a table with the names of files in it counted from a folder."""
    return _with_files(data, table, lambda name: str(folder / name))


def text_of(path: str | os.PathLike[str]) -> str:
    """A design file, or what is on standard input, as it stands. Raises DesignError as `read`."""
    return input_text(LARGEST, WANTED) if is_input(path) else file_text(path, LARGEST, WANTED)


def is_input(path: str | os.PathLike[str]) -> bool:
    """Whether "-" stands for standard input instead of a file."""
    return os.fspath(path) == "-"


def override(data: Mapping[str, Any], settings: Sequence[str]) -> dict[str, Any]:
    """`data` with each `dotted.key=value` of `settings` put in; the value is read as TOML, or else taken as text."""
    result = dict(data)
    for setting in settings:
        dotted, equals, value = setting.partition("=")
        names = [name.strip() for name in dotted.split(".")]
        if not equals or not all(names) or len(names) > DEEPEST:
            raise ArgumentError("overrides", entry=value_text(setting), reason="must look like dotted.key=value")
        result = _with(result, names, _value(value.strip()), setting)
    return result


def overridden_keys(settings: Sequence[str]) -> Iterator[str]:
    """The dotted keys of `settings`."""
    for setting in settings:
        yield ".".join(name.strip() for name in setting.partition("=")[0].split("."))


def _with(table: dict[str, Any], names: list[str], value: Any, setting: str) -> dict[str, Any]:
    first, *rest = names
    if not rest:
        return {**table, first: value}
    below = table.get(first, {})
    if not isinstance(below, dict):
        raise ArgumentError(
            "overrides",
            entry=value_text(setting),
            reason=f"{first} = {value_text(below)} is not a table; no key can be set in it",
        )
    return {**table, first: _with(below, rest, value, setting)}


def _value(text: str) -> Any:
    try:
        parsed = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    # more than one key: the text held a line break and was not one value
    return parsed["value"] if len(parsed) == 1 else text


@checks_arguments
def toml(data: Mapping[str, Any]) -> str:
    """The TOML text of a plain table.

    Parameters
    ----------
    data : mapping of str to values
        Tables, lists, texts, numbers and truth values.

    Returns
    -------
    str
        Text that reads back to the same table.

    Examples
    --------
    >>> print(gm.toml({"module": 2.0}), end="")
    module = 2.0
    """
    import tomli_w

    return tomli_w.dumps(data)


#: keys whose defaults do more than give a value: positions follow the engagement, a small delta is reported
BETTER_LEFT_OUT = ("contact.phi1.start", "contact.phi1.stop", "contact.delta")


def design_text(design: Design, folder: Path, left_out: Sequence[str] = BETTER_LEFT_OUT) -> str:
    """The file of a design: every key that it has or that is derived, to the last digit, and the version.

    Keys of `left_out` that the design leaves to their defaults stay so. Names of other files are counted from `folder`, where the
    file is to be.
    """
    return stated_text(every_key(design, left_out), type(design), folder)


def every_key(design: Design, left_out: Sequence[str]) -> dict[str, Any]:
    """Every key that a design has or that is derived, but those of `left_out` that it leaves to their defaults."""
    plain = design.plain()
    for dotted in left_out:
        *names, key = dotted.split(".")
        table = plain
        for name in names:
            table = table.get(name, {})
        if not design.sets(dotted):
            table.pop(key, None)
    return plain


def stated_text(data: Mapping[str, Any], table: type[Table], folder: Path) -> str:
    """The file of some keys of a design, and the version; names of other files are counted from `folder`."""
    return with_version(counted_from(data, table, folder))


def with_version(data: Mapping[str, Any]) -> str:
    """The TOML text of the keys of a design, which state the version."""
    first = {key: data[key] for key in ("kind",) if key in data}
    return toml(
        {**first, "gearmesh": __version__, **{key: data[key] for key in data if key not in (*first, "gearmesh")}}
    )


def counted_from(data: Mapping[str, Any], table: type[Table], folder: Path) -> dict[str, Any]:
    """`data` of a table with the names of files in it, counted from the working folder, counted from `folder`."""
    return _with_files(data, table, lambda name: Path(os.path.relpath(name, folder)).as_posix())


def _with_files(data: Mapping[str, Any], table: type[Table], named: Callable[[str], str]) -> dict[str, Any]:
    """`data` of a table with other names of the files in it."""
    result = dict(data)
    for name in table.model_fields:
        value, key, below = result.get(name), table.key_of(name), table.table_of(name)
        if below is not None and isinstance(value, dict):
            result[name] = _with_files(value, below, named)
        elif key is not None and key.unit == "file" and isinstance(value, str) and value:
            result[name] = named(value)
    return result
