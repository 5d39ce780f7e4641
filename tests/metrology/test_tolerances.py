"""Tolerances of ISO 1328-1 and ISO 17485 by hand, and the classes that measured gears have."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from fractions import Fraction

import pytest

from gearmesh.metrology.iso1328 import CylindricalSizes
from gearmesh.metrology.iso17485 import BevelSizes
from gearmesh.metrology.tolerances import class_of

SPUR = CylindricalSizes(40, 3.0, 120.0, 30.0)
HELICAL = CylindricalSizes(25, 5.0, 125.0 / math.cos(math.radians(15)), 50.0, math.radians(15))
BEVEL = BevelSizes(20, 100.0, 5.0)


@pytest.mark.quick
def test_tolerances_of_iso_1328() -> None:
    """Tolerances by hand; rounding in its three ranges, halves up; silence beyond the range of the standard."""
    symbols = (*SPUR.names, *SPUR.informative)
    # f_pT 6.32, F_pT 20.365, f_fa 6.65, f_Ha 5.32, F_a 8.516, f_fb 7.232, f_Hb 6.465, F_b 9.700, F_r 18.33
    five = (6.5, 20.0, 6.5, 5.5, 8.5, 7.0, 6.5, 9.5, 18.0)
    assert SPUR.tolerances(5) == dict(zip(symbols, five, strict=True))
    # class 6: 8.938, 28.80, 9.405, 7.524, 12.04, 10.23, 9.142, 13.72, 25.92; class 1: a quarter of class 5
    six = (9.0, 29.0, 9.5, 7.5, 12.0, 10.0, 9.0, 14.0, 26.0)
    assert SPUR.tolerances(6) == dict(zip(symbols, six, strict=True))
    one = (1.6, 5.0, 1.7, 1.3, 2.1, 1.8, 1.6, 2.4, 4.6)
    assert SPUR.tolerances(1) == dict(zip(symbols, one, strict=True))
    # d 129.41: 7.129, 22.016, 7.75, 6.129, 9.881, 7.978, 7.044, 10.642, 19.81
    assert HELICAL.tolerances(5) == dict(zip(symbols, (7.0, 22.0, 8.0, 6.0, 10.0, 8.0, 7.0, 11.0, 20.0), strict=True))
    for beyond in (replace(SPUR, teeth=4), replace(SPUR, module=0.4), replace(SPUR, helix=0.8), replace(SPUR, width=3)):
        assert beyond.tolerances(5) is None
        assert class_of(beyond, {"f_p": 1.0}) is None


@pytest.mark.quick
def test_tolerances_of_iso_17485() -> None:
    """Tolerances, module 5, 100 mm; a factor of sqrt(2) from grade to grade; rounding in its ranges; silence beyond the range."""
    # grade 4: f_pt 6.8, F_p 23, F_r 18.4
    assert BEVEL.tolerances(4) == {"f_ptT": 7.0, "F_pT": 23.0, "F_rT": 18.0}
    # grade 6: twice; grade 2: half; grade 7: 19.23, 65.05, 52.04
    assert BEVEL.tolerances(6) == {"f_ptT": 14.0, "F_pT": 46.0, "F_rT": 37.0}
    assert BEVEL.tolerances(2) == {"f_ptT": 3.4, "F_pT": 12.0, "F_rT": 9.0}
    assert BEVEL.tolerances(7) == {"f_ptT": 19.0, "F_pT": 65.0, "F_rT": 52.0}
    for beyond in ((4, 100.0, 5.0), (401, 100.0, 5.0), (20, 4.9, 5.0), (20, 2501.0, 5.0), (20, 100.0, 0.9)):
        assert BevelSizes(*beyond).tolerances(6) is None


@pytest.mark.quick
def test_a_class_begins_at_its_tolerance() -> None:
    """Every figure and class: a deviation as large as the tolerance is within it, a deviation 0.01 um larger is not."""
    for sizes in (SPUR, HELICAL, BEVEL):
        finest, coarsest = sizes.classes
        for number in range(finest, coarsest + 1):
            for symbol, limit in (sizes.tolerances(number) or {}).items():
                own = symbol[:-1]
                for deviation, expected in ((limit, number), (-limit, number), (limit + 0.01, number + 1)):
                    (figure,) = class_of(sizes, {own: deviation}).figures  # type: ignore[union-attr]
                    assert figure.tolerance_class == (expected if expected <= coarsest else None), (own, number)
                    assert figure.tolerance == (sizes.tolerances(min(expected, coarsest)) or {})[symbol]


@pytest.mark.quick
def test_the_class_of_a_gear_is_its_coarsest_figure() -> None:
    measured = {"f_p": 6.0, "F_p": 15.0, "f_Ha": -8.0, "F_r": 100.0, "f_Hb": 6.6, "thickness": 50.0}
    gear = class_of(SPUR, measured)
    assert gear is not None
    # f_Ha: class 6 allows 7.5, class 7 11; runout is informative
    assert {own.symbol: own.tolerance_class for own in gear.figures} == {
        "f_p": 5, "F_p": 5, "f_Ha": 7, "f_Hb": 6, "F_r": 10
    }  # fmt: skip
    assert (gear.overall, gear.limiting) == (7, ("f_Ha",))
    beyond = class_of(SPUR, {**measured, "F_p": 1000.0})
    assert beyond is not None
    assert (beyond.overall, beyond.limiting) == (None, ("F_p",))


@pytest.mark.quick
def test_halves_are_rounded_up_whatever_the_sum_of_their_parts_is() -> None:
    """Exact fractions beside sums of binary numbers: 3.05 um is 30.499999999999996 tenths (m = 2, class 3)."""
    assert CylindricalSizes(20, 2.0, 40.0, 20.0).tolerances(3)["f_faT"] == 3.1
    halves = 0
    for module, teeth in itertools.product(("1", "1.25", "2", "2.5", "3.75", "5", "6"), range(20, 200, 5)):
        m, d = Fraction(module), Fraction(module) * teeth
        reference = {
            "f_pT": d / 1000 + Fraction("0.4") * m + 5,
            "f_faT": Fraction("0.55") * m + 5,
            "f_HaT": Fraction("0.4") * m + d / 1000 + 4,
        }
        for number in range(1, 12, 2):
            found = CylindricalSizes(teeth, float(module), float(module) * teeth, 20.0).tolerances(number)
            for symbol, value in reference.items():
                exact = value * Fraction(2) ** ((number - 5) // 2)
                step = Fraction(1, 10) if exact < 5 else Fraction(1, 2) if exact <= 10 else Fraction(1)
                halves += (exact / step).denominator == 2
                assert found[symbol] == float(math.floor(exact / step + Fraction(1, 2)) * step), (module, teeth, number)
    assert halves > 100
