"""One side of a bevel gear's tooth: the flank and fillet that a machine and the blade of a head cutter leave."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.envelope.envelope import Envelope
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import ConeLevel
from gearmesh.kernel.surface.stations import along
from gearmesh.kernel.surface.surface import GeneratedSurface, PlacedSurface
from gearmesh.systems.spiral_bevel.machine.machine import MachineSettings
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth_side import ToothSide
from gearmesh.tools.head_cutter import OUTSIDE, Blade, Revolved
from gearmesh.tools.profile import Profile

if TYPE_CHECKING:
    pass

#: cradle rotation (rad) that counts as 0, before the last Newton step
AT_ZERO = 1e-12


@dataclass(frozen=True)
class Generated:
    """One side of a member: the machine and the blade that generate it, or cut it in their own shape.

    `hand` +1 right, -1 left; `mean`: mean cone distance along the root line, mm; `tip_height`: the blank's tip over the
    cutter's tip plane there, mm. The blade's edge radius may be made smaller where it does not fit and `edge_free`. `turned`: how
    far (rad) about its axis the member is turned after it was cut, for its mean point to be over the x axis.
    """

    settings: MachineSettings
    blade: Blade
    hand: int
    mean: float
    tip_height: float
    edge_free: bool = True
    turned: float = 0.0

    def with_edge(self, share: float) -> Generated:
        """The same with a share of its edge radius, where that is free."""
        return (
            replace(self, blade=replace(self.blade, edge_radius=share * self.blade.edge_radius))
            if self.edge_free
            else self
        )

    @property
    def concave(self) -> bool:
        return self.blade.side == OUTSIDE

    @property
    def flank(self) -> Side:
        """The side of the tooth: the concave one of a right-hand member is its left."""
        return Side.LEFT if self.concave == (self.hand > 0) else Side.RIGHT

    def side(self, place: float) -> ToothSide:
        """Flank and fillet, turned by a further `place` (rad) about the member's axis; v = 0 is near the mean cone distance."""
        blade = self.blade
        flank, fillet = (self.cut(profile, place) for profile in (blade.flank, blade.tip))
        kinked = blade.toprem is not None and blade.toprem.kinked
        return ToothSide(
            flank,
            fillet,
            blade.form_point,
            blade.root,
            tip=blade.at_height(self.tip_height),
            fillet_breaks=blade.tip_breaks,
            sharp=kinked,
            crossed=kinked,
            tool=blade.description,
            generation=(flank, fillet),
        )

    def at_cone_distance(self, height: float, level: ConeLevel) -> tuple[float, float]:
        """Flank parameters of the point at `height` (mm) over the tip plane where `level` is 0."""
        p = self.blade.at_height(height)
        v, _ = along(self.side(0.0).flank, np.array([p]), np.zeros(1), level)
        return p, float(v[0])

    def at_cradle_zero(self, height: float) -> tuple[float, float]:
        """Flank parameters of the point at `height` (mm) over the tip plane generated at cradle rotation 0 [AB].

        Raises NoSolutionError where the cutter generates no such point near the middle, as at small spiral angles.
        """
        flank = self.envelope(self.blade.flank)
        p = self.blade.at_height(height)

        def cradle(v: Array, _: NDArray[np.intp]) -> tuple[Array, Array]:
            generation = flank.generation(np.array([p]), v[:, 0])
            return generation.phi[:, None], (-generation.f_v / generation.f_phi)[:, None, None]

        solution = newton.solve(cradle, np.zeros((1, 1)), tolerance=AT_ZERO)
        if not solution.converged[0]:
            raise NoSolutionError(
                reason="the gear's cutter generates no mean point at cradle rotation 0",
                remedy='use mean_point = "mean_cone_distance"',
            )
        return float(p), float(solution.values[0, 0])

    def cut(self, profile: Profile, place: float) -> GeneratedSurface:
        """What a profile of the blade leaves on the member: its envelope, or of a machine that does not roll itself."""
        if self.settings.formate:
            tool = Revolved(profile, self.blade.side, self._mean_direction)
            return PlacedSurface(tool, self.settings.standing(self.hand, self.turned + place))
        return self.envelope(profile, place)

    def envelope(self, profile: Profile, place: float = 0.0) -> Envelope:
        """The envelope of a profile of the blade."""
        tool = Revolved(profile, self.blade.side, self._mean_direction)
        # as for a rack, f grows with the roll wherever the normal has a part up the tooth: blade angles are > 0
        return Envelope(tool, self.settings.motion(self.hand, self.turned + place), branch=1)

    def above_plane(self, r: Array) -> Array:
        """Heights (...,), mm, of points r (..., 3) of the own frame over the machine plane, towards the tip of the tooth."""
        own_from_machine = Rigid.about_z(self.turned) @ self.settings.own_from_machine(self.hand)
        height: Array = -own_from_machine.inverse.point(r)[..., 2]
        return height

    def base_to(self, root_angle: float, root_base: float) -> float:
        """Sliding base (mm) with which the blade, prolonged to the tip plane, ends on the root line at the mean: in the machine
        plane at the root angle (rad) with the sliding base `root_base` (mm).
        """
        v = self._mean_direction
        own = replace(self.settings, sliding_base=0.0).standing(self.hand, self.turned)
        end = own.point(self.blade.tip_radius * np.array([np.cos(v), np.sin(v), 0.0]))
        floor = np.array([-np.cos(root_angle), 0.0, np.sin(root_angle)])
        cradle = Rigid.about_z(self.turned).vector(self.settings.own_from_machine(self.hand).rotation[:, 2])
        return float((end @ floor + root_base) / (cradle @ floor))

    @cached_property
    def _mean_direction(self) -> float:
        """Angle (rad) in the cutter frame from the cutter's centre to the mean point of the root line."""
        settings = self.settings
        at = np.array([self.mean - settings.machine_centre_to_back, self.hand * settings.machining_offset, 0.0])
        away = at - settings.cutter_centre(self.hand)
        if settings.tilted:
            away = away @ settings.cutter_axes(self.hand)
        return float(np.arctan2(away[1], away[0]))
