"""Worm drives as CAD solids: one assembly of both members for three readers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from oracles.cad_readers import by_freecad, by_gmsh, by_opencascade, needs_freecad
from oracles.examples import some
from oracles.worm_drives import DRIVES, drive

from gearmesh.cad.brep import exact_volume


@pytest.mark.parametrize("name", some(DRIVES, 1))
def test_solids_are_as_large_as_exact_sections_say(name: str) -> None:
    """`cad` refuses what is no valid solid; volumes are by its own quadrature of the faces."""
    gears = drive(name)
    for member in gears.members:
        (figures,) = gears.cad(member).figures.values()
        assert abs(float(figures["volume_error"])) < 1e-6


@pytest.mark.sweep
@pytest.mark.parametrize("reader", ["opencascade", "gmsh", pytest.param("freecad", marks=needs_freecad)])
def test_readers_have_worm_and_wheel_in_their_places(reader: str, tmp_path: Path) -> None:
    gears = drive("ZK oversize")
    file = gears.cad(None).save(tmp_path / "drive.step")
    if reader == "freecad":
        read = by_freecad(file)
        assert read["valid"]
        solids = read["solids"]
    else:
        solids = {"opencascade": by_opencascade, "gmsh": by_gmsh}[reader](file)
    volumes = [exact_volume(member) for member in gears.members.values()]
    # the default quadrature of the readers is the coarser one
    np.testing.assert_allclose([solid[0] for solid in solids], volumes, rtol=1e-6)
    centres = [gears.places[name].translation for name in gears.members]
    np.testing.assert_allclose([solid[1:] for solid in solids], centres, atol=1e-3)
