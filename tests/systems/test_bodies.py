"""Bodies of members as designs ask for them: keyways by the standard."""

from __future__ import annotations

import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.systems.common.parallel_keys import keyway_in_hub
from gearmesh.teeth import Member

#: Ganter, technical information "DIN 6885 keyway, key details", extract page 1: bores, width, depth in the hub, mm
GANTER = (
    ((6, 7, 8), 2, 1.0),
    ((9, 10), 3, 1.4),
    ((11, 12), 4, 1.8),
    ((13, 14, 15, 16, 17), 5, 2.3),
    ((18, 20, 22), 6, 2.8),
    ((24, 25, 26, 28, 30), 8, 3.3),
    ((32, 34, 35, 36, 38), 10, 3.3),
    ((40, 42, 44), 12, 3.3),
)
#: Siemens MD 31.1, 2016, p. 7/3: diameters above, up to, width, d + t2 less d, mm
SIEMENS = (
    (38, 44, 12, 3.3),
    (44, 50, 14, 3.8),
    (50, 58, 16, 4.3),
    (58, 65, 18, 4.4),
    (65, 75, 20, 4.9),
    (75, 85, 22, 5.4),
    (85, 95, 25, 5.4),
    (95, 110, 28, 6.4),
    (110, 130, 32, 7.4),
    (130, 150, 36, 8.4),
    (150, 170, 40, 9.4),
    (170, 200, 45, 10.4),
    (200, 230, 50, 11.4),
)


def pinion(*changes: str) -> Member:
    return gm.build(gm.load(SAMPLES / "spur.toml", list(changes))).members["pinion"]


def test_keyways_are_those_of_the_catalogues() -> None:
    for bores, width, depth in GANTER:
        assert [keyway_in_hub(bore) for bore in bores] == [(width, depth)] * len(bores)
    for above, most, width, depth in SIEMENS:
        assert keyway_in_hub(above + 0.01) == keyway_in_hub(most) == (width, depth)
    assert keyway_in_hub(5.99) is keyway_in_hub(230.01) is None


@pytest.mark.parametrize("keyway", ["{}", '{standard = "DIN 6885"}'])
@pytest.mark.parametrize(("bore", "size"), [("17", (5.0, 2.3)), ("0.67in", (6.0, 2.8))])
def test_a_keyway_without_a_size_goes_by_the_bore(keyway: str, bore: str, size: tuple[float, float]) -> None:
    design = gm.load(SAMPLES / "spur.toml", [f"pinion.bore={bore}", f"pinion.keyway={keyway}"])
    member = gm.build(design).members["pinion"]
    assert member.keyway is not None
    assert (member.keyway.width, member.keyway.depth) == size
    assert design.resolved()["pinion"]["keyway"] == {"standard": "DIN 6885"}
    assert gm.parse(design.resolved()) == design


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            ["pinion.keyway={}", "pinion.bore=5.9"],
            "pinion.keyway.standard = DIN 6885: has no keyway for a bore of 5.9 mm; "
            "allowed is a pinion.bore from 6 to 230 mm, or pinion.keyway.width and depth",
        ),
        (["pinion.keyway={}", "pinion.bore=0"], "pinion.bore = 0 mm: a keyway needs a bore; allowed is more than 0 mm"),
        (
            ["pinion.keyway={}", "pinion.bore=50"],
            "pinion.bore = 50 mm: allowed is at most 46.69 mm, the other keys as they are: "
            "pinion.keyway.depth = 3.8 mm: allowed is less than 2.15 mm (to the root)",
        ),
        (
            ["pinion.keyway={width=3}"],
            "pinion.keyway.width = 3.0: depth is missing; give both, or none for the standard's",
        ),
        (
            ['pinion.keyway={width=3, depth=1, standard="DIN 6885"}'],
            "pinion.keyway.width = 3.0: cannot be given together with standard",
        ),
    ],
)
def test_bodies_that_cannot_be_are_refused(changes: list[str], message: str) -> None:
    with pytest.raises(gm.DesignError) as refused:
        pinion(*changes)
    assert str(refused.value) == message
