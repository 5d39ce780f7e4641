"""Design files as plain data: reading TOML and JSON, overrides `dotted.key=value`, writing TOML."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from gearmesh.design.explain import shown
from gearmesh.design.keys import Table
from gearmesh.errors import DesignError, FileError
from gearmesh.files.reading import DEEPEST, MIB, file_text, read_json, read_toml

#: largest design file, bytes
LARGEST = MIB
WANTED = "design file"


def read(path: str | os.PathLike[str]) -> dict[str, Any]:
    """The table in a TOML file, or in a JSON file if its name ends so. Raises DesignError naming file and line."""
    data = (read_json if Path(path).suffix.lower() == ".json" else read_toml)(path, LARGEST, WANTED)
    if not isinstance(data, dict):
        raise FileError(f"{path}: a design is a table (an object in JSON), not {shown(data)}")
    return data


def anchored(data: Mapping[str, Any], table: type[Table], folder: Path) -> dict[str, Any]:
    """`data` of a table with the names of files in it counted from a folder."""
    result = dict(data)
    for name in table.model_fields:
        value, key, below = result.get(name), table.key_of(name), table.table_of(name)
        if below is not None and isinstance(value, dict):
            result[name] = anchored(value, below, folder)
        elif key is not None and key.unit == "file" and isinstance(value, str) and value:
            result[name] = str(folder / value)
    return result


def text_of(path: str | os.PathLike[str]) -> str:
    """A design file as it stands. Raises DesignError as `read`."""
    return file_text(path, LARGEST, WANTED)


def override(data: Mapping[str, Any], settings: Sequence[str]) -> dict[str, Any]:
    """`data` with each `dotted.key=value` of `settings` put in; the value is read as TOML, or else taken as text."""
    result = dict(data)
    for setting in settings:
        dotted, equals, value = setting.partition("=")
        names = [name.strip() for name in dotted.split(".")]
        if not equals or not all(names) or len(names) > DEEPEST:
            raise DesignError(f"--set {shown(setting)}: must look like dotted.key=value")
        result = _with(result, names, _value(value.strip()), setting)
    return result


def overridden(settings: Sequence[str]) -> Iterator[str]:
    """The dotted keys of `settings`."""
    for setting in settings:
        yield ".".join(name.strip() for name in setting.partition("=")[0].split("."))


def _with(table: dict[str, Any], names: list[str], value: Any, setting: str) -> dict[str, Any]:
    first, *rest = names
    if not rest:
        return {**table, first: value}
    below = table.get(first, {})
    if not isinstance(below, dict):
        raise DesignError(f"--set {shown(setting)}: {first} = {shown(below)} is not a table, nothing can be set in it")
    return {**table, first: _with(below, rest, value, setting)}


def _value(text: str) -> Any:
    try:
        parsed = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    # more than one key: the text held a line break and was not one value
    return parsed["value"] if len(parsed) == 1 else text


def toml(data: Mapping[str, Any]) -> str:
    """The TOML text of a plain table."""
    import tomli_w

    return tomli_w.dumps(data)
