"""Pictures of answers: contact under load, solved finite elements, tool paths, studies."""

from __future__ import annotations

from pathlib import Path

from gearmesh.answers.bodies.finite_elements import FiniteElementSolution
from gearmesh.answers.bodies.toolpath import ToolPathAnswer
from gearmesh.answers.load.loaded import LoadedContact
from gearmesh.errors import ArgumentError
from gearmesh.reports.study_pictures import study_pictures
from gearmesh.study.study import Study
from gearmesh.view import pictures
from gearmesh.view.load.fe_views import solution_picture
from gearmesh.view.load.loaded_pictures import LoadedPictures
from gearmesh.view.picture import Diagram, Picture
from gearmesh.view.tools.path_scene import path_scene

#: what a picture of a solved model of finite elements shows
STRESS = "stress"
#: what a picture of a tool path shows
TOOL_PATH = "toolpath"


def picture_of_answer(
    answer: LoadedContact | FiniteElementSolution | ToolPathAnswer,
    view: str,
    member: str | None,
    torque: float | None,
    size: tuple[int, int] | None,
    dpi: int,
    note: str,
) -> Picture | Diagram:
    """The picture that `Gears.picture` promises of an answer."""
    if isinstance(answer, LoadedContact):
        return LoadedPictures(answer).picture(view, member, torque=torque, size=size, dpi=dpi, note=note)
    if isinstance(answer, ToolPathAnswer):
        if view != TOOL_PATH:
            raise ArgumentError("view", view, must_be=f"{TOOL_PATH}, for a tool path")
        return Picture(path_scene(answer, size or pictures.PICTURE_SIZE, note))
    if view != STRESS:
        raise ArgumentError("view", view, must_be=f"{STRESS}, for a solved finite-element model")
    return solution_picture(answer)


def save_pictures(answer: LoadedContact | Study, folder: Path) -> tuple[Path, ...]:
    """The files that `Gears.save_pictures` promises."""
    if isinstance(answer, Study):
        return tuple(study_pictures(answer, folder))
    return LoadedPictures(answer).save(folder)
