"""Keys of worm drives: each one changes the gears or the sheet, or is refused by name where nothing would be done with it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles.worm_drives import FORMS

import gearmesh as gm
from gearmesh import WormDriveDesign
from gearmesh.design.dotted import with_keys
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.systems.designs import parse_as_stated
from gearmesh.systems.worm_drive.design import HobTable, WheelTable, WormDriveAssembly, WormTable

BASE: dict[str, Any] = {"kind": "worm_drive", "module": 4, "worm": {"threads": 2}, "wheel": {"teeth": 40}}
#: another value of each key that a kind of its own has
OTHERS: dict[str, Any] = {
    "module_section": "normal",
    "pressure_angle": 22,
    "shaft_angle": 87,
    "center_distance": 101,
    "backlash_share": 0.3,
    "friction": 0.05,
    "worm.threads": 3,
    "worm.form": "",
    "worm.right_hand": False,
    "worm.reference_diameter": 42,
    "worm.quotient": 11,
    "worm.lead_angle": 12,
    "worm.section": "thread",
    "worm.length": 40,
    "worm.run_out": 10,
    "worm.addendum": 0.9,
    "worm.dedendum": 1.15,
    "worm.root_rounding": 0.1,
    "worm.thickness": 1.5,
    "worm.dual_lead": 0.01,
    "worm.disk_diameter": 200,
    "worm.profile_radius": 30,
    "worm.wire_diameter": 6.9,
    "wheel.form": "helical",
    "wheel.face_width": 20,
    "wheel.profile_shift": 0.6,
    "wheel.addendum": 0.9,
    "wheel.tip_form": "cylindrical",
    "wheel.throat_angle": 30,
    "wheel.throat_radius": 18,
    "wheel.outside_diameter": 176,
    "hob.reference_diameter": 44,
    "hob.threads": 3,
    "hob.addendum": 1.15,
    "hob.tip_radius": 0.1,
    "hob.pitch_height": 0.3,
    "hob.center_distance": 103.1,
    "hob.swivel_angle": 0.5,
    "hob.feed": "radial",
    "assembly.da": 0.1,
    "assembly.dz1": 0.1,
    "assembly.dz2": 0.1,
    "assembly.d_sigma": 0.1,
}
#: what a key needs to have a say
NEEDS = {
    "backlash_share": {"backlash": 0.1},
    "wheel.throat_angle": {"wheel.tip_form": "chamfered"},
    "hob.pitch_height": {"hob.reference_diameter": 44},
}
#: keys of which the sheet alone has something
SHEET = ("friction", "worm.wire_diameter", "hob.feed")
#: keys that a flank form or a form of the wheel does not have, and one of both that has them
LACKING = {
    "worm.section": ("ZN", ("ZI", "ZA", "ZK", "ZC")),
    "worm.disk_diameter": ("ZC", ("ZI", "ZA", "ZN")),
    "worm.profile_radius": ("ZC", ("ZI", "ZA", "ZN", "ZK")),
    "wheel.form": ("ZI", ("ZA", "ZN", "ZK", "ZC")),
}


def gears_of(keys: dict[str, Any]) -> gm.Gears:
    return gm.build(gm.parse(with_keys(BASE, keys.items())))


def traces(gears: gm.Gears, key: str) -> Array:
    """Numbers that tell gears from others: points of all links, volumes, mountings."""
    numbers: list[Array] = []
    if key in SHEET:
        rows = [row for table in gears.sheet().tables[-7:] for row in table.rows]
        return np.frombuffer(repr(rows).encode(), dtype=np.uint8).astype(float)
    for member in gears.members.values():
        tooth, places = member.tooth, np.linspace(0.0, 1.0, 4)
        sections = tooth.sections(places)
        numbers += [np.array([tooth.volume(6)])]
        numbers += [tooth.grid(region, places, sections).points.ravel() for region in tooth.regions]
    for mount in gears.pairs[0].mounts:
        numbers += [mount.base.rotation.ravel(), mount.base.translation, np.array([mount.zero])]
    return np.concatenate(numbers)


def test_every_key_of_the_kind_is_in_the_list() -> None:
    own = {key for key in WormDriveDesign.names() if WormDriveDesign.table_of(key) is None}
    shared = {key for key in gm.CylindricalDesign.names() if gm.CylindricalDesign.table_of(key) is None}
    keys = own - shared | {"shaft_angle", "center_distance", "pressure_angle"} - {"kind"} & own
    for name, table in (
        ("worm", WormTable),
        ("wheel", WheelTable),
        ("hob", HobTable),
        ("assembly", WormDriveAssembly),
    ):
        declared = {*table.__annotations__} & {*table.model_fields} | ({"threads"} if name == "worm" else set())
        keys |= {f"{name}.{key}" for key in declared if table.table_of(key) is None and table.key_of(key) is not None}
    eccentric = {key for key in keys if key.endswith(("_eccentricity", "_phase"))}
    assert keys - eccentric == set(OTHERS)


@pytest.mark.sweep
@pytest.mark.parametrize("form", FORMS)
def test_every_key_has_an_effect_or_is_refused(form: str) -> None:
    usual: dict[str, Array] = {}
    for key, value in OTHERS.items():
        lacking = form in LACKING.get(key, ("", ()))[1]
        base = {"worm.form": form, **NEEDS.get(key, {})}
        if key == "worm.form":
            value = FORMS[(FORMS.index(form) + 1) % len(FORMS)]
        if lacking:
            with pytest.raises(gm.DesignError, match=rf"^{key} = .* worm\.form is {form}"):
                gears_of({**base, key: value})
            continue
        what = f"{base} {key in SHEET}"
        if what not in usual:
            usual[what] = traces(gears_of(base), key)
        other = traces(gears_of({**base, key: value}), key)
        same = other.shape == usual[what].shape and np.allclose(other, usual[what], rtol=1e-9, atol=1e-9)
        assert not same, key


@pytest.mark.parametrize(("key", "forms"), [(key, forms) for key, (_, forms) in LACKING.items() if key != "wheel.form"])
@pytest.mark.sweep_cases("worm.disk_diameter-forms1", "worm.section-forms0")
def test_keys_of_another_form_are_refused_unless_they_are_its_defaults(key: str, forms: tuple[str, ...]) -> None:
    """Designs that state every key carry keys of other forms, at their defaults. These are accepted; other values are refused."""
    default = {"worm.section": "space", "worm.disk_diameter": 320.0, "worm.profile_radius": 24.0}[key]
    for form in forms:
        keys = with_keys(BASE, {"worm.form": form, key: default}.items())
        assert gm.parse(keys).sets(key)
        with pytest.raises(gm.DesignError, match=rf"^{key} = .*: nothing is done with it where worm\.form is {form}"):
            gm.parse(with_keys(keys, [(key, OTHERS[key])]))
    assert gm.parse(with_keys(BASE, {"worm.form": LACKING[key][0], key: OTHERS[key]}.items())).sets(key)


@pytest.mark.sweep
def test_a_throat_radius_is_refused_where_there_is_no_throat() -> None:
    """Pinned designs state that of the default, and what other forms have."""
    keys = {"wheel.tip_form": "cylindrical"}
    pinned = gears_of(keys).pin().design
    assert pinned.sets("wheel.throat_radius")
    assert pinned.sets("worm.disk_diameter")
    gm.build(pinned)
    with pytest.raises(gm.DesignError, match=r"^wheel\.throat_radius = 18 mm: nothing .*tip_form is cylindrical"):
        gears_of({**keys, "wheel.throat_radius": 18})


def test_centre_distance_without_possible_shift_is_refused_by_its_name() -> None:
    """And not by that of the profile shift, which nobody set; at 2 modules from the distance without shift it is taken."""
    middle, m = (design := gm.parse(BASE)).center_distance, design.given_module  # type: ignore[attr-defined]
    for side in (-2.0, 2.0):
        parsed = parse_as_stated(with_keys(BASE, [("center_distance", middle + side * m)]))
        assert parsed.wheel.profile_shift == pytest.approx(side)  # type: ignore[attr-defined]
        with pytest.raises(
            gm.DesignError, match=r"^center_distance = .*: makes wheel\.profile_shift -?2\.1; allowed is from"
        ):
            parse_as_stated(with_keys(BASE, [("center_distance", middle + 1.05 * side * m)]))


def test_bounds_of_the_centre_distance_are_allowed() -> None:
    """Bounds as the refusal prints them are accepted, even for a module whose bounds have endless decimals."""
    odd = with_keys(BASE, [("module", 1.723), ("worm.quotient", 14.007)])
    with pytest.raises(gm.DesignError, match="allowed is from") as refused:
        parse_as_stated(with_keys(odd, [("center_distance", 1.0)]))
    low, high = str(refused.value).partition("allowed is from ")[2].removesuffix(" mm").split(" to ")
    for bound in (low.removesuffix(" mm"), high):
        assert abs(parse_as_stated(with_keys(odd, [("center_distance", float(bound))])).wheel.profile_shift) < 2.0  # type: ignore[attr-defined]


@pytest.mark.sweep
def test_a_backlash_that_leaves_no_thread_is_refused() -> None:
    """Backlash of several pitches is refused, too, where flanks of other threads would stand in place of the thread's own. The
    bound that the refusal names is built."""
    with pytest.raises(gm.DesignError, match=r"^backlash = 300 mm: .*leaves no") as refused:
        gears_of({"backlash": 300.0})
    bound = float(str(refused.value).partition("allowed is at most ")[2].removeprefix("about ").split()[0])
    gears_of({"backlash": bound})
