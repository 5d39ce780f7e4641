"""Result: the common part of all answers, which show themselves in one line, as tables, as columns, and as a file."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Protocol

from gearmesh import __version__
from gearmesh.answers.tables import Listing, align, as_html, json_text, plain
from gearmesh.figures import Content, Figures, Summary, as_rows, figure
from gearmesh.formats import JSON_SUFFIX, refuse_suffix
from gearmesh.pickling import Picklable
from gearmesh.records import dataclass


class Result(Picklable, ABC):
    """An answer about gears.

    - `print(x)` shows its tables, and a notebook shows them as HTML
    - `x.to_dict()` returns columns of equal length, for example for `pandas.DataFrame`
    - `x.document()` returns the content of `x.save("file.json")`
    """

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (JSON_SUFFIX,)

    @property
    @abstractmethod
    def headline(self) -> str:
        """The answer in one line."""

    @property
    def complaints(self) -> list[str]:
        """Faults of the result, one line each."""
        return []

    @property
    @abstractmethod
    def listings(self) -> list[Listing]:
        """The answer as tables."""

    @abstractmethod
    def to_dict(self) -> dict[str, list[Any]]:
        """The answer as columns of equal length, under the keys of the JSON.

        Returns
        -------
        dict of str to list
            A table, for example for `pandas.DataFrame`.

        Examples
        --------
        >>> len({len(column) for column in gears.contact([0.0, 1.0]).to_dict().values()})
        1
        """

    @property
    @abstractmethod
    def sections(self) -> Mapping[str, Content]:
        """Content of the document: figures, and the messages beside them."""

    @property
    def run_time(self) -> RunTime | None:
        """Run time of the answer, if its figures do not contain it."""
        return None

    def document(self) -> dict[str, Any]:
        """The answer as `--json` writes it: only the values under "timing" differ from run to run.

        Returns
        -------
        dict of str to values
            Lists, texts, numbers, truth values and None.

        Examples
        --------
        >>> gears.limits().document()["gearmesh"] == gm.__version__
        True
        """
        kept, times = times_apart(self.sections)
        if self.run_time is not None:
            times |= self.run_time.row
        table: dict[str, Any] = plain({**kept, "timing": times} if times else kept)
        return table

    def json(self, *, timing: bool = True) -> str:
        """The document as JSON text.

        Parameters
        ----------
        timing : bool
            Include run times; without them the text is the same from run to run.

        Returns
        -------
        str
            JSON, in which null stands for NaN and infinities.

        Examples
        --------
        >>> gears.limits().json(timing=False) == gears.limits().json(timing=False)
        True
        """
        document = self.document()
        if not timing:
            document.pop("timing", None)
        return json_text(document)

    def save(self, path: str | PathLike[str], *, timing: bool = True) -> Path:
        """Write the answer to a file, whole or not at all; the suffix is the format.

        Parameters
        ----------
        path : str or os.PathLike
            The file.
        timing : bool
            Include run times in JSON; without them the file is the same from run to run.

        Returns
        -------
        pathlib.Path
            The file.

        Raises
        ------
        OutputError
            If the suffix is not one of `suffixes`, or the file cannot be written.

        Examples
        --------
        >>> gears.limits().save("limits.json").name
        'limits.json'
        """
        target = Path(path)
        refuse_suffix(target, *self.suffixes)
        if target.suffix.lower() == JSON_SUFFIX:
            from gearmesh.io.atomic import whole_text

            whole_text(target, self.json(timing=timing))
        else:
            self._write(target)
        return target

    def _write(self, target: Path) -> None:
        """Write a format other than JSON."""
        raise NotImplementedError

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self.headline}>"

    def __str__(self) -> str:
        return "\n".join(align(listing) for listing in self.listings).rstrip("\n")

    def _repr_html_(self) -> str:
        return as_html(self.listings)

    def __dir__(self) -> list[str]:
        # fields and methods for people only
        return [name for name in super().__dir__() if not name.startswith("_")]


class StatedDesign(Protocol):
    """Design of a gear set, or train of several, that an answer is about."""

    @property
    def title(self) -> str:
        """Title of pages and pictures."""

    def resolve(self) -> dict[str, Any]:
        """Return it as plain tables with every default filled in.

        Returns
        -------
        dict of str to values
            As in its file.

        Examples
        --------
        >>> design.resolve()["pinion"]["teeth"]
        18
        """


def header(design: StatedDesign) -> Mapping[str, Content]:
    """Return the beginning of every document: version and design."""
    return {"gearmesh": __version__, "design": design.resolve()}


@dataclass(frozen=True)
class RunTime(Figures):
    """Run time of an answer."""

    seconds: float = figure("run time", "s", timing=True)


def times_apart(table: Figures | Mapping[str, Content]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return a table without its run times, with figures as rows, and the run times."""
    kept: dict[str, Any] = {}
    times: dict[str, Any] = {}
    for key, value, timed in _entries(table):
        if timed:
            times[key] = value
        elif isinstance(value, Mapping) or (isinstance(value, Figures) and value.known):
            kept[key], within = times_apart(value)
            if within:
                times[key] = within
        elif isinstance(value, list | tuple):
            kept[key] = [_timeless(item) for item in value]
        else:
            kept[key] = as_rows(value)
    return kept, times


def _timeless(value: Content) -> Any:
    return times_apart(value)[0] if isinstance(value, Figures) and value.known else as_rows(value)


def _entries(table: Figures | Mapping[str, Content]) -> Iterator[tuple[str, Any, bool]]:
    """Yield keys and values of a table, and True for run times."""
    if isinstance(table, Figures | Summary):
        yield from ((entry.key, entry.known, entry.figure.timing) for entry in table.entries)
    else:
        yield from ((key, value, False) for key, value in table.items())


def columns(rows: Sequence[Mapping[str, Any]]) -> dict[str, list[Any]]:
    """Return rows as columns; None where a row lacks a key, as a rack has no diameters."""
    return {key: [row.get(key) for row in rows] for key in dict.fromkeys(key for row in rows for key in row)}
