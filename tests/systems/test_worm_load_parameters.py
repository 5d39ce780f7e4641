"""Mean figures of the contact lines of worm drives, p_m*, h* and s*, from the lines that the solver finds."""

from __future__ import annotations

import math

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.places import SAMPLES

from gearmesh import WormDriveDesign, load
from gearmesh.contact.conditions.bent_lines import LineSections, directions, pieces
from gearmesh.contact.conditions.meshing import Conditions
from gearmesh.contact.engagement.curve import MeshCurve
from gearmesh.contact.engagement.engagement import whole_engagement
from gearmesh.contact.first_touch.first_touch import touches
from gearmesh.contact.flanks import solver_pair
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.curvature import principal, relative_curvature, tangent_basis
from gearmesh.systems.worm_drive.load_parameters import load_parameters

#: positions over the engagement, points of a piece of a line, and rad by which lines are moved on
POSITIONS, POINTS, STEP = 150, 41, 1e-5


@pytest.mark.sweep
@pytest.mark.parametrize(
    "keys", [["worm.form=ZI"], ["worm.form=ZK"], ["worm.form=ZN", "worm.threads=3", "worm.right_hand=false"]]
)
def test_mean_figures_are_those_of_the_solver_s_lines(keys: list[str]) -> None:
    """Second route: jets of both flanks, the wheel's as its hob's envelope, for the curvature of the gap, and lines a little later
    for the velocity across them, at 150 positions. It shares no equation with the closed form of `contact/conjugate.py`."""
    design = load(SAMPLES / "worm_drive.toml", keys)
    assert isinstance(design, WormDriveDesign)
    gears, design = pair_of(design), design.in_mm()
    pair = solver_pair(gears).parts[0]
    engagement = whole_engagement(pair, gears.pitch)
    assert engagement is not None
    surface = MeshCurve(engagement, gears.pitch).surface
    turn = surface.length / POSITIONS
    phi1 = surface.begin + (np.arange(POSITIONS) + 0.5) * turn
    contacts, plain = touches(pair, phi1)[0], Conditions(pair.flanks, phi1, pair.length)
    assert contacts.line.all()
    own = pieces(pair, plain, contacts.x, POINTS)
    x, line = own.x.reshape(-1, 5), np.repeat(own.line, POINTS)
    touch = plain.repeat(line).touch(x, np.arange(len(x)))
    one, two = touch.fixed
    along, across = directions(pair, touch)
    radius = -1.0 / principal(relative_curvature(one, two, *tangent_basis(one))).k2
    later = Conditions(plain.repeat(line).flanks, phi1[line] + STEP, pair.length)
    start = x + STEP * np.array([0.0, 0.0, 0.0, 0.0, pair.ratio])
    moved = newton.solve(LineSections(later, one.r, along, across), start, tolerance=pair.tolerance)
    assert moved.converged.all()
    of_line = (later.touch(moved.values, np.arange(len(x))).fixed[0].r - one.r) / STEP
    of_worm, of_wheel = pair.pinion.mount.velocity(one.r), pair.ratio * pair.gear.mount.velocity(one.r)
    over_worm, over_wheel = (dot(of_line - velocity, across) for velocity in (of_worm, of_wheel))
    sliding = np.linalg.norm(of_worm - of_wheel, axis=-1)
    # trapezium rule along every piece
    lengths = np.linalg.norm(np.diff(one.r.reshape(-1, POINTS, 3), axis=1), axis=-1)
    weight = 0.5 * turn * (np.pad(lengths, ((0, 0), (1, 0))) + np.pad(lengths, ((0, 0), (0, 1)))).ravel()

    def mean(figure: Array) -> float:
        return float((weight * figure).sum() / weight.sum())

    a, arm = design.center_distance, np.abs(dot(one.n, pair.gear.mount.velocity(one.r)))
    load_on_line = gears.pitch / float((weight * arm).sum())
    speed = 0.5 * np.abs(over_worm + over_wheel) * math.pi / 30.0 / a
    film = 7.797 * speed**0.7 * (radius / a) ** 0.43 / (load_on_line * a**2) ** 0.13
    known = load_parameters(design, gears.gear.tooth.blank.tip)
    assert float(weight.sum()) / gears.pitch == pytest.approx(known.length, rel=3e-3)
    assert 1.0 / mean(1.0 / radius) == pytest.approx(known.radius, rel=3e-3)
    assert math.pi / 32.0 * load_on_line * a**3 * mean(1.0 / radius) == pytest.approx(known.pressure, rel=3e-3)
    assert mean(film) == pytest.approx(known.film, rel=3e-3)
    assert 8.0 / a * mean(radius * sliding / np.abs(over_wheel)) == pytest.approx(known.path, rel=3e-3)
