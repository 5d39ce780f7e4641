"""Cutters of internal gears: those that generate involute up to the tip and do not trim it, and what is said of others."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

import gearmesh as gm
from gearmesh.systems.cylindrical.cutting.cutter import cutter_of, root_radius
from gearmesh.systems.cylindrical.cutting.cutter_choice import CutterChoice
from gearmesh.systems.cylindrical.geometry.proportions import proportions

CORPUS = sorted((Path(__file__).parents[1] / "corpus").glob("cutter_*.toml"))


def choice_of(path: Path, *keys: str) -> tuple[CutterChoice, float]:
    design: Any = gm.load(path, list(keys))
    found = proportions(design)
    own = found.mesh.gear
    return CutterChoice(own, root_radius(found.gear("gear")), cutter_of(found.gear("gear"))), found.tips[1]


@pytest.mark.sweep
@pytest.mark.parametrize("path", CORPUS, ids=lambda path: path.stem)
def test_tooth_numbers_are_those_of_every_cutter_tried(path: Path) -> None:
    chosen, tip = choice_of(path)
    both = {}
    for radius in (tip - 0.3, tip - 0.1, tip, tip + 0.2):
        generate = [z for z in chosen.numbers if chosen.involute_from(z) <= radius]
        clear = [z for z in chosen.numbers if chosen.clears(z, radius)]
        assert generate[0] == chosen.generating_from(radius)
        assert clear[-1] == chosen.clearing_up_to(radius)
        both[radius] = set(generate) & set(clear)
    teeth, deepest = chosen.deepest
    least = min(max(chosen.involute_from(z), chosen.untrimmed_from(z)) for z in chosen.numbers)
    assert deepest == pytest.approx(least, abs=1e-12)
    assert max(chosen.involute_from(teeth), chosen.untrimmed_from(teeth)) == deepest
    for radius, sound in both.items():
        assert bool(sound) == (radius >= deepest)


@pytest.mark.parametrize("path", CORPUS, ids=lambda path: path.stem)
def test_what_is_said_of_a_cutter_is_possible(path: Path) -> None:
    """Too few teeth are refused, too many are warned of; the tip diameter and the cutter that are named do neither."""
    free = gm.build(gm.load(path))
    assert not any("trims" in line for line in free.warnings)
    (line,) = (each for each in free.warnings if each.startswith("gear.shaper.teeth"))
    assert re.fullmatch(
        r"gear\.shaper\.teeth = 15: the default, instead of 12, which leave no involute up to the tip", line
    )
    tip = "gear.tip_diameter=69.1"
    with pytest.raises(
        gm.DesignError, match=r"^gear\.shaper\.teeth = 15: .* no involute up to the tip; fewer than 16"
    ) as few:
        gm.build(gm.load(path, [tip, "gear.shaper.teeth=15"]))
    many = gm.build(gm.load(path, [tip, "gear.shaper.teeth=17"])).warnings
    (line,) = (each for each in many if "trims the tips" in each)
    for message in (line, str(few.value)):
        assert "more than 15 trim the tips" in message
        assert 'or gear.manufacture = "formed", which needs no cutter' in message
        ((least, teeth),) = re.findall(
            r"allowed is gear\.tip_diameter of at least ([\d.]+) mm with (\d+) teeth", message
        )
        named = gm.build(gm.load(path, [f"gear.tip_diameter={least}", f"gear.shaper.teeth={teeth}"]))
        assert not any("shaper.teeth" in each for each in named.warnings)
    # with a cutter that is given the addendum that is not gives way
    given = gm.build(gm.load(path, ["gear.shaper.teeth=10"]))
    assert any("its cutter generates involute up to there" in each for each in given.warnings)
