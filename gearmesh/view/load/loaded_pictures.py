"""Pictures of gears under torque: pressure on teeth and flanks, transmission error, load share, root stress."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field, replace
from functools import cached_property, partial
from pathlib import Path

import numpy as np

from gearmesh.answers.load.loaded import LoadedContact
from gearmesh.errors import ArgumentError
from gearmesh.loaded.sharing import whole_cycle
from gearmesh.records import dataclass
from gearmesh.view import opengl
from gearmesh.view.load import loaded_diagrams as diagrams
from gearmesh.view.load.loaded_diagrams import LoadedPattern, newton_metres
from gearmesh.view.load.loaded_tooth import loaded_scene
from gearmesh.view.picture import LOADED_VIEWS, Diagram, Picture, refuse_member
from gearmesh.view.pictures import PICTURE_SIZE, ToothViews


@dataclass(frozen=True)
class LoadedPictures:
    """Pictures of a loaded contact.

    They share the pressures on the flanks, and `teeth` with other pictures of the gears.
    """

    contact: LoadedContact
    teeth: ToothViews = field(default_factory=ToothViews)

    @cached_property
    def pattern(self) -> LoadedPattern:
        """Pressures on the flanks, for all pictures."""
        return LoadedPattern(self.contact.pair, self.contact.mesh)

    def picture(
        self,
        view: str = "loaded_flank",
        member: str | None = None,
        *,
        torque: float | None = None,
        size: tuple[int, int] | None = None,
        dpi: int = 150,
        note: str = "",
    ) -> Picture | Diagram:
        """Return a picture of a view that `Gears.picture` names for a loaded contact; it is drawn when it is saved.

        Raises DesignError for another view, member or torque.
        """
        members = self.contact.pair.members
        if view not in LOADED_VIEWS:
            raise ArgumentError("view", view, must_be=f"one of {', '.join(LOADED_VIEWS)}")
        if member is not None and member not in members:
            raise ArgumentError("member", member, must_be=f"one of {', '.join(members)}")
        if view == "loaded":
            return self._tooth(
                member or self.contact.pair.pinion.name, _torque_number(self.contact, torque), size, note
            )
        if torque is not None:
            raise ArgumentError("torque", torque, unit="Nm", reason=f"{view} shows all torques; leave torque out")
        refuse_member(view, member)
        return self._figure(view, member, size, dpi, note)

    def save(self, folder: Path, before: str = "") -> tuple[Path, ...]:
        """Save all pictures into an existing folder, as PNG files named by `before` and their views.

        Teeth are drawn at the largest torque, only if OpenGL works. Raises OutputError if a file cannot be written.
        """
        files = []
        for view, diagram in self.diagrams().items():
            files.append(diagram.save(folder / f"{before}{view}.png"))
        if opengl.missing_opengl_message() is None:
            largest = int(self.contact.mesh.torque.argmax())
            for name in self.contact.pair.members:
                files.append(self._tooth(name, largest, None, "").save(folder / f"{before}{name}_loaded.png"))
        return tuple(files)

    def diagrams(self, dpi: int = 150, note: str = "") -> dict[str, Diagram]:
        """Return all diagrams, which need no OpenGL, by view; `note` is in their titles."""
        return {view: self._figure(view, None, None, dpi, note) for view in LOADED_VIEWS[1:]}

    def _tooth(self, name: str, torque: int, size: tuple[int, int] | None, note: str) -> Picture:
        contact = self.contact
        what = f"{name}, largest pressure {_when(contact)}, {newton_metres(float(contact.mesh.torque[torque]))}"
        view = replace(self.teeth.of(contact.pair, name), title=_title(contact, what, note), size=size or PICTURE_SIZE)
        return Picture(loaded_scene(view, self.pattern, name, torque))

    def _figure(self, view: str, member: str | None, size: tuple[int, int] | None, dpi: int, note: str) -> Diagram:
        contact = self.contact
        pair, mesh = contact.pair, contact.mesh
        if view == "loaded_flank":
            title = _title(contact, f"largest pressure {_when(contact)}", note)
            names = tuple(pair.members) if member is None else (member,)
            return Diagram(
                title,
                lambda file: diagrams.plot_loaded_flanks(
                    file, self.pattern.rows(names), self.pattern.limit, title, size, dpi
                ),
            )
        views: dict[str, tuple[Callable[..., None], str]] = {
            "loaded_te": (
                partial(diagrams.plot_loaded_errors, unloaded=contact.unloaded_peak_to_peak),
                "transmission error under load",
            ),
            "loaded_share": (diagrams.plot_load_share, "load share of a tooth pair"),
            "loaded_stress": (diagrams.plot_root_stress, "bending stress under load"),
            "loaded_pair": (diagrams.plot_tooth_pair, "one tooth pair over its engagement"),
        }
        plot, what = views[view]
        title = _title(contact, what, note)
        return Diagram(title, lambda file: plot(file, pair, mesh, title, size, dpi))


def _torque_number(contact: LoadedContact, torque: float | None) -> int:
    """Index of the torque (Nm) among the torques of the contact, or of the largest if it is None."""
    if torque is None:
        return int(contact.mesh.torque.argmax())
    known = 1e-3 * contact.mesh.torque
    near = np.flatnonzero(np.isclose(known, torque, rtol=1e-9))
    if not near.size:
        raise ArgumentError("torque", torque, unit="Nm", must_be=f"one of {', '.join(f'{value:g}' for value in known)}")
    return int(near[0])


def _title(contact: LoadedContact, what: str, note: str) -> str:
    name = contact.design.title
    return f"{name}{f', {note}' if note else ''}: {what}"


def _when(contact: LoadedContact) -> str:
    phi1 = contact.mesh.phi1
    if whole_cycle(contact.pair, phi1):
        return "over a mesh cycle"
    return f"at \u03c6\u2081 = {np.degrees(phi1[0]):.4g}\u00b0" if len(phi1) == 1 else f"over {len(phi1)} positions"
