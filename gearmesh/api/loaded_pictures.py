"""Pictures of gears under torque: pressures on a tooth and on the flanks, transmission error, load share, root stress."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.api.picture import LOADED_VIEWS, Diagram, Picture
from gearmesh.errors import DesignError
from gearmesh.loaded.sharing import whole_cycle

if TYPE_CHECKING:
    from gearmesh.api.loaded import LoadedContact


def loaded_picture(
    found: LoadedContact,
    view: str,
    member: str | None,
    torque: float | None,
    size: tuple[int, int] | None,
    dpi: int,
    note: str,
) -> Picture | Diagram:
    """The picture that `LoadedContact.picture` promises."""
    if view not in LOADED_VIEWS:
        raise DesignError(f"view = {view}: must be one of {', '.join(LOADED_VIEWS)}")
    if member is not None and member not in found.pair.members:
        raise DesignError(f"member = {member}: must be one of {', '.join(found.pair.members)}")
    if view == "loaded":
        return _tooth(found, member or found.pair.pinion.name, _numbered(found, torque), size, note)
    if torque is not None:
        raise DesignError(f"torque = {torque:g} Nm: {view} is a figure of all torques; leave torque out")
    return _figure(found, view, member, size, dpi, note)


def save_loaded_pictures(found: LoadedContact, folder: Path, before: str = "") -> tuple[Path, ...]:
    """All of them into a folder, by the names of their views with `before` in front; those on teeth, at the largest torque, only
    where there is OpenGL."""
    from gearmesh.view.opengl import missing_opengl_message

    files = []
    for view in LOADED_VIEWS[1:]:
        files.append(_figure(found, view, None, None, 150, "").save(folder / f"{before}{view}.png"))
    if missing_opengl_message() is None:
        largest = int(found.mesh.torque.argmax())
        for name in found.pair.members:
            drawn = _tooth(found, name, largest, None, "")
            files.append(drawn.save(folder / f"{before}{name}_loaded.png"))
    return tuple(files)


def _numbered(found: LoadedContact, torque: float | None) -> int:
    """Number of the torque (Nm) among those of the contact; without one that of the largest."""
    if torque is None:
        return int(found.mesh.torque.argmax())
    known = 1e-3 * found.mesh.torque
    near = np.flatnonzero(np.isclose(known, torque, rtol=1e-9))
    if not near.size:
        raise DesignError(f"torque = {torque:g} Nm: must be one of {', '.join(f'{each:g}' for each in known)}")
    return int(near[0])


def _title(found: LoadedContact, what: str, note: str) -> str:
    name = found.design.name or found.design.kind
    return f"{name}{f', {note}' if note else ''}: {what}"


def _when(found: LoadedContact) -> str:
    phi1 = found.mesh.phi1
    if whole_cycle(found.pair, phi1):
        return "over a mesh cycle"
    return f"at \u03c6\u2081 = {np.degrees(phi1[0]):.4g}\u00b0" if len(phi1) == 1 else f"over {len(phi1)} positions"


def _tooth(found: LoadedContact, name: str, torque: int, size: tuple[int, int] | None, note: str) -> Picture:
    from gearmesh.view.loaded_diagrams import newton_metres
    from gearmesh.view.loaded_tooth import loaded_scene
    from gearmesh.view.pictures import SIZE, tooth_view

    what = f"{name}, largest pressure {_when(found)}, {newton_metres(float(found.mesh.torque[torque]))}"
    view = replace(tooth_view(found.pair, name), title=_title(found, what, note), size=size or SIZE)
    return Picture(loaded_scene(view, found.pattern, name, torque))


def _figure(
    found: LoadedContact,
    view: str,
    member: str | None,
    size: tuple[int, int] | None,
    dpi: int,
    note: str,
) -> Diagram:
    from gearmesh.view import loaded_diagrams as diagrams

    pair, mesh = found.pair, found.mesh
    if view == "loaded_flank":
        title = _title(found, f"largest pressure {_when(found)}", note)
        names = tuple(pair.members) if member is None else (member,)
        return Diagram(
            title,
            lambda file: diagrams.plot_loaded_flanks(
                file, found.pattern.rows(names), found.pattern.limit, title, size, dpi
            ),
        )
    views: dict[str, tuple[Callable[..., None], str]] = {
        "loaded_te": (
            partial(diagrams.plot_loaded_errors, unloaded=found.unloaded_peak_to_peak),
            "transmission error under load",
        ),
        "loaded_share": (diagrams.plot_load_share, "load share of a tooth pair"),
        "loaded_stress": (diagrams.plot_root_stress, "bending stress under load"),
        "loaded_pair": (diagrams.plot_tooth_pair, "one tooth pair over the cycle of meshing"),
    }
    plot, what = views[view]
    title = _title(found, what, note)
    return Diagram(title, lambda file: plot(file, pair, mesh, title, size, dpi))
