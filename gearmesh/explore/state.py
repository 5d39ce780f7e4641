"""The state of a page: the keys that are set, and the design that they were opened from."""

from __future__ import annotations

import json
import math
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NoReturn

from gearmesh import samples
from gearmesh.design.core import Design
from gearmesh.design.dotted import leaves, nested, tables_of
from gearmesh.design.files import anchor
from gearmesh.errors import ArgumentError, DesignError
from gearmesh.records import dataclass
from gearmesh.systems.designs import new, parse_as_stated
from gearmesh.systems.system import system

#: name of the design that the program was started with
OPENED_NAME = "opened"
#: first part of the names of the designs of kinds
KIND_PREFIX = "kind:"
#: first part of the names of samples
SAMPLE_PREFIX = "sample:"
#: kind of trains
TRAIN_KIND = "train"
#: table of the stages of a train, and the beginning of their keys
STAGES_NAME = "stages"
#: limit of the keys of a state
MAX_KEYS = 500
#: limit of the characters of a text among the values
MAX_TEXT_CHARACTERS = 500
#: limit of the entries of a list among the values, and of the lists in it
MAX_LIST_ENTRIES = 256
#: names of keys
_KEY_PATTERN = re.compile(r"[A-Za-z][\w-]{0,40}(\.[A-Za-z][\w-]{0,40}){0,7}", re.ASCII)


@dataclass(frozen=True)
class Origin:
    """Design that a page starts from."""

    #: "opened", or a kind or sample as "kind:hypoid"
    name: str
    #: text of its file
    text: str
    #: values of its keys by dotted name; files with their whole path
    keys: Mapping[str, Any]
    #: keys that name files, with the names that stand in the text
    named: Mapping[str, Any]

    @property
    def is_train(self) -> bool:
        """True for a train of several stages."""
        return self.keys.get("kind") == TRAIN_KIND

    @property
    def design(self) -> type[Design]:
        """Class of its designs."""
        return design_class_of(self.keys)

    @property
    def files(self) -> dict[str, Any]:
        """Keys that name files, which a page can neither see nor set."""
        return {key: value for key, value in self.keys.items() if key in self.named}

    @property
    def shown(self) -> dict[str, Any]:
        """Keys that a page sees."""
        return {key: value for key, value in self.keys.items() if key not in self.named}

    @property
    def state(self) -> dict[str, Any]:
        """State of a page that has just opened the design."""
        return {"from": self.name, "keys": self.shown}

    @staticmethod
    def of_text(name: str, text: str, data: Mapping[str, Any], folder: Path) -> Origin:
        """Return the origin of a design file, or of a train: its text, its data, and the folder of the files that it names."""
        if data.get("kind") == TRAIN_KIND:
            return _train_origin(name, text, data, folder)
        stated = dict(leaves(data))
        design = design_class_of(stated)
        names = {key: value for key, value in stated.items() if is_file(design, key)}
        return Origin(name, text, dict(leaves(anchor(data, design, folder.resolve()))), names)

    @staticmethod
    def find(name: str) -> Origin:
        """Return the origin of a kind or a sample. Raises ArgumentError for other names."""
        if name.startswith(KIND_PREFIX):
            text = new(name.removeprefix(KIND_PREFIX), short=True)
            return Origin.of_text(name, text, tomllib.loads(text), Path())
        if name.startswith(SAMPLE_PREFIX):
            sample = name.removeprefix(SAMPLE_PREFIX)
            text = samples.text(sample)
            return Origin.of_text(name, text, tomllib.loads(text), samples.path(sample).parent)
        raise ArgumentError("from", name, must_be=f"{OPENED_NAME}, {KIND_PREFIX}KIND or {SAMPLE_PREFIX}NAME")


def design_class_of(keys: Mapping[str, Any]) -> type[Design]:
    """Return the class of the designs with these dotted keys. Raises DesignError for an unknown kind."""
    return system(keys.get("kind")).of_keys(nested(keys)).design


def is_file(design: type[Design], dotted: str) -> bool:
    """True for a key that names a file."""
    key = design.key_at(dotted)
    return key is not None and key.unit == "file"


def _train_origin(name: str, text: str, data: Mapping[str, Any], folder: Path) -> Origin:
    """Return the origin of a train: the text of its file, its data, and the folder of the files that it names."""
    from gearmesh.trains.file import DESIGN_KEY, train_of

    file, whole = train_of(data, folder), folder.resolve()
    stages = {}
    for stage, table in data[STAGES_NAME].items():
        if DESIGN_KEY in table:
            stages[stage] = {**table, DESIGN_KEY: str(whole / table[DESIGN_KEY])}
        else:
            stages[stage] = anchor(table, type(file.stages[stage]), whole)

    def stays(key: str) -> bool:
        """True for a key that a page does not set: of a shaft, or with the name of a file."""
        stage, rest = stage_key(key)
        if not stage:
            return key.startswith("shafts.")
        return rest == DESIGN_KEY or is_file(type(file.stages[stage]), rest)

    named = {key: value for key, value in leaves(data) if stays(key)}
    return Origin(name, text, dict(leaves({**data, STAGES_NAME: stages})), named)


def stage_key(key: str) -> tuple[str, str]:
    """Return the stage of a key and its name in the design of the stage; "" and the key itself for other keys."""
    table, _, rest = key.partition(".")
    stage, _, own = rest.partition(".")
    return (stage, own) if table == STAGES_NAME and own else ("", key)


def refuse_keys(keys: Any) -> dict[str, Any]:
    """Return the keys of a message of a page. Raises DesignError for anything that is no flat table of plain values."""
    if not isinstance(keys, dict) or len(keys) > MAX_KEYS:
        raise ArgumentError("keys", must_be=f"a table of at most {MAX_KEYS} keys")
    for key, value in keys.items():
        if not _KEY_PATTERN.fullmatch(key):
            raise ArgumentError("keys", entry=json.dumps(key)[:80], must_be="a dotted name of a key")
        if not _is_plain(value, 2):
            raise ArgumentError("keys", entry=key, must_be="a finite number, a text, true, false or a list of them")
    for key in keys:
        if table := next((name for name in tables_of(key) if keys.get(name, {}) != {}), None):
            raise DesignError(table, keys[table], reason=f"a table, in which {key} is set, has no value")
    return keys


def _is_plain(value: Any, depth: int) -> bool:
    if isinstance(value, list):
        return depth > 0 and len(value) <= MAX_LIST_ENTRIES and all(_is_plain(item, depth - 1) for item in value)
    if value == {}:
        return depth == 2
    if isinstance(value, str):
        return len(value) <= MAX_TEXT_CHARACTERS
    return isinstance(value, bool | int) or (isinstance(value, float) and math.isfinite(value))


def refuse_files(design: type[Design], keys: Mapping[str, Any]) -> None:
    """Raise DesignError for a key that names a file: pages have no way to the disk."""
    for key in keys:
        if is_file(design, key):
            refuse_file_key(key)


def refuse_file_key(key: str) -> NoReturn:
    """Raise DesignError for a key that names a file."""
    raise DesignError(key, reason="names a file, which a page cannot choose", remedy="set it in the design file")


def as_stated(keys: Mapping[str, Any], origin: Origin) -> Design:
    """Return the design of the keys of a page, with the files of its origin. Raises DesignError."""
    design = design_class_of(keys)
    refuse_files(design, keys)
    whole = {**keys, **origin.files} if design is origin.design else keys
    return parse_as_stated(nested(whole))
