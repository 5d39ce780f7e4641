"""Members of materials of their own, in every result that asks what they are made of."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from oracles.loaded import few_elements
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.answers.load.members import assumed_densities
from gearmesh.contact.hertz import Material, contact_modulus

PLASTIC = ("gear.material.youngs_modulus=3000", "gear.material.poisson_ratio=0.4", "pinion.material.youngs_modulus=2e5")


@pytest.mark.sweep
def test_each_member_is_of_its_own_material(monkeypatch: pytest.MonkeyPatch) -> None:
    """Hertz on lines goes with the root of E*, a deck has both materials, and under load a gear of plastic turns far more."""
    steel, own = (gm.build(gm.load(SAMPLES / "spur.toml", list(keys))) for keys in ((), PLASTIC))
    ratio = contact_modulus(Material(2e5, 0.3), Material(3000.0, 0.4)) / contact_modulus(Material(), Material())
    peaks = [np.nanmax(gears.contact(torque=50, cycle=False).hertz.peak_pressure) for gears in (steel, own)]
    assert peaks[1] / peaks[0] == pytest.approx(np.sqrt(ratio), rel=1e-6)
    deck = own.finite_elements()._model.materials
    # densities are that of steel unless stated
    assert deck == {"pinion": Material(2e5, 0.3, 7850.0), "gear": Material(3000.0, 0.4, 7850.0)}
    monkeypatch.setattr("gearmesh.loaded.sharing.flank_compliance", few_elements)
    turned = [gears.loaded_contact(2, [0.0]).rows[0].rotation for gears in (steel, own)]
    # the gear gives way 69 times as much as of steel, the pinion a little more
    assert 20.0 < turned[1] / turned[0] < 69.0


@pytest.mark.quick
def test_planets_and_racks_have_theirs() -> None:
    """A planet's is that of all planets; what is not said is that of all."""
    planetary = gm.load(
        SAMPLES / "planetary.toml", ["planet.material.poisson_ratio=0.25", "material.youngs_modulus=1e5"]
    )
    assert planetary.elastic("planet_12") == (1e5, 0.25)
    assert planetary.elastic("ring") == (1e5, 0.3)
    assert gm.load(SAMPLES / "rack.toml", ["rack.material.youngs_modulus=7e4"]).elastic("rack") == (7e4, 0.3)
    with pytest.raises(DesignError, match=r"gear\.material\.poisson_ratio = 0\.7: .*from 0 to 0\.499"):
        gm.load(SAMPLES / "spur.toml", ["gear.material.poisson_ratio=0.7"])


@pytest.mark.sweep
def test_densities_of_members_are_in_sheet_deck_and_rexs_file(tmp_path: Path) -> None:
    """A wheel of aluminium on a pinion of steel: masses as their densities; what is not given is that of all, or of steel."""
    keys = ["gear.material.density=2700", "gear.material.youngs_modulus=7e4"]
    steel, own = (gm.build(gm.load(SAMPLES / "spur.toml", given)) for given in ([], keys))
    assert [own.design.density(name) for name in own.names.members] == [7850.0, 2700.0]
    masses = [
        [sheet.plain_tables[table.title]["m"][1:] for table in sheet.tables if {"m", "rho"} <= {*table.symbols}]
        for sheet in (steel.sheet(), own.sheet())
    ]
    assert len(masses[0]) > 0
    for before, after in zip(*masses, strict=True):
        assert after == pytest.approx([before[0], before[1] * 2700.0 / 7850.0], rel=1e-8)
    # the gear's density is given, so that no note tells that of steel
    assert own.finite_elements()._model.materials["gear"] == Material(7e4, 0.3, 2700.0)
    assert not assumed_densities(own.design, own.names.members)
    assert assumed_densities(gm.load(SAMPLES / "spur.toml", keys[1:]), ["pinion", "gear"])
    own.rexs().save(tmp_path / "pair.rexs")
    read = gm.load_rexs(tmp_path / "pair.rexs").design
    assert (read.density("pinion"), read.given_density("gear")) == (7850.0, 2700.0)
