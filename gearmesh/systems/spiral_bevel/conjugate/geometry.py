"""Conjugate spiral bevel gears in closed form: Geometry I and II of [CR3553] chapter 2.

Two generating surfaces, F for the pinion and K for the gear, are rigidly connected. They turn about the axis of a crown
gear whose pitch plane contains the common pitch line. Geometry I: two cones touch along a generatrix, and the contact
moves across the tooth. Geometry II: a cone (K) and a surface of revolution (F) touch along a circle, and the contact
moves along the tooth.

Frame S_f: the origin is the pitch apex, z is along the pitch line from the apex to the heel. x is along the crown
gear's axis on the gear's side, y as in the pinion's frame. The formulas are for a left-hand pinion's convex side (psi_c
> 0). The concave side has psi_c < 0; a right-hand pinion is the mirror image in y. Lengths in mm, angles in rad. phi_d
(...,) is the rotation of the generating surfaces: phi_1 = phi_d / sin(gamma_1), phi_2 = phi_d / sin(gamma_2) [2.3.2,
2.3.4].
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass


@dataclass(frozen=True)
class ConjugateGeometry:
    """Design of one pair of sides [CR3553 2.2, 2.5]."""

    #: cone distance L of the mean contact point, mm
    cone_distance: float
    #: spiral angle beta, rad
    spiral_angle: float
    #: blade angle, rad; < 0 on the concave side of the pinion
    psi_c: float
    #: radius of the pinion's cutter at the pitch plane, mm
    r_f: float
    #: radius of the gear's cutter at the pitch plane, mm; equal to r_f in Geometry II
    r_k: float
    #: pitch angle of the pinion, rad
    gamma_1: float
    #: pitch angle of the gear, rad
    gamma_2: float
    #: profile radius of F in Geometry II, mm; inf in Geometry I
    rho: float = np.inf

    def setting(self, radius: float) -> tuple[float, float]:
        """Return radial setting b and cradle angle q of a cutter with a radius at the pitch plane [2.2.24; Fig. 2.2.4]."""
        along = self.cone_distance - radius * np.sin(self.spiral_angle)
        across = radius * np.cos(self.spiral_angle)
        return float(np.hypot(along, across)), float(np.arctan2(across, along))

    def tau(self, phi_d: ArrayLike) -> Array:
        """Return the angle tau of the normal at the contact point [2.2.24] or, in Geometry II, [2.6.3]."""
        phi_d = np.asarray(phi_d, dtype=float)
        if np.isinf(self.rho):
            return 0.5 * np.pi - self.spiral_angle + phi_d
        b, q = self.setting(self.r_k)
        return np.arcsin(b / self.r_k * np.sin(q - phi_d))

    def line_of_action(self, phi_d: ArrayLike) -> Array:
        """Return the contact points (..., 3) in S_f: (2.2.25) for Geometry I, (2.6.4) for Geometry II."""
        phi_d = np.asarray(phi_d, dtype=float)
        tau = self.tau(phi_d)
        b, q = self.setting(self.r_k)
        if not np.isinf(self.rho):
            z = self.r_k * np.cos(tau) + b * np.cos(q - phi_d)
            return np.stack((np.zeros_like(z), np.zeros_like(z), z), axis=-1)
        x = (self.r_k - b * np.sin(q - phi_d) / np.sin(tau)) * np.sin(self.psi_c) * np.cos(self.psi_c)
        theta = 0.5 * np.pi - self.spiral_angle + q
        y = np.sin(tau) / np.tan(self.psi_c) * x
        z = b * np.sin(theta) / np.sin(tau) + np.cos(tau) / np.tan(self.psi_c) * x
        return np.stack((x, y, z), axis=-1)

    def normal(self, phi_d: ArrayLike) -> Array:
        """Return the common unit normals (..., 3) in S_f, out of the pinion on its convex side [2.2.10, 2.5.8]."""
        tau = self.tau(phi_d)
        c, s = np.cos(self.psi_c), np.sin(self.psi_c)
        return np.stack((np.full_like(tau, s), c * np.sin(tau), c * np.cos(tau)), axis=-1)

    def pinion_path(self, phi_d: ArrayLike) -> Array:
        """Return the path of contact (..., 3) in the pinion's frame; phi_1 is right-handed about its axis [2.3.1]."""
        phi_d = np.asarray(phi_d, dtype=float)
        x, y, z = np.moveaxis(self.line_of_action(phi_d), -1, 0)
        c, s = np.cos(self.gamma_1), np.sin(self.gamma_1)
        return _turn(x * c + z * s, y, z * c - x * s, -phi_d / s)

    def gear_path(self, phi_d: ArrayLike) -> Array:
        """Path of contact (..., 3) on the gear in the source's S_2; phi_2 is left-handed about its axis [2.3.3].

        S_2 has its x axis away from the pitch line: it is the gear's frame turned by 180 deg about its axis.
        """
        phi_d = np.asarray(phi_d, dtype=float)
        x, y, z = np.moveaxis(self.line_of_action(phi_d), -1, 0)
        c, s = np.cos(self.gamma_2), np.sin(self.gamma_2)
        return _turn(x * c - z * s, y, x * s + z * c, phi_d / s)

    @cached_property
    def tool_curvatures(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Principal curvatures (around, along the profile) of F and of K at the mean point [2.4.2, 2.7.8, 2.7.9]."""
        profile = -np.sign(self.psi_c) / self.rho
        c = np.cos(self.psi_c)
        return (float(-c / self.r_f), float(profile)), (float(-c / self.r_k), 0.0)

    def mean_curvatures(self, member: int) -> tuple[float, float, float]:
        """Return the principal curvatures kappa_I, kappa_II (1/mm, with `normal`) and sigma (rad) at the mean point.

        `member`: 1 pinion, 2 gear. The equations are [2.4.5-2.4.7; 2.7.10-2.7.12] with (2.4.22)-(2.4.24); for member 2,
        the terms of the generation have gamma_2 and the opposite sign. sigma counts from the tool's direction I (0,
        sin(beta), -cos(beta)) [2.4.1].
        """
        around, profile = self.tool_curvatures[member - 1]
        gamma, sign = ((self.gamma_1, -1.0), (self.gamma_2, 1.0))[member - 1]
        length, s_psi = self.cone_distance, np.sin(self.psi_c)
        s, c = np.sin(self.spiral_angle), np.cos(self.spiral_angle)
        share = sign / (np.tan(gamma) * length * s_psi)
        sum_ = share * (s**2 * s_psi**2 + c**2)
        difference = share * (s**2 * s_psi**2 - c**2)
        mixed = share * s * c * s_psi
        sigma = 0.5 * np.arctan2(2.0 * mixed, around - profile + difference)
        half = 0.5 * np.hypot(2.0 * mixed, around - profile + difference)
        mean = 0.5 * (around + profile + sum_)
        return float(mean + half), float(mean - half), float(sigma)


def _turn(x: Array, y: Array, z: Array, angle: Array) -> Array:
    """Return points turned right-handed about z."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack((c * x - s * y, s * x + c * y, np.broadcast_to(z, x.shape)), axis=-1)
