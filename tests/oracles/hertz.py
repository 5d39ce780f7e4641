"""Hertz contact asked the other way round."""

from __future__ import annotations

from numpy.typing import ArrayLike

from gearmesh.contact.hertz import PointContact, point_contact
from gearmesh.kernel.numeric.algebra import Array


def at_peak(kappa: ArrayLike, kappa_other: ArrayLike, peak: ArrayLike, modulus: ArrayLike) -> PointContact:
    """Contact that has a given peak pressure (MPa), which grows with the cube root of the force."""
    return point_contact(
        kappa, kappa_other, (peak / point_contact(kappa, kappa_other, 1.0, modulus).peak_pressure) ** 3, modulus
    )


def squared_ratio(kappa: ArrayLike, kappa_other: ArrayLike) -> Array:
    """(b/a)^2 (...,), in which the load has no part."""
    found = point_contact(kappa, kappa_other, 1.0, 1.0)
    return (found.semi_minor / found.semi_major) ** 2
