"""Proof of a tooth's surfaces against themselves: what a surface says of its derivatives and normals must be true.

Contact, curvatures and meshes take a surface's jet as it is. A derivative or normal that is wrong gives wrong figures,
and most of them look right. Here derivatives are compared with differences of the surface's own points and normals:

    f'(x) = (8 (f(x + h) - f(x - h)) - (f(x + 2 h) - f(x - 2 h))) / (12 h) + O(h^4)

Parameters have units of their own. Errors are therefore multiplied by the range of the parameter over the tooth. Errors of
normals are in rad then; errors of points are divided by the way of the point over this range.
"""

from __future__ import annotations

import numpy as np

from gearmesh.errors import GearmeshError, KindError
from gearmesh.kernel.motion.rigid import MAX_ROTATION_ERROR, Rigid, rotation_error
from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.kernel.surface.stations import follow
from gearmesh.kernel.surface.surface import GeneratedSurface, Jet, Surface
from gearmesh.records import dataclass
from gearmesh.teeth.region import FILLET_REGIONS, FLANK_REGIONS, TIP_EDGES, Region, Side
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import ToothSide

#: shares of the way along a surface, from the end at the root, at which it is sampled; away from ends and from the middle,
#: where breaks are likely
PROOF_SHARES = np.array([0.13, 0.37, 0.61, 0.88])
#: stations t at which surfaces are sampled
PROOF_STATIONS_T = np.array([0.06, 0.34, 0.57, 0.93])
#: steps of the differences, as shares of the range of the parameter; each sample takes the two whose results agree best
STEP_SHARES = (1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 4e-3, 8e-3, 1.6e-2)
#: largest error of a derivative over the range of its parameter: a share of the way of the point, or rad of the normal
MAX_DERIVATIVE_ERROR = 1e-6
#: largest difference of the results of two steps at a sample that is used, in the same unit
MAX_ROUGHNESS = 1e-4
#: largest share of the samples of a surface that may be next to a break, where differences mean nothing
MAX_ROUGH_SHARE = 0.5
#: largest difference of a normal's length from 1
MAX_LENGTH_ERROR = 1e-9
#: largest cosine between a normal and a tangent of its surface
MAX_TANGENT_COSINE = 1e-7
#: largest distance between a point of a surface and the tool's point in its place, as a share of the largest coordinate
MAX_TOOL_MISS_SHARE = 1e-8
#: largest difference of the length of a level's gradient from 1
MAX_GRADIENT_ERROR = 1e-9


@dataclass(frozen=True)
class SurfaceProof:
    """Largest errors that were found on one surface."""

    #: the surface
    region: Region
    #: number of points at which it was sampled
    points: int
    #: error of the derivatives of the point, as a share of its way over the tooth
    point_error: float
    #: error of the derivatives of the normal over the tooth, rad
    normal_error: float
    #: difference of the length of a normal from 1
    length_error: float


@dataclass(frozen=True)
class _Samples:
    """Samples (N,) of a surface."""

    #: the surface
    surface: Surface
    #: its region
    region: Region
    #: +1 if the first parameter grows from the root to the tip, -1 if it falls
    rise: float
    #: first parameter (N,)
    u: Array
    #: second parameter (N,)
    v: Array
    #: t (N,)
    t: Array
    #: station coordinates (N,), mm
    stations: Array
    #: share (N,) of the way from the root to the tip
    share: Array
    #: jet (N,)
    jet: Jet
    #: range of each parameter over the tooth
    ranges: tuple[float, float]

    def fault(self, k: int, reason: str, must_be: str) -> KindError:
        """Return the refusal of the k-th sample."""
        where = f"at u = {self.u[k]:.6g}, v = {self.v[k]:.6g}, t = {self.t[k]:.4g} (station {self.stations[k]:.6g} mm)"
        return KindError(self.region, reason=f"{reason} {where}", must_be=must_be)


def prove_surfaces(tooth: Tooth) -> None:
    """Compare the jets of all surfaces between their nominal ends, before the tooth is trimmed.

    Raises KindError, naming surface, side and station, for the first surface that is not what it says.
    """
    tooth.prove_joined()
    for which in Side:
        for region, (surface, way) in _nominal(tooth.side(which), which).items():
            _prove_jet(_samples(tooth, surface, region, way))


def prove_tooth(tooth: Tooth) -> list[SurfaceProof]:
    """Return what is found on every surface of a tooth, between the ends that it has in the trimmed tooth.

    Raises KindError as `prove_surfaces` does, and TrimError where the tooth cannot be trimmed.
    """
    proofs = []
    for which in Side:
        side, flank, fillet = tooth.side(which), FLANK_REGIONS[which], FILLET_REGIONS[which]
        ends = tooth.ends(which, PROOF_STATIONS_T)
        surfaces = _nominal(side, which)
        trimmed = {
            flank: (ends.form_point_flank, ends.tip),
            fillet: (np.full_like(ends.tip, side.root), ends.form_point_fillet),
        }
        for region, (surface, way) in surfaces.items():
            samples = _samples(tooth, surface, region, trimmed.get(region, way))
            proofs.append(_prove_jet(samples))
            _prove_levels(tooth, samples)
            _prove_outward(tooth, which, samples)
        for region, generated in zip((flank, fillet), side.generation or (), strict=False):
            _prove_motion(generated, _samples(tooth, generated, region, trimmed[region]))
    for region, between in ((Region.ROOT, tooth.bottom), (Region.LAND, tooth.crest)):
        if between is not None:
            low, high = (np.full(PROOF_STATIONS_T.shape, end) for end in between.ends)
            proofs.append(_prove_jet(_samples(tooth, between.surface, region, (low, high))))
    return proofs


#: first parameters (T,) at both ends of a surface, the first one closer to the root
Way = tuple[Array, Array]


def _nominal(side: ToothSide, which: Side) -> dict[Region, tuple[Surface, Way]]:
    """Return the surfaces of a side by region, with their nominal ends."""
    corner = side.tip_corner
    found = {
        FLANK_REGIONS[which]: (side.flank, side.form_point[0], side.tip),
        FILLET_REGIONS[which]: (side.fillet, side.root, side.form_point[1]),
    }
    if corner is not None:
        found[TIP_EDGES[which]] = corner.surface, corner.form_point[1], corner.end
    at = np.ones_like(PROOF_STATIONS_T)
    return {region: (surface, (first * at, last * at)) for region, (surface, first, last) in found.items()}


def _samples(tooth: Tooth, surface: Surface, region: Region, way: Way) -> _Samples:
    """Return samples of a surface between both ends of its first parameter."""
    first, last = way
    share = np.repeat(PROOF_SHARES, PROOF_STATIONS_T.size)
    t = np.tile(PROOF_STATIONS_T, PROOF_SHARES.size)
    p = (first + PROOF_SHARES[:, None] * (last - first)).ravel()
    stations = tooth.stations(t)
    try:
        followed = follow(surface, p, stations, tooth.blank.axial)
    except GearmeshError as failure:
        raise KindError(region, reason=f"it cannot be evaluated: {failure}") from failure
    good = np.flatnonzero(followed.converged & np.isfinite(followed.jet.n).all(axis=-1))
    if not good.size:
        raise KindError(
            region,
            reason=f"no point of it is found for u from {p.min():.6g} to {p.max():.6g} at the stations from "
            f"{stations.min():.6g} to {stations.max():.6g} mm",
            must_be="regular near v = 0, where the search along the face begins",
        )
    v = followed.values[good]
    ranges = float(np.abs(last - first).mean()), float(np.ptp(v)) or float(np.ptp(stations))
    return _Samples(
        surface,
        region,
        float(np.sign((last - first).mean())),
        p[good],
        v,
        t[good],
        stations[good],
        share[good],
        followed.jet[good],
        ranges,
    )


def _prove_jet(samples: _Samples) -> SurfaceProof:
    """Compare normals and derivatives of a surface with its own points and normals."""
    jet = samples.jet
    length = np.linalg.norm(jet.n, axis=-1)
    k = int(np.abs(length - 1.0).argmax())
    if not abs(length[k] - 1.0) <= MAX_LENGTH_ERROR:
        raise samples.fault(k, f"its normal n has the length {length[k]:.6g}", "of length 1")
    errors: dict[str, float] = {"r": 0.0, "n": 0.0}
    for which, letter in enumerate("uv"):
        span = samples.ranges[which]
        steps = [_differences(samples, which, share * span) for share in STEP_SHARES]
        for name in errors:
            given, differences = getattr(jet, f"{name}_{letter}"), np.array([step[name] for step in steps])
            # ways of points over the range of the parameter count as 1; normals are compared in rad
            scale = span if name == "n" else 1.0 / float(np.nanmax(np.linalg.norm(differences, axis=-1)))
            rough = scale * np.linalg.norm(np.diff(differences, axis=0), axis=-1)
            rough = np.where(np.isfinite(rough), rough, np.inf)
            best, sample = rough.argmin(axis=0), np.arange(rough.shape[1])
            true, rough = differences[best, sample], rough[best, sample]
            error = np.where(rough <= MAX_ROUGHNESS, scale * np.linalg.norm(given - true, axis=-1), -np.inf)
            k = int((error - rough).argmax())
            if (error == -np.inf).mean() > MAX_ROUGH_SHARE:
                smooth = "smooth, or the places where it is not in the breaks of ToothSide"
                raise samples.fault(int(rough.argmax()), f"its {name} has no derivative by {letter}", smooth)
            if not error[k] <= MAX_DERIVATIVE_ERROR + rough[k]:
                found, wanted = (", ".join(f"{x:.4g}" for x in vector) for vector in (given[k], true[k]))
                raise samples.fault(
                    k, f"its derivative {name}_{letter} is ({found})", f"({wanted}), as differences of {name} give it"
                )
            errors[name] = max(errors[name], float(error.max()))
    tangent = np.max(
        [np.abs(dot(jet.n, along)) / np.linalg.norm(along, axis=-1) for along in (jet.r_u, jet.r_v)], axis=0
    )
    k = int(tangent.argmax())
    if not tangent[k] <= MAX_TANGENT_COSINE:
        raise samples.fault(k, f"its normal n leans by {np.degrees(np.arcsin(min(tangent[k], 1.0))):.3g} deg", "normal")
    return SurfaceProof(samples.region, samples.u.size, errors["r"], errors["n"], float(np.abs(length - 1.0).max()))


def _differences(samples: _Samples, which: int, step: float) -> dict[str, Array]:
    """Return derivatives (N, 3) of point r and normal n by parameter u (0) or v (1), from differences."""
    shift = np.array([2.0, 1.0, -1.0, -2.0])[:, None] * step
    at = [samples.u + np.zeros_like(shift), samples.v + np.zeros_like(shift)]
    at[which] = at[which] + shift
    jet = samples.surface.jet(*at)
    weights = np.array([-1.0, 8.0, -8.0, 1.0]) / (12.0 * step)
    return {name: np.tensordot(weights, getattr(jet, name), axes=1) for name in ("r", "n")}


def _prove_levels(tooth: Tooth, samples: _Samples) -> None:
    """Raise KindError where the station coordinate is no distance, or a surface lies outside of its levels."""
    blank, jet = tooth.blank, samples.jet
    lengths = np.linalg.norm(blank.axial.gradient(jet.r), axis=-1)
    k = int(np.abs(lengths - 1.0).argmax())
    if not abs(lengths[k] - 1.0) <= MAX_GRADIENT_ERROR:
        raise samples.fault(k, f"the gradient of the station coordinate `axial` has the length {lengths[k]:.6g}", "1")
    if not samples.region.is_flank:
        return
    # the flank's beginning is below the tip, its end is above the root
    for name, level, inside in (("tip", blank.tip, 1.0), ("root", blank.root, -1.0)):
        k = int((inside * samples.share).argmin())
        value = float(level.value(jet.r[[k]])[0])
        if not inside * value < 0.0:
            wanted = f"{'negative' if inside > 0.0 else 'positive'} on the flank: levels are negative inside the body"
            raise samples.fault(k, f"the level `{name}` of the blank is {value:.4g} mm", wanted)


def _prove_outward(tooth: Tooth, which: Side, samples: _Samples) -> None:
    """Raise KindError where normals of a side point into the material.

    A section runs counterclockwise round the tooth. The land's normal, which is known, says to which side of the
    section's tangent and the gradient of the stations normals point out of the material. Next to the form point an
    undercut flank runs back: the sample nearest the tip is compared.
    """
    axial, jet = tooth.blank.axial, samples.jet
    gradient = axial.gradient(jet.r)
    tangent = samples.rise * (jet.r_u - (dot(gradient, jet.r_u) / dot(gradient, jet.r_v))[:, None] * jet.r_v)
    out = dot(cross(tangent, gradient), jet.n)
    around = tooth.joint.velocity(Rigid.identity(), jet.r)
    land = dot(cross(around, gradient), tooth.blank.tip.gradient(jet.r))
    tipmost = np.flatnonzero(samples.share == samples.share.max())
    inward = tipmost[~(out * land * which.sign > 0.0)[tipmost]]
    if inward.size:
        raise samples.fault(int(inward[0]), "its normal n points into the material", "outward")


def _prove_motion(surface: GeneratedSurface, samples: _Samples) -> None:
    """Raise KindError where the motion of the tool is not rigid, or does not bring the tool to the surface."""
    place = surface.tool_to_blank(*surface.generating(samples.u, samples.v))
    off = np.broadcast_to(rotation_error(place), samples.u.shape)
    k = int(off.argmax())
    if not off[k] <= MAX_ROTATION_ERROR:
        raise samples.fault(k, "the motion of its tool, tool_to_blank, is no rigid motion", "a rotation and a shift")
    on_tool = surface.tool.jet(*surface.on_tool(samples.u, samples.v)).r
    miss = np.linalg.norm(place.point(on_tool) - surface.jet(samples.u, samples.v).r, axis=-1)
    k = int(miss.argmax())
    if not miss[k] <= MAX_TOOL_MISS_SHARE * float(np.abs(samples.jet.r).max()):
        raise samples.fault(k, f"the tool's point is {miss[k]:.3g} mm away", "on the surface that it generates")
