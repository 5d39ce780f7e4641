"""Pictures of answers: contact under load, solved finite elements, tool paths, studies."""

from __future__ import annotations

from pathlib import Path

from gearmesh.answers.bodies.finite_elements import FiniteElementSolution
from gearmesh.answers.bodies.toolpath import ToolPathAnswer
from gearmesh.answers.load.loaded import LoadedContact
from gearmesh.errors import ArgumentError
from gearmesh.optimize.optimum import Optimum
from gearmesh.reports.optimum_pictures import optimum_pictures
from gearmesh.reports.study_pictures import study_pictures
from gearmesh.study.study import Study
from gearmesh.view import pictures
from gearmesh.view.load.fe_views import solution_picture
from gearmesh.view.load.loaded_pictures import LoadedPictures
from gearmesh.view.picture import Diagram, Picture
from gearmesh.view.tools.path_scene import path_scene

#: view of a solved finite-element model
STRESS_VIEW = "stress"
#: view of a tool path
TOOL_PATH_VIEW = "toolpath"


def picture_of_answer(
    answer: LoadedContact | FiniteElementSolution | ToolPathAnswer,
    view: str,
    member: str | None,
    torque: float | None,
    size: tuple[int, int] | None,
    dpi: int,
    note: str,
) -> Picture | Diagram:
    """Return the picture of an answer, as `Gears.picture` describes it."""
    if isinstance(answer, LoadedContact):
        return LoadedPictures(answer).picture(view, member, torque=torque, size=size, dpi=dpi, note=note)
    for name, given in (("member", member), ("torque", torque)):
        if given is not None:
            raise ArgumentError(name, given, reason=f"is for pictures of contact under load; leave {name} out")
    if isinstance(answer, ToolPathAnswer):
        if view != TOOL_PATH_VIEW:
            raise ArgumentError("view", view, must_be=f"{TOOL_PATH_VIEW}, for a tool path")
        return Picture(path_scene(answer, size or pictures.PICTURE_SIZE, note))
    if view != STRESS_VIEW:
        raise ArgumentError("view", view, must_be=f"{STRESS_VIEW}, for a solved finite-element model")
    return solution_picture(answer)


def save_pictures(answer: LoadedContact | Study | Optimum, folder: Path) -> tuple[Path, ...]:
    """Write the pictures of an answer and return their files, as `Gears.save_pictures` describes them."""
    if isinstance(answer, Study):
        return tuple(study_pictures(answer, folder))
    if isinstance(answer, Optimum):
        return tuple(optimum_pictures(answer, folder))
    return LoadedPictures(answer).save(folder)
