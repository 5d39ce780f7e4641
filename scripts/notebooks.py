"""The notebooks of samples/guides, run as Jupyter runs them: each in a folder of its own.

Usage: python scripts/notebooks.py [NAME ...] [--write] [--keep FOLDER]

Needs nbclient and ipykernel. Each cell must print the text that is kept under it, numbers to the printed digits. Its other outputs,
such as pictures, tables and sliders, must be of the kept kinds. `--write` keeps the new outputs, pictures with few colours.
"""

from __future__ import annotations

import base64
import io
from pathlib import Path
from typing import Any

import nbformat
from gallery import painted
from guides import GUIDES, PATIENCE, GuideError, environment, refreshed, run_named
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError

PNG, TWICE = "image/png", "image/jpeg"
#: kinds of outputs that hold for one run alone, as sliders do
PASSING = ("application/vnd.jupyter.widget-view+json",)


def notebooks() -> list[Path]:
    """The files of all notebooks."""
    return sorted(GUIDES.glob("*.ipynb"))


def run(path: Path, folder: Path, *, write: bool = False) -> None:
    """Run a notebook in a folder, and compare its outputs with the kept outputs; with `write`, keep the new outputs instead.

    Raises GuideError.
    """
    kept = nbformat.read(path, as_version=4)
    shown = nbformat.read(path, as_version=4)
    client = NotebookClient(shown, timeout=PATIENCE, resources={"metadata": {"path": str(folder)}})
    try:
        client.execute(env=environment())
    except CellExecutionError as error:
        raise GuideError(f"{path.name}: {error}") from None
    if write:
        nbformat.write(small(shown), path)
        return
    for number, (old, new) in enumerate(zip(kept.cells, shown.cells, strict=True)):
        if kinds(old) != kinds(new):
            raise GuideError(f"{path.name}, cell {number}: shows {kinds(new)}, kept are {kinds(old)}")
        try:
            now = refreshed(printed(old), printed(new))
        except GuideError as error:
            raise GuideError(f"{path.name}, cell {number}: {error}") from None
        if now != printed(old):
            raise GuideError(f"{path.name}, cell {number}: printed {now!r}, kept is {printed(old)!r}")


def outputs(cell: Any) -> list[Any]:
    """Return the outputs of a cell without those on standard error."""
    return [output for output in cell.get("outputs", ()) if output.get("name") != "stderr"]


def printed(cell: Any) -> str:
    """Return the text that a cell prints."""
    return "".join(output.text for output in outputs(cell) if output.output_type == "stream")


def kinds(cell: Any) -> list[str]:
    """Return the kinds of a cell's other outputs that people see, in order."""
    return [
        kind
        for output in outputs(cell)
        for kind in sorted(output.get("data", {}))
        if kind not in ("text/plain", TWICE, *PASSING)
    ]


def small(notebook: Any) -> Any:
    """A notebook to keep: no run times, no state of sliders, pictures with few colours."""
    notebook.metadata.pop("widgets", None)
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)
        if cell.cell_type != "code":
            continue
        cell.outputs = [output for output in outputs(cell) if not set(PASSING) & set(output.get("data", {}))]
        for output in cell.outputs:
            if PNG in output.get("data", {}):
                output.data.pop(TWICE, None)
                output.data[PNG] = fewer_colours(output.data[PNG])
    return notebook


def fewer_colours(encoded: str) -> str:
    """A picture in base64 with the colours of the gallery's."""
    from PIL import Image

    made = io.BytesIO()
    with Image.open(io.BytesIO(base64.b64decode(encoded))) as image:
        painted(image.convert("RGB")).save(made, "png", optimize=True)
    return base64.b64encode(made.getvalue()).decode("ascii")


def main() -> None:
    run_named(__doc__, "notebook", notebooks(), run, lambda path: f"as it shows, {path.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
