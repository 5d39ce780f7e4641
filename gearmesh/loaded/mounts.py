"""Elastic shafts and bearings: the forces on a member's teeth displace the member as a whole.

A mount has a compliance C (6 by 6) at a point of the axis, in the member's own frame at rotation 0. This frame does not
turn. C maps forces and moments to displacements along x, y, z and to small rotations about these axes. A unit pressure
at r_i acts on the body along its inward normal f_i. Its effect at another pressure's point r_j, along f_j, is

    w_i' C w_j,    w = (f, (r - point) x f)

This term is added to the compliance of the teeth, separately at every position. It neglects that displaced flanks touch
elsewhere. The members are therefore moved by the mean displacement over all positions in the last iteration, and only
the difference is left to the compliance. Three to four iterations converge to 1e-5 mm.

A bearing that leaves a double helical pinion free along its axis has 1000 times the compliance of the teeth. One more
cell in contact on one half then changes the axial force enough to throw the load from one half to the other and back.
Springs of stiffness H, about as stiff as the teeth, hold such members at their positions a of the last iteration:

    displacement = (K + H)^-1 (force + H a),   with (K + H)^-1 = C (1 + H C)^-1,   K = C^-1

The iteration converges to the displacement C force without springs, as a proximal point iteration of a convex problem.
Each round reduces the error by H over the sum of H and the stiffness of the teeth: to about a quarter.

A planet has two meshes. Its pin moves by C (w + v): w from the pressures of one mesh, v from those of the other. Both
meshes are solved in turns, each with the v of the last round: the energy of both falls in every round, so that the rounds
converge. Springs hold planets that tilt easily, since one mesh alone would tilt them too far.

n equal planets load a central gear at equal angles. What acts across the axis cancels, and what acts along it (P = 1 for
the axial force and the moment about the axis, else 0) adds. The mean displacement at the meshes is n P C P w.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.errors import DesignError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross
from gearmesh.lengths import Length, in_mm
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair
from gearmesh.teeth.mount import Mount

#: N/mm along the axis: springs hold double helical members whose bearings are softer than this
HOLDING_STIFFNESS = 1e5
#: displacements and rotations in which equal forces around an axis add: those along the axis
ALONG_AXIS = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 1.0])


@dataclass(frozen=True)
class FlexibleMount:
    """Compliance (6, 6), in mm/N, rad/N and rad/(N mm), of a member's mount at `z` (mm) on its axis."""

    compliance: Array
    z: float = 0.0

    @classmethod
    def of(cls, stiffness: ArrayLike, z: Length = 0.0) -> Self:
        """Return the mount with a given stiffness at a point of the axis.

        Parameters
        ----------
        stiffness : array_like, (6, 6) or (6,)
            Stiffness in N/mm, N and N mm/rad, or its diagonal, in which inf is rigid.
        z : float or str
            Position on the axis, mm, or with a unit.

        Returns
        -------
        FlexibleMount
            Mount with a symmetric, positive definite compliance.

        Raises
        ------
        DesignError
            If the stiffness is not symmetric and positive definite, or z is no length.

        Examples
        --------
        >>> shaft = gm.FlexibleMount.of([2e5, 2e5, 1e5, np.inf, np.inf, np.inf])
        """
        place = in_mm("z", z)
        given = np.asarray(stiffness, dtype=float)
        if given.shape == (6,):
            if not (given > 0.0).all():
                worst = int(np.argmin(given > 0.0))
                raise DesignError(
                    "stiffness",
                    given[worst],
                    reason=f"entry {worst + 1} of 6",
                    must_be="above 0, or inf for rigid",
                )
            return cls(np.diag(1.0 / given), place)
        if given.shape != (6, 6) or not np.isfinite(given).all():
            raise DesignError(
                "stiffness", reason=f"has shape {given.shape}; must be 6 numbers above 0 or 6 by 6 finite ones"
            )
        # scale the diagonal to 1, since entries have different units, before symmetry is tested
        size = np.sqrt(np.abs(np.diag(given)))
        scaled = given / np.maximum(np.outer(size, size), np.finfo(float).tiny)
        if (
            not np.allclose(scaled, scaled.T, rtol=0.0, atol=1e-9)
            or np.linalg.eigvalsh(0.5 * (scaled + scaled.T))[0] <= 0.0
        ):
            raise DesignError("stiffness", must_be="symmetric and positive definite")
        return cls(np.linalg.inv(0.5 * (given + given.T)), place)

    def around(self, count: int) -> Self:
        """Return the mount that each of several equal meshes at equal angles around the axis has.

        Parameters
        ----------
        count : int
            Number of the meshes.

        Returns
        -------
        FlexibleMount
            Mount that one mesh alone displaces as far as all of them displace this one, on average over the meshes.

        Examples
        --------
        >>> shaft = gm.FlexibleMount.of([2e5, 2e5, 1e5, np.inf, np.inf, np.inf])
        >>> np.diag(shaft.around(3).compliance)[:3].round(9).tolist()
        [0.0, 0.0, 3e-05]
        """
        if count == 1:
            return self
        return replace(self, compliance=count * ALONG_AXIS[:, None] * self.compliance * ALONG_AXIS)

    def wrenches(self, mount: Mount, points: Array, forces: Array) -> Array:
        """Return forces with their moments about the mount's point.

        Parameters
        ----------
        mount : Mount
            Mounting of the member.
        points, forces : array_like, (..., 3)
            Points, mm, and forces, N, in the fixed frame.

        Returns
        -------
        ndarray, (..., 6)
            Forces, N, and moments, N mm, in the frame of the mount.

        Examples
        --------
        >>> shaft = gm.FlexibleMount.of([2e5, 2e5, 1e5, np.inf, np.inf, np.inf])
        >>> shaft.wrenches(gears.member("pinion").mount, np.zeros((4, 3)), np.ones((4, 3))).shape
        (4, 6)
        """
        fixed_to_own = mount.base.inverse
        r, f = fixed_to_own.point(points) - [0.0, 0.0, self.z], fixed_to_own.vector(forces)
        return np.concatenate((f, cross(r, f)), axis=-1)

    def displace(self, mount: Mount, displacement: Array) -> Mount:
        """Return the mounting after a displacement of the mount's point.

        Parameters
        ----------
        mount : Mount
            Mounting of the member.
        displacement : ndarray, (6,)
            Translations, mm, and rotations, rad, in the frame of the mount.

        Returns
        -------
        Mount
            Displaced mounting.

        Examples
        --------
        >>> shaft = gm.FlexibleMount.of([2e5, 2e5, 1e5, np.inf, np.inf, np.inf])
        >>> moved = shaft.displace(gears.member("pinion").mount, np.array([0.01, 0, 0, 0, 0, 0]))
        """
        from scipy.spatial.transform import Rotation

        point = Rigid(np.eye(3), np.array([0.0, 0.0, self.z]))
        turn = Rotation.from_rotvec(displacement[3:]).as_matrix()
        return replace(mount, base=mount.base @ point @ Rigid(turn, displacement[:3]) @ point.inverse)


@dataclass(frozen=True)
class Supports:
    """Elastic mounts of pinion and gear, and the springs that hold the members during the iteration."""

    #: mounts of pinion and gear without load
    mounts: tuple[Mount, Mount]
    #: compliance of each mount; None if rigid
    flexible: tuple[FlexibleMount | None, FlexibleMount | None]
    #: displacement (2, 6), mm and rad, by which the members have been moved already
    displacement: Array
    #: stiffness (2, 6), N/mm and N mm/rad, of the springs that hold the members at `anchor`
    holding: Array
    #: displacements (P, 2, 6), mm and rad, of the members in the last iteration
    anchor: Array
    #: forces and moments (P, 2, 6), N and N mm, of other meshes on the members
    others: Array

    @classmethod
    def of(
        cls,
        gears: GearPair,
        flexible: tuple[FlexibleMount | None, FlexibleMount | None],
        positions: int,
        *,
        both_hands: bool,
        tilting: tuple[int, float] | None = None,
    ) -> Self:
        """Return the mounts of a pair that is not displaced yet, for a number of `positions`.

        - `both_hands`: True if teeth of both hands fix the pair along its axis.
        - `tilting`: number of a member that another mesh loads too, and its face width, mm.
        """
        wanted = np.zeros((2, 6))
        if both_hands:
            wanted[:, 2] = HOLDING_STIFFNESS
        if tilting is not None:
            member, face = tilting
            # of springs that are spread over the face
            wanted[member, 3:5] = HOLDING_STIFFNESS * face**2 / 12.0
        compliance = np.stack([np.zeros(6) if mount is None else np.diag(mount.compliance) for mount in flexible])
        holding = np.where(compliance * wanted > 1.0, wanted, 0.0)
        none = np.zeros((positions, 2, 6))
        return cls(gears.mounts, flexible, np.zeros((2, 6)), holding, none, none)

    def at_positions(self, positions: NDArray[np.bool_]) -> Self:
        """Return the supports at some of the positions (P,)."""
        return replace(self, anchor=self.anchor[positions], others=self.others[positions])

    def displace(self, gears: GearPair, displacements: Array) -> tuple[Self, GearPair]:
        """Return the supports and the pair after displacements (P, 2, 6).

        The members move by the mean over the positions. `gears` are the members without load.
        """
        displacement = displacements.mean(axis=0)
        pinion, gear = (
            member if mount is None else replace(member, mount=mount.displace(member.mount, member_displacement))
            for member, mount, member_displacement in zip(gears.both, self.flexible, displacement, strict=True)
        )
        return replace(self, displacement=displacement, anchor=displacements), replace(gears, pinion=pinion, gear=gear)

    def wrenches(self, points: Array, normals: Array) -> Array:
        """Return wrenches (2, ..., 6) of unit pressures at points (..., 3) on both members.

        The pressures are along normals (..., 3) out of the pinion. Wrenches are 0 for rigid mounts.
        """
        unit_wrenches = np.zeros((2, *points.shape[:-1], 6))
        for k, (mount, flexible_mount, sense) in enumerate(zip(self.mounts, self.flexible, (-1.0, 1.0), strict=True)):
            if flexible_mount is not None:
                unit_wrenches[k] = flexible_mount.wrenches(mount, points, sense * normals)
        return unit_wrenches

    @property
    def held(self) -> bool:
        """True if a spring holds a member."""
        return bool(self.holding.any())

    @property
    def compliance(self) -> Array:
        """Compliance (2, 6, 6) of both mounts together with the springs: C (1 + H C)^-1."""
        own = np.stack([np.zeros((6, 6)) if own is None else own.compliance for own in self.flexible])
        return own @ self._share if self.held else own

    @property
    def _share(self) -> Array:
        """Factor (1 + H C)^-1 (2, 6, 6) by which the springs reduce a mount's compliance."""
        own = np.stack([np.zeros((6, 6)) if own is None else own.compliance for own in self.flexible])
        return np.asarray(np.linalg.inv(np.eye(6) + self.holding[:, :, None] * own), dtype=float)

    @property
    def pull(self) -> Array:
        """Displacements (P, 2, 6), mm and rad, that springs and other meshes cause: C (1 + H C)^-1 (H a + v)."""
        return np.asarray((self.compliance @ (self.holding * self.anchor + self.others)[..., None])[..., 0])
