"""Triangles of end faces, bore, hub and web against the fewest that close the teeth, and none of them a needle."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import Member
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Tooth
from gearmesh.mesh.solid import gear_solid


def member_of(sample: str, name: str) -> Member:
    return gm.build(gm.load(SAMPLES / f"{sample}.toml")).members[name]


def chords(points: Array, tolerance: float) -> int:
    """Fewest chords between points (N, 3) of a curve that keep the tolerance, each as long as it can be."""
    count, start = 0, 0
    while start < len(points) - 1:
        low, high = start + 1, len(points) - 1
        while low < high:
            middle = (low + high + 1) // 2
            along = points[middle] - points[start]
            away = points[start : middle + 1] - points[start]
            off = away - (away @ along / (along @ along))[:, None] * along
            low, high = (middle, high) if np.linalg.norm(off, axis=1).max() <= tolerance else (low, middle - 1)
        count, start = count + 1, low
    return count


def outline(tooth: Tooth, tolerance: float) -> int:
    """Fewest chords round both end sections of a tooth."""
    s, ends = np.linspace(0.0, 1.0, 601), tooth.sections(np.array([0.0, 1.0]))
    return sum(
        chords(points, tolerance)
        for region in tooth.regions
        for points in np.moveaxis(tooth.grid(region, s, ends).points, 1, 0)
    )


def body(member: Member, tolerance: float) -> int:
    """Triangles under a tooth between its outlines: an edge of a ring is one of a triangle on either side; rings as their radius
    asks for, but as many nodes on both sides of a cone."""
    rho = np.array([point[0] for point in member.body.profile])
    with np.errstate(divide="ignore"):
        edges = np.pi / np.arccos(1.0 - tolerance / rho) / member.tooth.teeth
    return 2 * int(np.ceil(edges[rho > 0.0]).sum())


@pytest.mark.parametrize(
    ("sample", "name", "tolerance", "most"),
    [
        ("helical_hub", "gear", 0.01, 1.05),
        ("zerol", "gear", 0.01, 1.2),
        ("helical", "pinion", 0.01, 1.12),
        ("beveloid_crossed", "pinion", 0.01, 1.23),
    ],
)
@pytest.mark.sweep_cases("beveloid_crossed-pinion-0.01-1.23", "helical_hub-gear-0.01-1.05", "zerol-gear-0.01-1.2")
def test_ends_and_bodies_take_few_triangles(sample: str, name: str, tolerance: float, most: float) -> None:
    """A plane between N and M nodes has N + M triangles: what the outlines need is all that can be saved."""
    member = member_of(sample, name)
    member = replace(member, features=member.features.uncut)
    mesh = gear_solid(member, tolerance)
    under = np.isin(mesh.regions, [mesh.region_names.index(region) for region in member.body_regions])
    assert under.sum() < most * member.tooth.teeth * (outline(member.tooth, tolerance) + body(member, tolerance))


@pytest.mark.sweep_cases("zerol-gear-0.1-regions0")
@pytest.mark.parametrize(
    ("sample", "name", "tolerance", "regions"),
    [
        ("zerol", "gear", 0.1, ("front_cone", "back_cone", "face_toe", "face_heel", "bore")),
        (
            "helical_hub",
            "gear",
            0.01,
            ("face_toe", "face_heel", "bore", "hub", "counterbore", "bolt", "spoke", "keyway"),
        ),
    ],
)
def test_ends_have_no_needles(sample: str, name: str, tolerance: float, regions: tuple[str, ...]) -> None:
    mesh = gear_solid(member_of(sample, name), tolerance)
    own = np.isin(mesh.regions, [mesh.region_names.index(region) for region in regions])
    corners = mesh.vertices[mesh.triangles[own]]
    sides = [corners[:, b] - corners[:, a] for a, b in pairwise((0, 1, 2, 0))]
    area = np.linalg.norm(np.cross(sides[0], sides[1]), axis=1)
    assert (area / np.max([np.linalg.norm(side, axis=1) for side in sides], axis=0)).min() >= tolerance
