"""Proof of a kind: its surfaces, normals, motions and keys, compared with each other. It finds faults of the kind itself.

A design may be impossible, and its refusal names a key. A kind may be wrong: a derivative that is none, a normal of another
length, surfaces apart. Contact and meshes would take them as they are. Refusals here name surface, side and station, never
a key of the design.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from gearmesh.answers.result import Result, columns, header
from gearmesh.answers.tables import Listing, plain
from gearmesh.arguments import checks_arguments
from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError, GearmeshError, KindError
from gearmesh.figures import Content, Figures, figure
from gearmesh.kernel.motion.rigid import MAX_ROTATION_ERROR, Rigid, rotation_error
from gearmesh.records import dataclass
from gearmesh.systems import system as systems
from gearmesh.systems.system import System
from gearmesh.teeth.proof import prove_surfaces, prove_tooth
from gearmesh.teeth.tooth import Tooth, before_trimming

if TYPE_CHECKING:
    from gearmesh.teeth.gear_train import GearPair, GearTrain

#: largest difference of mounts that should be equal
MAX_MOUNT_ERROR = 1e-9
#: largest difference of a pair's ratio from the ratio of its members' pitches, as a share
MAX_RATIO_ERROR = 1e-9
#: error of assembly, mm or deg, at which the mounts that a kind displaces are compared with rigid motions
TRIED_ERROR = 0.01


@dataclass(frozen=True)
class ProofFigures(Figures):
    """Largest errors of one surface of a member."""

    member: str = figure("member")
    surface: str = figure("region of the surface")
    points: int = figure("points at which the surface was sampled", whole=True)
    point_error: float = figure("error of the derivatives of points by both parameters, as a share of their way")
    normal_error: float = figure("error of the derivatives of normals by both parameters, in rad over the tooth")
    length_error: float = figure("difference of the length of normals from 1")


@dataclass(frozen=True, repr=False)
class KindProof(Result):
    """A kind whose surfaces, motions and keys agree with each other, by one of its designs."""

    #: the design
    design: Design
    #: one row for every surface of every member
    rows: list[ProofFigures]

    @property
    def headline(self) -> str:
        worst = max(max(row.point_error, row.normal_error, row.length_error) for row in self.rows)
        return f"{len(self.rows)} surfaces proved, largest error {worst:.1e}"

    @property
    def listings(self) -> list[Listing]:
        rows = [plain(row.row) for row in self.rows]
        return [Listing(f"Proof of the kind {self.design.kind}", list(rows[0]), [list(row.values()) for row in rows])]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([row.row for row in self.rows])

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.design), "surfaces": self.rows}


@checks_arguments
def prove(kind: str | System[Any] | Design) -> KindProof:
    """Compare surfaces, normals, motions and keys of a kind with each other.

    - Derivatives of points and normals equal differences; normals have length 1 and point out of the material.
    - Flank, fillet, root and tip edge meet; the tooth can be trimmed; the body's profile ends on the end faces.
    - Motions of tools and mounts are rigid; a generated surface is where its tool is; ratios are those of the teeth.
    - Keys of displacements are keys of the design, and displaced mounts without errors are those of the gears.

    Parameters
    ----------
    kind : str, System or Design
        A kind or a system, whose example is built, or a design, complete or not.

    Returns
    -------
    KindProof
        The largest errors of every surface.

    Raises
    ------
    KindError
        For the first fault, naming surface, side and station.
    DesignError
        For keys of the design that are refused before anything is built.

    Examples
    --------
    >>> proof = gm.prove("cylindrical")
    >>> proof.rows[0].surface
    'flank_right'
    """
    system, design = _subject(kind)
    _prove_keys(system, design)
    with _proving():
        own = (design if system.derive is None or design.complete else design.fill(system.derive(design))).in_mm()
        train = systems.finished(own, system.build(own))
        if train.kind != system.kind:
            raise KindError(
                "kind", train.kind, reason="the gear set of the kind has another", must_be=f'"{system.kind}"'
            )
        rows = [
            ProofFigures(
                name, found.region.value, found.points, found.point_error, found.normal_error, found.length_error
            )
            for name, member in train.members.items()
            for found in _of_member(name, member.tooth)
        ]
        for pair in train.pairs:
            _prove_pair(pair)
        _prove_displacements(system, own, train)
    return KindProof(design, rows)


def _subject(kind: str | System[Any] | Design) -> tuple[System[Any], Design]:
    """Return the system to prove and a design of it, in its own units."""
    if isinstance(kind, Design):
        return systems.system_of(kind), kind
    system = systems.system(kind) if isinstance(kind, str) else kind
    if not system.design.example:
        raise ArgumentError(
            "kind", system.kind, reason="its class of designs has no `example`", must_be="a design of it"
        )
    return system, system.design(**{"kind": system.kind, **system.design.example})


@contextmanager
def _proving() -> Iterator[None]:
    """Compare the surfaces of every tooth that is proved before it is trimmed, and name surface and side in refusals.

    A kind may turn a failed trimming into the refusal of a key. Here the failure itself is reported.
    """
    token = before_trimming.set(prove_surfaces)
    try:
        yield
    except KindError:
        raise
    except GearmeshError as failure:
        untrimmed = next((cause for cause in _causes(failure) if hasattr(type(cause), "surfaces")), None)
        if untrimmed is None:
            raise
        raise _trim_fault(untrimmed) from failure
    finally:
        before_trimming.reset(token)


def _causes(failure: BaseException) -> Iterator[BaseException]:
    """Yield an exception and the exceptions that led to it."""
    cause: BaseException | None = failure
    while cause is not None:
        yield cause
        cause = cause.__cause__ or cause.__context__


def _trim_fault(failure: Any) -> KindError:
    """Return the refusal of a tooth for its TrimError."""
    return KindError(
        " and ".join(failure.surfaces),
        reason=f"{failure.reason}, at t = {failure.station:.4g} (0: toe, 1: heel)",
        remedy="surfaces, levels and start values of the tooth do not fit each other",
    )


def _of_member(name: str, tooth: Tooth) -> list[Any]:
    """Return what is found on the surfaces of a member's tooth, which is trimmed, too; refusals name the member."""
    try:
        tooth.prove()
        found = prove_tooth(tooth)
    except KindError as fault:
        raise fault.rename(f"{name}: {fault.key}") from fault
    return found


def _prove_keys(system: System[Any], design: Design) -> None:
    """Raise KindError for keys of assembly that the designs of the kind do not have."""
    for key in () if system.displacements is None else system.displacements.keys:
        systems.assembly_key(type(design), key)
    for key in () if system.vh is None else system.vh.keys.values():
        systems.assembly_key(type(design), key)


def _prove_pair(pair: GearPair) -> None:
    """Raise KindError for mounts that are not rigid, and for another ratio than that of the teeth."""
    for name, mount in zip(pair.members, pair.mounts, strict=True):
        _prove_rigid(f"{name}: mount", mount.base)
        if abs(mount.sign) != 1.0:
            raise KindError(f"{name}: mount", mount.sign, reason="the sign of its rotation", must_be="1 or -1")
    wanted = pair.gear.tooth.pitch_angle / pair.pinion.tooth.pitch_angle
    if not abs(pair.ratio - wanted) <= MAX_RATIO_ERROR * wanted:
        raise KindError(f"{pair.name}: ratio", pair.ratio, must_be=f"{wanted:.9g}, the ratio of the pitches")


def _prove_rigid(name: str, place: Rigid) -> None:
    """Raise KindError if a transform is no rotation with a shift."""
    if not (rotation_error(place) <= MAX_ROTATION_ERROR).all():
        raise KindError(name, reason="it is no rigid motion", must_be="a rotation and a shift")


def _prove_displacements(system: System[Any], own: Design, train: GearTrain) -> None:
    """Raise KindError where displaced mounts are not those of the gears without errors, or not rigid.

    `own`: the design in mm. A design with errors of assembly is left out: its mounts are displaced already.
    """
    if system.displacements is None or not train.pairs:
        return
    keys = system.displacements.keys
    if any(own.sets(f"assembly.{key}") for key in keys):
        return
    still = system.displacements.displaced(own, train, {key: np.zeros(1) for key in keys})
    moved = {key: system.displacements.displaced(own, train, _one_error(keys, key)) for key in keys}
    for mount, base, name in zip(train.pairs[0].mounts, still, train.pairs[0].members, strict=True):
        apart = max(
            float(np.abs(base.rotation - mount.base.rotation).max()),
            float(np.abs(base.translation - mount.base.translation).max()),
        )
        if not apart <= MAX_MOUNT_ERROR * max(1.0, float(np.abs(mount.base.translation).max())):
            raise KindError(
                f"{name}: displacements",
                reason=f"without errors of assembly the mount is {apart:.3g} off",
                must_be="the mount of the gears as built",
            )
    for key, bases in moved.items():
        for base in bases:
            _prove_rigid(f"displacements: {key}", base)


def _one_error(keys: tuple[str, ...], own: str) -> dict[str, Any]:
    """Return errors (1,) of assembly by key, all 0 but one."""
    return {key: np.full(1, TRIED_ERROR if key == own else 0.0) for key in keys}
