"""Files are the same on every processor: under other kernels of OpenBLAS and loops of NumPy, whose last digits differ."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__
from oracles.places import ROOT, SAMPLES

from gearmesh.io.digits import curve_on_grid, reals_on_grid, vertices_on_grid
from gearmesh.kernel.numeric.grid import on_grid, significant

#: writes members of a sample within a tolerance: meshes, and sections where there are any
PROGRAM = """
import sys
from gearmesh import DesignError
import gearmesh as gm
sample, tolerance, *members = sys.argv[1:]
gears = gm.build(gm.load(sample))
for name in members or gears.members:
    solid = gears.solid(name, tolerance)
    for suffix in (".stl", ".3mf"):
        solid.save(name + suffix)
    try:
        section = gears.section(name)
    except DesignError:
        continue
    section.save(name + ".dxf")
    section.save(name + ".svg")
"""
#: the same, and CAD files
WITH_STEP = (
    PROGRAM
    + """
for name in members or gears.members:
    gears.cad(name, "1um").save(name + ".step")
"""
)


@pytest.mark.quick
def test_last_digits_are_gone_where_values_are_common() -> None:
    """Multiples of a grid, and the middles, quarters, thirds and eighths between them, are far from its borders."""
    common = np.concatenate([np.arange(-64, 65) / part for part in (1, 2, 3, 4, 8)])
    noise = 1e-3 * np.random.default_rng(5).uniform(-1.0, 1.0, (20, common.size))
    for moved in common + noise:
        np.testing.assert_array_equal(on_grid(moved / 1e3, 1e3), on_grid(common / 1e3, 1e3))
    np.testing.assert_allclose(on_grid(common, 1e7), common, rtol=0.0, atol=0.58e-7)
    assert not np.signbit(on_grid(np.array([-1e-20, -0.0]), 1e7)).any()
    assert [repr(float(x)) for x in vertices_on_grid(np.array([0.1 + 0.2, 12.5, -7.0 / 3.0]))] == [
        "0.3",
        "12.5",
        "-2.3333333",
    ]
    assert float(curve_on_grid(np.array(1.0 / 3.0))) == 0.333333333


@pytest.mark.quick
def test_significant_bits_leave_out_rounding() -> None:
    values = np.array([1.0 / 3.0, -700.0, 1e-9, 0.0])
    moved = values * (1.0 + 1e-12 * np.array([1.0, -1.0, 1.0, 1.0]))
    np.testing.assert_array_equal(significant(moved, 12, 1e-6), significant(values, 12, 1e-6))
    np.testing.assert_allclose(significant(values, 12, 0.0), values, rtol=2.0**-12)
    np.testing.assert_array_equal(significant(values, 12, 1e-6)[2:], 0.0)


@pytest.mark.quick
def test_reals_of_step_files_are_written_as_the_standard_has_them() -> None:
    text = "CARTESIAN_POINT('',(12.,-1.224646799147E-16,8.19317426975E-02))"
    assert reals_on_grid(text, 1e8) == "CARTESIAN_POINT('',(12.,0.,0.08193174))"
    assert reals_on_grid("(1.E-07,-123456.78912345678)", 1e8) == "(1.E-07,-123456.78912346)"


def written(folder: Path, program: str, environment: dict[str, str], *arguments: str) -> dict[str, bytes]:
    """Files (name to bytes) that a program writes into a new folder, in a process of its own."""
    folder.mkdir()
    command = [sys.executable, "-c", program, *arguments]
    subprocess.run(command, cwd=folder, env={**environment, "PYTHONPATH": str(ROOT)}, check=True)
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def oldest_processor() -> dict[str, str]:
    """The environment of a processor without vector instructions beyond SSE3, as far as kernels and loops go."""
    if platform.machine() not in ("x86_64", "AMD64"):
        pytest.skip("other kernels are those of x86-64")
    features = " ".join(name for name in __cpu_dispatch__ if __cpu_features__[name])
    return {**os.environ, "OPENBLAS_CORETYPE": "Prescott", "NPY_DISABLE_CPU_FEATURES": features}


def assert_alike(tmp_path: Path, program: str, *arguments: str) -> None:
    here = written(tmp_path / "here", program, dict(os.environ), *arguments)
    there = written(tmp_path / "there", program, oldest_processor(), *arguments)
    assert here
    assert here.keys() == there.keys()
    assert [name for name in here if here[name] != there[name]] == []


@pytest.mark.sweep
def test_meshes_and_sections_are_the_same_on_every_processor(tmp_path: Path) -> None:
    """The pinion has a flank near undercut, whose triangles differed, and was 27 um off with the same number of them."""
    assert_alike(tmp_path, PROGRAM, str(SAMPLES / "beveloid_crossed.toml"), "20um", "pinion")


@pytest.mark.sweep
@pytest.mark.parametrize(
    "sample", ["double_helical", "face_gear", "helical", "hypoid", "internal", "rack", "spur", "worm_drive", "zerol"]
)
def test_files_of_samples_are_the_same_on_every_processor(sample: str, tmp_path: Path) -> None:
    """Not those of `novikov`: the equations of a worm that plunges are nearly dependent, its control points are known within
    3e-10 mm."""
    assert_alike(tmp_path, WITH_STEP, str(SAMPLES / f"{sample}.toml"), "20um")
