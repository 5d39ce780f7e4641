"""Design files as plain data: reading TOML and JSON, overriding `dotted.key=value`, writing TOML."""

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
from gearmesh.files.reading import (
    BYTES_PER_MIB,
    MAX_TABLE_DEPTH,
    STANDARD_INPUT,
    file_text,
    input_text,
    json_value,
    toml_value,
)
from gearmesh.formats import JSON_SUFFIX

#: largest design file
MAX_FILE_BYTES = BYTES_PER_MIB
#: noun for the file in refusals
FILE_NOUN = "design file"

if TYPE_CHECKING:
    from gearmesh.design.core import Design


def read(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Return the table of a TOML file, or of a JSON file (suffix .json).

    "-" reads standard input, as JSON if the text begins with a brace or bracket. Raises DesignError with file and line.
    """
    text = text_of(path)
    name = STANDARD_INPUT if is_input(path) else path
    is_json = text.lstrip().startswith(("{", "[")) if is_input(path) else Path(path).suffix.lower() == JSON_SUFFIX
    data = (json_value if is_json else toml_value)(text, name)
    if not isinstance(data, dict):
        raise FileError(name, reason=f"a design is a table (an object in JSON), not {value_text(data)}")
    return data


def anchor(data: Mapping[str, Any], table: type[Table], folder: Path) -> dict[str, Any]:
    """Return the data of a table with file names that are relative to a folder made relative to the working folder."""
    return _with_files(data, table, lambda name: str(folder / name))


def text_of(path: str | os.PathLike[str]) -> str:
    """Return the text of a design file or of standard input. Raises DesignError as `read` does."""
    return input_text(MAX_FILE_BYTES, FILE_NOUN) if is_input(path) else file_text(path, MAX_FILE_BYTES, FILE_NOUN)


def is_input(path: str | os.PathLike[str]) -> bool:
    """True if the path is "-", which stands for standard input."""
    return os.fspath(path) == "-"


def override(data: Mapping[str, Any], settings: Sequence[str]) -> dict[str, Any]:
    """Return `data` with each `dotted.key=value` of `settings` put in; a value that is no TOML is a text."""
    result = dict(data)
    for setting in settings:
        dotted, equals, value = setting.partition("=")
        names = [name.strip() for name in dotted.split(".")]
        if not equals or not all(names) or len(names) > MAX_TABLE_DEPTH:
            raise ArgumentError("overrides", entry=value_text(setting), reason="must look like dotted.key=value")
        result = _with(result, names, _value(value.strip()), setting)
    return result


def overridden_keys(settings: Sequence[str]) -> Iterator[str]:
    """Yield the dotted keys of `settings`."""
    for setting in settings:
        yield ".".join(name.strip() for name in setting.partition("=")[0].split("."))


def _with(table: dict[str, Any], names: list[str], value: Any, setting: str) -> dict[str, Any]:
    """Return a table with a value at a path of names. Raises ArgumentError, with the setting, if a key is in the way."""
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
    """Return the TOML value of a text, or the text itself."""
    try:
        parsed = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    # a line break in the text can add keys: then it is no single value
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


#: keys that are better left to their defaults: positions follow the engagement, a small delta is reported
KEYS_LEFT_TO_DEFAULTS = ("contact.phi1.start", "contact.phi1.stop", "contact.delta")


def design_text(design: Design, folder: Path, left_out: Sequence[str] = KEYS_LEFT_TO_DEFAULTS) -> str:
    """Return the text of a design file with the version and all keys, set and derived, to the last digit.

    Keys of `left_out` are omitted if the design leaves them to their defaults. Names of other files become relative to
    `folder`, the folder of the new file.
    """
    return stated_text(every_key(design, left_out), type(design), folder)


def every_key(design: Design, left_out: Sequence[str]) -> dict[str, Any]:
    """Return all keys of a design, set and derived, without the keys of `left_out` that it leaves to their defaults."""
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
    """Return the text of a design file with some keys and the version; names of other files become relative to `folder`."""
    return with_version(counted_from(data, table, folder))


def with_version(data: Mapping[str, Any]) -> str:
    """Return the TOML text of the keys of a design and of the version."""
    first = {key: data[key] for key in ("kind",) if key in data}
    return toml(
        {**first, "gearmesh": __version__, **{key: data[key] for key in data if key not in (*first, "gearmesh")}}
    )


def counted_from(data: Mapping[str, Any], table: type[Table], folder: Path) -> dict[str, Any]:
    """Return the data of a table with file names that are relative to the working folder made relative to `folder`."""
    return _with_files(data, table, lambda name: Path(os.path.relpath(name, folder)).as_posix())


def _with_files(data: Mapping[str, Any], table: type[Table], named: Callable[[str], str]) -> dict[str, Any]:
    """Return the data of a table with its file names changed by `named`."""
    result = dict(data)
    for name in table.model_fields:
        value, key, below = result.get(name), table.key_of(name), table.table_of(name)
        if below is not None and isinstance(value, dict):
            result[name] = _with_files(value, below, named)
        elif key is not None and key.unit == "file" and isinstance(value, str) and value:
            result[name] = named(value)
    return result
