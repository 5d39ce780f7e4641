"""A run makes each thing once: a member is meshed once, a figure is drawn once, and nothing meshed for pictures is thinned."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import RollTest
from gearmesh.answers.contact.sides import whole_path
from gearmesh.answers.sheet import sheet_of
from gearmesh.mesh import tessellate
from gearmesh.view.diagrams import plots
from gearmesh.view.pictures import ToothViews

#: both members have a bore, the gear a hub
SAMPLE = SAMPLES / "helical_hub.toml"


@pytest.fixture
def meshed(monkeypatch: pytest.MonkeyPatch) -> list[tuple[int, bool]]:
    """Teeth that are meshed whole, each as its number of teeth and whether it is thinned."""
    done: list[tuple[int, bool]] = []
    alike = tessellate.tessellate_alike

    def counted(teeth: Any, tolerance: float, regions: Any = None, *, lean: bool = True) -> Any:
        if regions is None:
            done.extend((tooth.teeth, lean) for tooth in teeth)
        return alike(teeth, tolerance, regions, lean=lean)

    monkeypatch.setattr(tessellate, "tessellate_alike", counted)
    return done


@pytest.mark.sweep
def test_a_run_meshes_its_members_once_and_draws_its_plots_once(
    meshed: list[tuple[int, bool]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The page shows the meshes and the plots of the folder, pictures the teeth of the solids.

    The path from first to last contact is solved with the positions of the table, and coast flanks are an image: neither is
    followed again.
    """
    drawn: list[str] = []
    monkeypatch.setattr("gearmesh.view.opengl.missing_opengl_message", lambda: None)
    monkeypatch.setattr("gearmesh.answers.check.roll_test", lambda *_: RollTest([], ()))
    monkeypatch.setattr("gearmesh.answers.contact.staging.SLIDER_POSITIONS", 3)
    for module in ("reports.run", "reports.report"):
        monkeypatch.setattr(f"gearmesh.{module}.render", lambda *_: np.zeros((600, 800, 3), dtype=np.uint8))

    def save(figure: Any, file: Path) -> None:
        drawn.append(file.name)
        file.write_bytes(b"\x89PNG" + file.name.encode())

    for module in ("plots", "flank_diagrams"):
        monkeypatch.setattr(f"gearmesh.view.diagrams.{module}.save_figure", save)
    sheets: list[object] = []
    for module in ("run", "report"):
        monkeypatch.setattr(
            f"gearmesh.reports.{module}.sheet_of", lambda gears: sheets.append(gears) or sheet_of(gears)
        )
    wholes: list[object] = []
    for module in ("contact", "sides"):
        monkeypatch.setattr(
            f"gearmesh.answers.contact.{module}.whole_path",
            lambda pair, engagement: wholes.append(pair) or whole_path(pair, engagement),
        )
    gears = gm.build(gm.load(SAMPLE, ["contact.phi1.count=3"]))
    gears.run(tmp_path, "5um")
    assert sorted(meshed) == sorted((member.tooth.teeth, True) for member in gears.members.values())
    assert sorted(drawn) == ["flank.png", "path_of_contact.png", "transmission_error.png"]
    assert plots.save_figure is save
    assert (len(sheets), len(wholes)) == (1, 0)


def test_a_page_shows_the_teeth_of_its_pictures(meshed: list[tuple[int, bool]]) -> None:
    gears = gm.build(gm.load(SAMPLE, ["contact.phi1.count=3"]))
    gears.report()
    assert sorted(meshed) == sorted((member.tooth.teeth, True) for member in gears.members.values())


def test_teeth_in_pictures_are_not_thinned_and_coarse_solids_not_shown(
    meshed: list[tuple[int, bool]],
) -> None:
    gears = gm.build(gm.load(SAMPLE))
    pair, solid = gears.pairs[0], gears.solid("pinion", 0.1)
    meshed.clear()
    views = ToothViews({"pinion": solid})
    view = views.of(pair, "pinion")
    assert [lean for _, lean in meshed] == [False, False]
    assert views.of(pair, "pinion").fine is view.fine
    assert len(meshed) == 2
    assert len(view.fine.triangles) > len(solid.teeth[0].weld().triangles)
