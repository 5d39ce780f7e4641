"""Second routes to curvature: generated surfaces from their tools, the contact ellipse in closed form.

Signs and bases are those of `gearmesh.kernel.surface.curvature`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.kernel.surface.curvature import in_plane, principal, shape_operator
from gearmesh.kernel.surface.surface import area_normal
from gearmesh.kinds import Envelope, Jet, MotionState


def from_principal(k1: Array, k2: Array, angle: Array) -> Array:
    """Symmetric operator (..., 2, 2) with k1 at `angle` (..., rad) from e1 and k2 across it: undoes `principal`."""
    mean, half = 0.5 * (k1 + k2), 0.5 * (k1 - k2)
    c, s = half * np.cos(2.0 * angle), half * np.sin(2.0 * angle)
    return np.stack((np.stack((mean + c, s), axis=-1), np.stack((s, mean - c), axis=-1)), axis=-2)


def mean_curvature(k: Array) -> Array:
    """Mean curvature (k1 + k2) / 2 (...,), 1/mm, of operators (..., 2, 2)."""
    return 0.5 * (k[..., 0, 0] + k[..., 1, 1])


def meshing_terms(tool: Jet, state: MotionState) -> tuple[Array, Array, Array]:
    """Relative velocity v12 (..., 3), angular velocity omega12 (..., 3) and b3 (...,) of a generation, tool frame.

    Per unit of the motion parameter: v12 = Omega x r + tau is the velocity of the tool over the blank, and
    b3 = -n . (Omega' x r + tau') is minus the derivative of the equation of meshing f = n . v12 at a fixed tool
    point. For two bodies turning at constant rates it is [n omega2 v1] - [n omega1 v2] [CR3553 1.6.34]; the
    derivative of the twist covers every other motion as well.
    """
    b3 = -dot(tool.n, cross(state.omega_phi, tool.r) + state.tau_phi)
    return cross(state.omega, tool.r) + state.tau, state.omega, b3


def generated_principal(
    k_i: Array, k_ii: Array, i_i: Array, i_ii: Array, v12: Array, omega12: Array, b3: Array
) -> tuple[Array, Array, Array]:
    """Principal curvatures k_iii >= k_iv of a generated surface and sigma, each (...,) [CR3553 1.6.40-42; LT02 15-23].

    From the tool's principal curvatures k_i, k_ii (...,) along i_i, i_ii (..., 3), with (i_i, i_ii, n) right-handed,
    and the relative motion as in `meshing_terms`; all vectors in one frame. sigma (rad) is the angle from i_i to the
    direction of k_iii. Equal to K_generated = K_tool + a (x) a / (b3 + v12 . a) with a = n x omega12 - K_tool v12.
    Infinite where b3 + v12 . a = 0: on the limiting line of undercut.
    """
    n = cross(i_i, i_ii)
    turn = cross(n, omega12)
    v_i, v_ii = dot(v12, i_i), dot(v12, i_ii)
    a31 = dot(turn, i_i) - k_i * v_i
    a32 = dot(turn, i_ii) - k_ii * v_ii
    with np.errstate(invalid="ignore", divide="ignore"):
        scale = 1.0 / (b3 + v_i * a31 + v_ii * a32)
        f, g, s = a31 * a32 * scale, (a31**2 - a32**2) * scale, (a31**2 + a32**2) * scale
        # (1.6.42) divides by cos(2 sigma), which may vanish; with (1.6.40) the difference is this hypotenuse
        total, difference = k_i + k_ii + s, np.hypot(2.0 * f, k_i - k_ii + g)
        sigma = 0.5 * np.arctan2(2.0 * f, k_i - k_ii + g)
    return 0.5 * (total + difference), 0.5 * (total - difference), sigma


def generated_operator(tool: Jet, state: MotionState, e1: Array, e2: Array) -> Array:
    """Shape operator (..., 2, 2), 1/mm, of the surface that `tool` generates in a motion, without that surface's jet.

    `tool` and `state` are taken at points and motion parameters that satisfy the equation of meshing; e1, e2 is a
    tangent basis of the tool in the tool frame, which the generated surface shares there. The tool needs a regular
    jet: for a sharp edge, which has none, use the envelope's. [CR3553 1.6.40-42]
    """
    own = principal(shape_operator(tool, e1, e2))
    k_iii, k_iv, sigma = generated_principal(own.k1, own.k2, *in_plane(own.angle, e1, e2), *meshing_terms(tool, state))
    return from_principal(k_iii, k_iv, own.angle + sigma)


def ellipse_from_principal(
    k_i1: ArrayLike, k_ii1: ArrayLike, k_i2: ArrayLike, k_ii2: ArrayLike, sigma: ArrayLike, delta: ArrayLike
) -> tuple[Array, Array, Array]:
    """Half axes a >= b (mm) and alpha (rad), each (...,), from principal curvatures [CR3553 1.7.29-33; LT02 34-43].

    All curvatures (1/mm) with respect to one and the same normal n; sigma (rad) from the direction of k_i1 to that of
    k_i2 and alpha from the minor axis (eta) to the direction of k_i1, both right-handed about n; delta in mm.
    """
    k_i1, k_ii1, k_i2, k_ii2 = (np.asarray(k, dtype=float) for k in (k_i1, k_ii1, k_i2, k_ii2))
    sigma, delta = np.asarray(sigma, dtype=float), np.asarray(delta, dtype=float)
    g1, g2 = k_i1 - k_ii1, k_i2 - k_ii2
    total = (k_i1 + k_ii1) - (k_i2 + k_ii2)
    # the source's total is positive; with the other sign its eta and zeta change places
    sign = np.where(total < 0.0, -1.0, 1.0)
    across, along = g2 * np.sin(2.0 * sigma), g1 - g2 * np.cos(2.0 * sigma)
    root = sign * np.hypot(across, along)  # (g1^2 - 2 g1 g2 cos(2 sigma) + g2^2)^(1/2)
    alpha = 0.5 * np.arctan2(sign * across, sign * along)  # (1.7.29)
    a_coefficient, b_coefficient = 0.25 * (total - root), 0.25 * (total + root)  # (1.7.31), (1.7.32)
    with np.errstate(divide="ignore", over="ignore"):
        return np.sqrt(delta / np.abs(a_coefficient)), np.sqrt(delta / np.abs(b_coefficient)), alpha  # (1.7.33)


def undercut_indicator(envelope: Envelope, u: Array, v: Array) -> Array:
    """(R_u x R_v) . N relative to the tool's own, (...,): 1 far from undercut, 0 on the limiting line, < 0 beyond.

    It vanishes exactly where v_r + v_12 = 0 [LF04 17.9.1-3]. Undefined (NaN) for a tool edge of radius 0.
    """
    g = envelope.generation(u, v)
    phi_u, phi_v = (-g.f_u / g.f_phi)[..., None], (-g.f_v / g.f_phi)[..., None]
    generated = cross(g.tool.r_u + g.velocity * phi_u, g.tool.r_v + g.velocity * phi_v)
    with np.errstate(invalid="ignore", divide="ignore"):
        return dot(generated, g.tool.n) / dot(area_normal(g.tool), g.tool.n)
