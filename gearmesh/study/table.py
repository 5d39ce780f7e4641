"""Rows of a study as a file: CSV, or Parquet if pyarrow is installed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gearmesh.errors import OutputError
from gearmesh.files import csv_table
from gearmesh.io.atomic import whole_file, whole_text


def csv_text(columns: Mapping[str, list[Any]]) -> str:
    """Return one line per row of the study, empty where there is no value; numbers are read back exactly."""
    return csv_table.csv_text(list(columns), zip(*columns.values(), strict=True))


def write_csv(path: Path, columns: Mapping[str, list[Any]]) -> None:
    whole_text(path, csv_text(columns))


def write_parquet(path: Path, columns: Mapping[str, list[Any]]) -> None:
    """Write the columns as Parquet. Raises OutputError if pyarrow is not installed."""
    pyarrow, parquet = require_pyarrow()
    arrays = {name: pyarrow.array(list(map(_finite, values)), type=_type(values)) for name, values in columns.items()}
    with whole_file(path) as temporary:
        parquet.write_table(pyarrow.table(arrays), temporary)


def require_pyarrow() -> tuple[Any, Any]:
    """Return the modules `pyarrow` and `pyarrow.parquet`. Raises OutputError naming what to install."""
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        raise OutputError(
            "Parquet", reason='pyarrow is not installed: pip install "gearmesh[study]"; CSV needs nothing'
        ) from None
    return pyarrow, parquet


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _type(values: list[Any]) -> Any:
    """Return the Parquet type of a column; a column without any value is a column of numbers."""
    import pyarrow

    kinds = {type(value) for value in values if value is not None}
    if kinds == {bool}:
        return pyarrow.bool_()
    if kinds == {int}:
        return pyarrow.int64()
    return pyarrow.float64() if kinds <= {int, float} else pyarrow.string()
