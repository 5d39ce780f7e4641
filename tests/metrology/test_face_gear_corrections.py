"""Settings of the machine that makes face gears: what they do to the flanks by other designs, that the worm grinds what the shaper
does with them, and that one that was off comes back from the deviations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.measuring import along_normals, flanks_cut_once
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import Correction, Design, GearmeshError
from gearmesh.answers.inspection.correction import correct_settings, residual_text
from gearmesh.kinds import Side, Tooth
from gearmesh.systems import system as systems
from gearmesh.systems.face_gear.build import middle, shaped_gear

SECONDS = 20.0 / 3600.0
CHANGES = {
    "shaft_angle": SECONDS,
    "offset": 0.005,
    "axial_position": 0.005,
    "pressure_angle": SECONDS,
    "thickness": 0.005,
    "worm_angle": SECONDS,
}
#: farther from the limiting line than the sample, where the flank follows the worm's angle linearly, and from pointed teeth
RADII = ("gear.inner_radius=490", "gear.outer_radius=550")
GROUND = ('gear.machine.tool="worm"', *RADII)


@pytest.fixture(scope="module", autouse=True)
def _cut_once() -> Iterator[None]:
    with flanks_cut_once():
        yield


@lru_cache(maxsize=4)
def design_of(*keys: str, sample: str = "face_gear") -> Design:
    """With every setting stated."""
    design = gm.load(SAMPLES / f"{sample}.toml", list(keys))
    return systems.pin(design, systems.build(design))


def gear(design: Design, values: Mapping[str, Any] | None = None) -> Tooth:
    """Gear tooth of a design with changes of machine settings."""
    before = design.plain()["gear"]["machine"]
    changes = {f"gear.machine.{key}": before[key] + change for key, change in (values or {}).items()}
    return systems.build(design.with_values(changes)).members["gear"].one_tooth


def corrected(path: Path, design: Design, off: Mapping[str, float], noise: float = 0.0, **options: Any) -> Correction:
    """Correction from both flanks of a gear that was made with settings `off`; `noise`: standard deviation, mm, of the
    measurement."""
    nominal, made, random = gear(design), gear(design, off), np.random.default_rng(7)
    grids = {side: along_normals(made, side, nominal) for side in Side}
    noisy = {
        side: replace(grid, values=grid.values + noise * random.normal(size=grid.values.shape))
        for side, grid in grids.items()
    }
    path.write_text(residual_text(noisy))
    return correct_settings(design, "gear", path, **options)


@pytest.mark.parametrize(
    ("key", "change", "other"),
    [
        ("shaft_angle", 0.1, "shaft_angle=90.1"),
        ("offset", 0.3, "offset=80.3"),
        ("pressure_angle", 0.2, "pressure_angle=25.2"),
        ("axial_position", 0.04, None),
    ],
)
@pytest.mark.sweep_cases(
    "offset-0.3-offset=80.3", "pressure_angle-0.2-pressure_angle=25.2", "shaft_angle-0.1-shaft_angle=90.1"
)
def test_a_setting_makes_the_flank_of_another_pair(key: str, change: float, other: str | None) -> None:
    """A changed setting makes the flank of a pair with those axes or that pressure angle. A changed axial position makes the
    same flank, displaced along the axis."""
    sample = "face_gear_offset" if key == "offset" else "face_gear"
    base = design_of(*RADII, sample=sample)
    designs = base, base if other is None else design_of(*RADII, other, sample=sample)
    teeth = gear(base, {key: change}), gear(designs[1])
    along = np.array([0.0, 0.0, 0.0 if other else change])
    theta, z = (values.ravel() for values in np.meshgrid(np.linspace(0.3, 0.6, 5), np.linspace(495.0, 540.0, 5)))
    for side in Side:
        # the second parameter counts along the shaper's axis from the middle of the face
        r = [
            tooth.side(side).flank.jet(theta, z - middle(design, shaped_gear(design))).r
            for tooth, design in zip(teeth, designs, strict=True)
        ]
        turned = np.arctan2(*np.moveaxis(r[0][..., 1::-1], -1, 0)) - np.arctan2(*np.moveaxis(r[1][..., 1::-1], -1, 0))
        # of teeth that are centred elsewhere, they differ by a turn
        c, s = np.cos(turned.mean()), np.sin(turned.mean())
        back = np.stack([c * r[1][:, 0] - s * r[1][:, 1], s * r[1][:, 0] + c * r[1][:, 1], r[1][:, 2]], axis=-1)
        assert np.ptp(turned) < 1e-12
        np.testing.assert_allclose(r[0], back + along, atol=1e-9)


@pytest.mark.sweep
@pytest.mark.parametrize("off", [{"offset": 0.2}, {"axial_position": 0.05, "shaft_angle": 0.02, "thickness": 0.02}])
def test_the_worm_grinds_what_the_shaper_does(off: dict[str, float]) -> None:
    """Flank and fillet, with the same settings; its own angle moves them."""
    shaped, ground = (gear(design_of(*keys), off) for keys in (GROUND[1:], GROUND))
    swivelled = gear(design_of(*GROUND), {**off, "worm_angle": 0.02})
    for side in Side:
        grid = along_normals(ground, side, shaped)
        assert np.abs(grid.values).max() < 1e-8
        assert np.abs(along_normals(swivelled, side, shaped).values).max() > 1e-5
        q = np.linspace(*(shaped.side(side).form_point[1], shaped.side(side).root), 5)
        fillets = [tooth.side(side).fillet for tooth in (shaped, ground)]
        z = np.linspace(-20.0, 20.0, 5)
        at = fillets[1].jet(q, z)
        # the same point of the shaper's rounding, in the section through the point
        feed = z + fillets[1].generation(q, z).v  # type: ignore[attr-defined]
        np.testing.assert_allclose(fillets[0].jet(q, feed).r, at.r, atol=1e-8)


@pytest.mark.sweep
@pytest.mark.parametrize(
    "key", [*list(CHANGES)[:1], *(pytest.param(k, marks=pytest.mark.sweep) for k in list(CHANGES)[1:5])]
)
def test_a_setting_of_the_shaper_that_was_off_comes_back(key: str, tmp_path: Path) -> None:
    """All settings are free."""
    made = corrected(tmp_path / "gear.csv", design_of(), {key: CHANGES[key]})
    changes = {s.name: change for s, change in zip(made.settings, made.solution.changes, strict=True)}
    assert list(changes) == list(CHANGES)[:5]
    assert changes[key] == pytest.approx(-CHANGES[key], rel=0.01)
    assert max(np.abs(left.values).max() for left in made.residual.values()) < 5e-5


@pytest.mark.sweep
def test_a_setting_of_the_worm_that_was_off_comes_back(tmp_path: Path) -> None:
    """Its own angle does little, and not in proportion; what it does is taken away all the same."""
    design, path = design_of(*GROUND), tmp_path / "gear.csv"
    off = {"axial_position": 0.005, "shaft_angle": SECONDS}
    made = corrected(path, design, off)
    changes = {s.name: change for s, change in zip(made.settings, made.solution.changes, strict=True)}
    assert list(changes) == list(CHANGES)[:5]
    for key, change in off.items():
        assert changes[key] == pytest.approx(-change, rel=0.01)
    assert max(np.abs(left.values).max() for left in made.residual.values()) < 5e-5
    made = corrected(path, design, {"worm_angle": SECONDS}, settings=list(CHANGES))
    for side, left in made.residual.items():
        assert np.abs(made._flanks.grids[side].values).max() > 1e-5
        assert np.abs(left.values).max() < 1e-8


@pytest.mark.sweep
def test_noise_moves_settings_by_what_is_stated(tmp_path: Path) -> None:
    """Settings change by the opposite of their errors, within three times the stated uncertainties. What the corrected machine
    cuts is off by the opposite of what was measured, but for the noise. A correction from one flank leaves the thickness alone."""
    design, off = design_of(*RADII), {"shaft_angle": 0.02, "axial_position": 0.05}
    made = corrected(tmp_path / "gear.csv", design, off, noise=5e-4)
    assert made.solution.noise == pytest.approx(5e-4, rel=0.2)
    cut = gear(made.new_design)
    for side, left in made.residual.items():
        moved = along_normals(cut, side, gear(design)).values
        assert np.sqrt(np.mean((moved + made._flanks.grids[side].values) ** 2)) < 6e-4
        assert np.sqrt(np.mean(left.values**2)) < 6e-4
    named = corrected(tmp_path / "gear.csv", design, off, noise=5e-4, settings=list(off))
    for setting, change, spread in zip(
        named.settings, named.solution.changes, named.solution.uncertainties, strict=True
    ):
        assert abs(change + off[setting.name]) < 3.0 * spread < 0.3 * off[setting.name]
    one = correct_settings(design, "gear", tmp_path / "gear.csv", "right")
    assert "thickness" not in {setting.name for setting in one.settings}


@pytest.mark.sweep
def test_other_settings_are_refused(tmp_path: Path) -> None:
    design, file = design_of(), tmp_path / "gear.csv"
    file.write_text(residual_text({side: along_normals(gear(design), side, gear(design), (2, 3)) for side in Side}))
    for settings, word in ((["radial"], "shaft_angle, offset"), (["worm_angle"], "does not move")):
        with pytest.raises(GearmeshError, match=word):
            correct_settings(design, "gear", file, settings=settings)
    with pytest.raises(GearmeshError, match=r"gear\.machine\.shaft_angle = 97.* 85 to 95"):
        gm.load(SAMPLES / "face_gear.toml", ["gear.machine.shaft_angle=97"])
