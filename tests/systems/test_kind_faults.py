"""Faults of gear systems, not of designs: each is refused, and the refusal names surface, side and station."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from oracles.command_line import refused, run
from oracles.places import SAMPLES
from oracles.registry import keep_registry

import gearmesh as gm
from gearmesh import CylindricalDesign
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import ConeLevel, Displacements, GeneratedSurface, Jet, KindError, PlacedSurface, Surface, ToothSide
from gearmesh.mesh.body import split_long

CORPUS = Path(__file__).parents[1] / "corpus"
#: changes a side of a tooth
Change = Callable[[ToothSide], ToothSide]

KEYS = {"module": 2, **{name: {"teeth": 20, "face_width": 10} for name in ("pinion", "gear")}}
PAIR = {"kind": "spoilt", **KEYS}


class SpoiltDesign(CylindricalDesign):
    """A cylindrical pair of a kind with a fault."""

    own_kind: ClassVar[str] = "spoilt"
    example: ClassVar[Mapping[str, Any]] = KEYS


def spoilt(change: Change) -> gm.System[Any]:
    """A kind whose pinion has a fault on its left side."""
    own = gm.system("cylindrical")

    def build(design: Any) -> gm.GearTrain:
        train = own.build(design)
        pinion = train.members["pinion"]
        return train.with_member(replace(pinion, tooth=replace(pinion.tooth, left=change(pinion.tooth.left))))

    return gm.System("spoilt", SpoiltDesign, build, derive=own.derive)


@dataclass(frozen=True)
class Told:
    """A surface that tells something else of itself."""

    surface: Surface
    change: Callable[[Jet], Jet]

    def jet(self, u: Array, v: Array) -> Jet:
        return self.change(self.surface.jet(u, v))


@dataclass(frozen=True)
class Stretched:
    """A generated surface whose tool grows on its way."""

    surface: GeneratedSurface

    def __getattr__(self, name: str) -> Any:
        return getattr(self.surface, name)

    def tool_to_blank(self, *motion: Array) -> gm.Rigid:
        place = self.surface.tool_to_blank(*motion)
        return gm.Rigid(1.001 * place.rotation, place.translation)


def told(**parts: Callable[[Jet], Array]) -> Change:
    """A side whose flank tells other parts of its jet; its tool is not known."""

    def change(jet: Jet) -> Jet:
        return replace(jet, **{name: part(jet) for name, part in parts.items()})

    return lambda side: replace(side, flank=Told(side.flank, change), generation=None)


def in_the_middle(r: Array) -> Array:
    """1 across the axis in the middle of the flank's height, 0 elsewhere: (..., 3)."""
    return ((np.abs(np.hypot(r[..., 0], r[..., 1]) - 20.5) < 1.5)[..., None] * np.array([1.0, 1.0, 0.0])).astype(float)


def stretched(side: ToothSide) -> ToothSide:
    assert side.generation is not None
    return replace(side, generation=(Stretched(side.generation[0]), side.generation[1]))


def moved(surface: Surface, x: float) -> Surface:
    return PlacedSurface(surface, gm.Rigid(np.eye(3), np.array([x, 0.0, 0.0])))


def later(side: ToothSide) -> ToothSide:
    """The side whose fillet begins a little farther on than its flank ends."""
    p, q = side.form_point
    return replace(side, form_point=(p, q + 0.5 * (side.root - q)))


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (later, "flank_left and fillet_left: they are 1.19 mm"),
        (lambda side: replace(side, flank=moved(side.flank, 1e-3)), "flank_left and fillet_left: they are 0.001 mm"),
        (lambda side: replace(side, root=side.root - 0.1), "fillet_left and root: they are 0.0"),
    ],
)
def test_sides_that_do_not_join(change: Change, named: str, monkeypatch: pytest.MonkeyPatch) -> None:
    keep_registry(monkeypatch)
    gm.register(spoilt(lambda side: side))
    gm.build(gm.parse(PAIR))
    gm.register(spoilt(change))
    # the kind proves no tooth, but every tooth is compared when it is built
    with pytest.raises(KindError) as caught:
        gm.build(gm.parse(PAIR))
    assert str(caught.value).startswith(named)
    assert "at t = 0" in str(caught.value)
    assert caught.value.exit_status == 3


@pytest.mark.parametrize("end", ["toe", "heel"])
def test_bodies_that_miss_the_end_faces(end: str) -> None:
    blank = gm.build(gm.parse({**PAIR, "kind": "cylindrical"})).members["pinion"].tooth.blank
    assert replace(blank, body=blank.body) == blank
    profile = list(blank.body.profile)
    profile[0 if end == "toe" else -1] = (15.0, 0.5 if end == "toe" else 4.9)
    with pytest.raises(KindError, match=f"body profile at the {end}: .* is {'5.5' if end == 'toe' else '0.1'} mm from"):
        replace(blank, body=replace(blank.body, profile=tuple(profile)))
    # a wrong station cone moves both ends
    with pytest.raises(KindError, match="body profile at the toe"):
        replace(blank, axial=ConeLevel(np.radians(20.0)))


@dataclass(frozen=True)
class SphereLevel:
    """A station coordinate that is not linear in radius and z, which no end face can have."""

    radius: float

    def value(self, r: Array) -> Array:
        value: Array = np.linalg.norm(r, axis=-1) - self.radius
        return value

    def gradient(self, r: Array) -> Array:
        gradient: Array = r / np.linalg.norm(r, axis=-1, keepdims=True)
        return gradient

    def hessian(self, r: Array, w: Array) -> Array:
        raise NotImplementedError


def test_splitting_ends_where_the_chart_misses_the_station() -> None:
    angle = np.linspace(0.0, 1.0, 5)
    ring = np.column_stack((np.cos(angle), np.sin(angle), 0.0 * angle))
    points = np.concatenate((20.0 * ring, np.column_stack((10.0 * ring[:, :2], 0.0 * angle + np.sqrt(300.0)))))
    k = np.arange(4)
    triangles = np.concatenate((np.stack((k, k + 1, k + 5), axis=1), np.stack((k + 1, k + 6, k + 5), axis=1)))

    def lift(q: Array) -> Array:
        """The cone through both rings, beside the sphere."""
        radius = np.linalg.norm(q, axis=-1)
        return np.column_stack((q, np.sqrt(300.0) * (20.0 - radius) / 10.0))

    with pytest.raises(KindError, match="end face: its triangles are"):
        split_long(triangles, (points[:, :2], points), SphereLevel(20.0), lift, 1e-3)


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (lambda side: side, ""),
        (told(r_u=lambda jet: 2.0 * jet.r_u), "its derivative r_u is "),
        (told(n_u=lambda jet: 0.0 * jet.n_u), "its derivative n_u is "),
        (told(n_u=lambda jet: 1.001 * jet.n_u), "its derivative n_u is "),
        (told(n=lambda jet: 1.01 * jet.n), "its normal n has the length 1.01 "),
        (told(n=lambda jet: -jet.n, n_u=lambda jet: -jet.n_u), "its normal n points into the material "),
        (
            told(r=lambda jet: jet.r + 1e-4 * np.sin(1e6 * jet.r) * in_the_middle(jet.r)),
            "its r has no derivative by u ",
        ),
        (stretched, "the motion of its tool, tool_to_blank, is no rigid motion "),
    ],
)
@pytest.mark.sweep_cases("<lambda>-")
def test_surfaces_that_are_not_what_they_say(change: Change, fault: str) -> None:
    system = spoilt(change)
    if not fault:
        assert max(row.normal_error for row in gm.prove(system).rows) < 1e-9
        return
    with pytest.raises(KindError) as caught:
        gm.prove(system)
    assert str(caught.value).startswith(f"pinion: flank_left: {fault}")
    assert "t = 0." in str(caught.value)
    assert "station" in str(caught.value)


@pytest.mark.parametrize(
    ("tip", "told"),
    [
        (17.8, "flank_right: the flank does not reach the tip, at t = 0"),
        (26.0, "land: the tooth is pointed, at t = 0"),
    ],
)
def test_faults_are_not_blamed_on_the_design(tip: float, told: str) -> None:
    own = spoilt(lambda side: side)

    def build(design: Any) -> gm.GearTrain:
        train = own.build(design)
        tooth = train.members["pinion"].tooth
        try:
            replace(tooth, blank=replace(tooth.blank, tip=ConeLevel.of(tip))).prove()
        except gm.NoSolutionError as failure:
            raise gm.DesignError("module", design.module, unit="mm", allowed="at most 1.7 mm") from failure
        return train

    with pytest.raises(KindError) as caught:
        gm.prove(replace(own, build=build))
    assert str(caught.value).startswith(told)


@pytest.mark.parametrize(
    ("keys", "told"),
    [
        (("assembly.dx",), 'displacements = assembly.dx: must be a key of the table assembly without its name: "dx"'),
        (("dx", "dq"), "spoilt: errors of assembly = dq: must be one of center_distance_allowance, "),
        (("dx", "dy"), "displacements: `bases` asks for the error 'dz'; must be one of dx, dy"),
    ],
)
@pytest.mark.sweep_cases("keys2-displacements: `bases` asks for the error 'dz'; must be one of dx, dy")
def test_unknown_keys_of_displacements(keys: tuple[str, ...], told: str, monkeypatch: pytest.MonkeyPatch) -> None:
    keep_registry(monkeypatch)
    own = spoilt(lambda side: side)
    known = gm.system("cylindrical").displacements
    assert known is not None

    def wrong() -> gm.System[Any]:
        return replace(own, displacements=Displacements(keys, known.bases))

    with pytest.raises(KindError) as fault:
        gm.prove(wrong())
    assert str(fault.value).startswith(told)
    # a study of such a kind is refused, too, and does not end in a KeyError
    if "." not in keys[0]:
        gm.register(wrong())
        gears = gm.build(gm.parse(PAIR))
        with pytest.raises(KindError) as fault:
            gears.study({"assembly.dx": "0:0.1:2"})
        assert str(fault.value).startswith(told)


def test_ratios_and_kinds_of_gear_sets() -> None:
    own = spoilt(lambda side: side)

    def ratio(design: Any) -> gm.GearTrain:
        train = own.build(design)
        return replace(train, pairs=tuple(replace(pair, ratio=1.01 * pair.ratio) for pair in train.pairs))

    with pytest.raises(KindError, match=r"pinion-gear: ratio = .* the ratio of the pitches"):
        gm.prove(replace(own, build=ratio))
    with pytest.raises(KindError, match=r'kind = other: .* must be "spoilt"'):
        gm.prove(replace(own, build=lambda design: replace(own.build(design), kind="other")))


#: designs far from the usual: flanks that are steep, folded, undercut or wound many times
FAR = (
    *("contact_beveloid_edge_6", "contact_beveloid_sensible_0", "face_worm_drive_10", "stations_worm_drive_137"),
    *("overlap_beveloid_twenty_windings", "fold_spiral_bevel_edge_2080", "ground_novikov_edge_102"),
)


#: samples that are proved each time; all others with the marker sweep
USUAL = ("spur", "worm_drive", "face_gear")
DESIGNS = (*sorted(SAMPLES.glob("*.toml")), *(CORPUS / f"{name}.toml" for name in FAR))


@pytest.mark.sweep_cases(*(path.stem for path in DESIGNS if path.stem not in USUAL), "face_gear", "worm_drive")
@pytest.mark.parametrize("design", DESIGNS, ids=lambda path: path.stem)
def test_kinds_of_gearmesh_are_proved(design: Path) -> None:
    assert max(row.point_error for row in gm.prove(gm.load(design, complete=False)).rows) < 1e-6


def test_command(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, _ = run("prove", "cylindrical")
    assert status == 0
    assert "flank_right" in out
    assert refused("prove", "cylindrcal").startswith('kind = "cylindrcal": must be one of')
