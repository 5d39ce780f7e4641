"""Data of the three-dimensional view of the report page: members, their motions, and the contact of their pairs.

`staged_member` has the members. In JSON arrays are base64 text of float32 (see `packing`), NaN for missing values.
Lengths are in mm, angles in rad, amounts in um.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gearmesh.answers.contact.figures import shown_contact
from gearmesh.answers.contact.staging import StagedContact, shown_flank
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.gear_train import GearPair, GearTrain
from gearmesh.view.on_tooth import closest_gap, lift_grid, union_level
from gearmesh.view.report.packing import pack
from gearmesh.view.report.staged_member import StagedMember, camera_data, member_data, shape_data
from gearmesh.view.scene import Camera, MemberContact, contact_on, jumps

if TYPE_CHECKING:
    from gearmesh.view.load.footprints import Footprints
    from gearmesh.view.load.loaded_diagrams import LoadedPattern

#: smallest end of a scale: ten times the accuracy of the amounts
MIN_SCALE_UM = 1.0
#: points of a contact line
POINTS_PER_LINE = 9
#: points along a band of pressure
POINTS_PER_BAND = 25
#: end of the scale of gaps, in thicknesses of the compound; the pattern ends at 1
GAP_SCALE_THICKNESSES = 10.0
#: height above a flank at which points and colours are drawn, relative to its size
LIFT_SHARE = 1e-3


@dataclass(frozen=True)
class StagedPair:
    """A pair of members that the view can roll.

    It has the pair's contact, the gaps of a roll test by member (points in the members' own frames) if there was one,
    and its pressures under torque.
    """

    contact: StagedContact
    patches: Mapping[str, list[tuple[Array, Array]]]
    loaded: LoadedPattern | None = None

    @property
    def pair(self) -> GearPair:
        return self.contact.pair


def stage(
    train: GearTrain, members: Sequence[StagedMember], pairs: Sequence[StagedPair], camera: Camera
) -> dict[str, Any]:
    """Return the data of the view; members that look alike share their meshes."""
    shapes: list[dict[str, Any]] = []
    shown = []
    for staged in members:
        shape = shape_data(staged)
        if shape not in shapes:
            shapes.append(shape)
        shown.append(member_data(staged.member, shapes.index(shape), staged.reach))
    names = [staged.member.name for staged in members]
    return {
        "camera": camera_data(camera),
        "shapes": shapes,
        "members": shown,
        "pairs": [pair_data(train, staged, names) for staged in pairs],
    }


def pair_data(train: GearTrain, staged: StagedPair, names: list[str]) -> dict[str, Any]:
    """Return the data of the contact of a pair; `names` are those of all members, in the order of the view."""
    pair, path, turns = staged.pair, staged.contact.path, staged.contact.turns
    rad, unit = pair.output.reading.error
    return {
        "name": pair.name,
        "members": [names.index(name) for name in pair.members],
        "phi1": pack(path.phi1),
        # positions from which contact jumps to the next
        "jumps": jumps(path.point1, path.edge, path.rotation).tolist(),
        "turns": [pack(turns[name]) for name in names],
        "te": pack(path.te / rad),
        "te_unit": unit.replace("um", "\u00b5m"),
        "kind": [
            shown_contact(str(kind), str(edge), tuple(pair.members))
            for kind, edge in zip(path.kind, path.edge, strict=True)
        ],
        "delta_um": 1e3 * pair.delta,
        "point": pack(path.point),
        "normal": pack(path.normal),
        "lines": pack([_evenly(line) for line in path.lines]),
        "flanks": [_flank(staged, name, _to_shown(train, pair, name)) for name in pair.members],
        **({} if staged.loaded is None else {"loaded": _load_data(staged.loaded, rad)}),
    }


def _load_data(pattern: LoadedPattern, rad: float) -> dict[str, Any]:
    """Return figures over a pitch and bands of pressure by phases, for every torque, fixed frame; see `bands`."""
    from gearmesh.view.load.loaded_diagrams import cycle_curves

    mesh, loads = pattern.mesh, []
    curves = cycle_curves(pattern.gears, mesh.phi1)
    for k, halves in enumerate(pattern.prints):
        loads.append({
            "torque": 1e-3 * float(mesh.torque[k]),
            "te": pack(curves.close(mesh.te[k] - mesh.unloaded[0]) / rad),
            "stress": pack(curves.close(mesh.bending[k])),
            "halves": [
                _bands(prints, image)
                for prints, image in zip(halves, pattern.gears.images, strict=False)
                if (prints.share > 0.0).any()
            ],
        })  # fmt: skip
    return {
        "pitch": pattern.gears.pitch,
        "phi1": pack(np.radians(curves.degrees)),
        "limit": pattern.limit,
        "above": pattern.above,
        "loads": loads,
    }


def _to_shown(train: GearTrain, pair: GearPair, name: str) -> Rigid:
    """Return the motion from a member's own frame in a pair to the frame in which it is drawn; in sets they differ by
    whole pitches.
    """
    return train.members[name].mount.base.inverse @ pair.members[name].mount.base


def _flank(staged: StagedPair, name: str, to_shown: Rigid) -> dict[str, Any]:
    """Return a member's working flank: a grid of exact points, slightly lifted, coloured fields and ellipses."""
    pair = staged.pair
    index = pair.index(name)
    contact = contact_on(index, staged.contact.path, pair.mounts)
    member, side = pair.members[name], pair.flanks[index]
    grid = shown_flank(member, side)
    size = float(np.linalg.norm(np.ptp(grid.points.reshape(-1, 3), axis=0)))
    with np.errstate(invalid="ignore", divide="ignore"):
        major, minor = contact.major / contact.semi_major[:, None], contact.minor / contact.semi_minor[:, None]
    return {
        "shape": list(grid.points.shape[:2]),
        "size": size,
        "points": pack(to_shown.point(lift_grid(grid.points, contact, LIFT_SHARE * size))),
        "contact": pack(to_shown.point(contact.point)),
        "normal": pack(to_shown.vector(contact.normal)),
        # unit axis over semi-axis: inside the ellipse the squares of the products with both add up to at most 1
        "major": pack(to_shown.vector(major)),
        "minor": pack(to_shown.vector(minor)),
        "fields": _fields(staged, name, contact, grid.points),
    }


def _fields(staged: StagedPair, name: str, contact: MemberContact, points: Array) -> list[dict[str, Any]]:
    """Return the fields that can colour a flank: values (I, J) with their unit, and the end of the scale."""
    pair, fields = staged.pair, []

    def add(key: str, label: str, values: Array, limit: float) -> None:
        if np.isfinite(values).any():
            fields.append({"key": key, "label": label, "values": pack(values), "limit": limit})

    if staged.loaded is not None:
        fields.append(_pressures(staged.loaded, name, points))
    if contact.ellipses.size:
        add("pattern", "pattern: ellipses of all positions", union_level(contact, points), 1.0)
    elif staged.patches.get(name):
        share = closest_gap(points, staged.patches[name]) / pair.delta
        add("pattern", "pattern: roll-test gap below the thickness of the marking compound", share, 1.0)
    gaps = staged.contact.gaps
    if pair.index(name) == 1 or gaps is None:
        return fields
    if not any(field["key"] == "pattern" for field in fields):
        share = np.where(gaps.least < np.inf, np.maximum(gaps.least, 0.0), np.nan) / pair.delta
        add("pattern", "pattern: least gap of all positions below the thickness of the marking compound", share, 1.0)
    if gaps.ease_off is not None:
        amount = 1e3 * gaps.ease_off
        add("ease_off", "ease-off (\u00b5m)", amount, _most(amount))
    gap = np.maximum(1e3 * gaps.at_phi1, 0.0)
    label = f"gap at \u03c6\u2081 = {np.degrees(gaps.phi1):.3g}\u00b0 (\u00b5m)"
    add("gap", label, gap, min(_most(gap), GAP_SCALE_THICKNESSES * 1e3 * pair.delta))
    return fields


def _bands(prints: Footprints, image: Rigid) -> dict[str, Any]:
    """Return the phases with load of a tooth pair: its share of the torque, and its band of pressure, mapped by an
    `image`.
    """
    pressed = np.flatnonzero(prints.share > 0.0)
    last = pressed[-1] + 1
    shown = slice(pressed[0], last)
    bands = prints.bands(POINTS_PER_BAND)[shown]
    bands[..., :3] = image.point(bands[..., :3])
    return {
        "phase": pack(prints.phase[shown]),
        "share": pack(prints.share[shown]),
        "joined": prints.joined[pressed[0] : last - 1].astype(int).tolist(),
        "bands": pack(bands),
        "across": pack(image.vector(prints.across[shown])),
    }


def _pressures(pattern: LoadedPattern, name: str, points: Array) -> dict[str, Any]:
    """Return the largest pressure at points (I, J, 3) of a flank, for every torque."""
    from gearmesh.view.load.loaded_diagrams import MIN_DRAWN_SHARE, PRESSURE_LABEL

    by_torque = []
    for panel, *_ in pattern.panels[name]:
        values = panel.at(panel.plane.frame.places(points))
        shown = np.where(values > MIN_DRAWN_SHARE * pattern.limit, np.minimum(values, 0.999 * pattern.limit), np.nan)
        by_torque.append(pack(shown))
    return {
        "key": "pressure",
        "label": PRESSURE_LABEL,
        "values": by_torque[0],
        "torques": by_torque,
        "limit": pattern.limit,
        "above": pattern.above,
    }


def _most(values: Array) -> float:
    """Largest value, but at least `MIN_SCALE_UM`, so that rounding is not shown as a signal."""
    return max(float(np.nanmax(values, initial=0.0)), MIN_SCALE_UM)


def _evenly(line: Array | None) -> Array:
    """Points (POINTS_PER_LINE, 3) of a contact line; NaN if there is none."""
    if line is None:
        return np.full((POINTS_PER_LINE, 3), np.nan)
    place = np.linspace(0.0, len(line) - 1.0, POINTS_PER_LINE)
    return np.stack([np.interp(place, np.arange(len(line)), line[:, k]) for k in range(3)], axis=-1)
