"""Compliance of teeth under loads on their flanks: bending, shear, base and body of a whole gear, from one tooth of it.

All teeth of a gear are one tooth, turned. Its sector with the rim under it, held at the rim's inner face, is condensed onto its two
cut faces and the nodes of the loaded flank; the ring of z sectors is block-circulant, so that a Fourier series over the teeth gives
the whole gear exactly: there are no cut faces that could matter. Of a body with a web only what lies within its profile is stiff;
elements that its edge goes through are as stiff as the share of them that does. With q_j the displacements of the cut before sector
j in its own frame, T the turn by a pitch, S the sector's stiffness to its right and left cut, and g what loads put on them,

    S_RR q_j + S_RL T q_(j+1) + T' S_LR q_(j-1) + T' S_LL T q_j = g_R,j + T' g_L,(j-1)

and for harmonic k, in which q_(j+1) = q_j exp(2 pi i k / z), one system of the size of a cut.

The teeth of a bar that slides are such a ring too, without rotation: held at its back, it is hardly affected by loads a few
heights away, and is modelled as endless.

Nodes of a flank are coarse: the local contact deflection round a load is wrong. It is removed by solving the same elements between
the flank and the middle of the tooth once more with all beyond them held, and replaced by half-space theory, less the deflection
of that at the middle:

    compliance = C(gear) - L(held at the middle) - u(half-space, at the middle) + u(half-space, at the flank)

The last term belongs to the contact's own grid (`contact_compliance`); all others are smooth and are kept here. The third is
transferred from the middle to the flank by the elements themselves, so that the sum does not depend on where the middle is taken.

Finite-element models have a few teeth only, whose cut faces are held. The same condensed sectors in a row, the first and last cut
held, are those bodies (`HeldTeeth`): what is compared with such a model must be held like it.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from threading import Lock
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.hertz import Material
from gearmesh.errors import DesignError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, unit
from gearmesh.loaded.compliance.half_space import point_displacements
from gearmesh.loaded.compliance.incompatible_modes import CORNERS, corner_stresses, stiffness, unknowns
from gearmesh.loaded.compliance.layers import LayeredStiffness
from gearmesh.loaded.compliance.quarter_space import release
from gearmesh.loaded.compliance.sector_grid import CROWDED_WEB, FilletSize, sector_grid
from gearmesh.loaded.compliance.threads import one_thread
from gearmesh.loaded.root_tangent import tangent_weights
from gearmesh.mesh.hexahedra.hexahedra import Cells, hex_mesh, on_breaks, on_stations, usual_rim, whole_rim
from gearmesh.mesh.hexahedra.hexes import HexMesh
from gearmesh.mesh.hexahedra.layers import layers, running_angle
from gearmesh.progress import go_on
from gearmesh.teeth.blank.body import Disc
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Index = NDArray[np.int64]

#: elements of a sector by default, and three quarters of them each way, whose root stress tells how far the first is from its limit
CELLS = Cells(flank=8, fillet=12, thickness=4, rim=5, face=11)
COARSER = Cells(flank=6, fillet=9, thickness=3, rim=4, face=8)
#: so many rings are kept, some 10 MB each
KEPT = 16
_RINGS: dict[tuple[bytes, int, int, int | None, bool], tuple[Array, Array]] = {}
_KEEPING = Lock()
#: teeth at least after which those of a bar come round again, far enough away to do nothing
BAR = 30
#: points on the way to the next node over which a node's force is spread
SPREAD = 4
#: elements from root to bore of a body with a web
WEBBED = 12
#: points in each direction of an element at which it is asked whether there is material; share of it below which there is none
ASKED, EMPTY = 4, 0.02
#: nodes of two meshes that are the same, mm
SAME = 1e-6


@dataclass(frozen=True)
class EndPlane:
    """A plane through `middle` (3,) with the outward normal `out` (3,)."""

    middle: Array
    out: Array

    def images(self, places: Array, ways: Array) -> tuple[Array, Array]:
        """Places (..., 3) and directions (..., 3) mirrored at the plane."""
        away = (places - self.middle) @ self.out
        return places - 2.0 * away[..., None] * self.out, ways - 2.0 * (ways @ self.out)[..., None] * self.out


@dataclass(frozen=True)
class FilletStress:
    """How loads on a flank stress the fillet below it; all in the member's own frame.

    `points` (I, J, 3): nodes of the flank, form point to tip by toe to heel, n = I J. `stress` (2 N + 1, F, 6, n), MPa/N:
    stresses, own frame of each tooth, at nodes `fillet` (F, 3) of the fillet on the loaded side, of teeth -N .. N from the
    loaded one, counted the way it moves, under unit forces into the body at the flank's nodes (last index); `tangent` (K, F)
    makes of them those where the tangent is at 30 deg (`root_tangent`), station by station. `eighth`: mean height, mm, of the
    flank's lowest eighth, an element of even lines.
    """

    tooth: Tooth
    points: Array
    fillet: Array
    stress: Array
    tangent: Array
    eighth: float

    @property
    def reach(self) -> int:
        """Teeth N on either side of the loaded one."""
        return len(self.stress) // 2

    def of_tooth(self, loaded: int) -> FilletStress:
        """The same where tooth `loaded`, counted the way it moves, is loaded: of a whole gear it is alike for all."""
        return self

    def along_helix(self, turned: Array, places: Array) -> Rigid:
        """Motions (M,) to the frame in which `points` are from the tooth's own, turned by angles (M,), rad; places (M, X, 3) of it.

        Of threads an arc about the x axis is known, and a thread is the same after a screw motion along its helix.
        """
        screw = self.tooth.screw
        if screw is None:
            return Rigid.identity()
        here = running_angle(self.tooth, places).mean(axis=1) + turned
        angle = turned - 2.0 * np.pi * np.round(np.median(here) / (2.0 * np.pi))
        about = Rigid.about_z(angle)
        return Rigid(about.rotation, angle[:, None] * np.array([0.0, 0.0, screw]))

    @cached_property
    def ends(self) -> tuple[EndPlane, EndPlane]:
        """Planes of the end faces at toe and heel, at right angles to the flank."""
        toe, heel = (
            EndPlane(self.points[:, end].mean(axis=0), unit((self.points[:, end] - self.points[:, inner]).mean(axis=0)))
            for end, inner in ((0, 1), (-1, -2))
        )
        return toe, heel

    def shares(self, places: Array) -> tuple[Index, Array]:
        """Nodes (..., 4) about places (..., 3) on the flank, own frame, and what they take (..., 4) of a load there."""
        station, height = self._coordinates(places)
        stations, heights = self._table
        column = np.clip(np.searchsorted(stations, station) - 1, 0, len(stations) - 2)
        y = np.clip((station - stations[column]) / (stations[column + 1] - stations[column]), 0.0, 1.0)
        lines = (1.0 - y) * heights[:, column] + y * heights[:, column + 1]
        row = np.clip((lines < height).sum(axis=0) - 1, 0, len(heights) - 2)
        low, high = (np.take_along_axis(lines, (row + k)[None], axis=0)[0] for k in (0, 1))
        x = np.clip((height - low) / (high - low), 0.0, 1.0)
        count = len(stations)
        nodes = np.stack([(row + i) * count + column + j for i in (0, 1) for j in (0, 1)], axis=-1)
        return nodes, np.stack([a * b for a in (1.0 - x, x) for b in (1.0 - y, y)], axis=-1)

    @cached_property
    def _table(self) -> tuple[Array, Array]:
        """Stations (J,) of the nodes and their heights (I, J), both rising, mm."""
        stations, heights = self._coordinates(self.points)
        return stations[0], heights

    def _coordinates(self, places: Array) -> tuple[Array, Array]:
        """Places (..., 3) along the face, and from form point to tip, mm, both rising; of threads round the axis, rad."""
        blank = self.tooth.blank
        if self.tooth.screw is not None:
            return np.sign(self.tooth.screw) * np.arctan2(places[..., 1], places[..., 0]), np.hypot(
                places[..., 0], places[..., 1]
            )
        (toe, heel), up = (
            blank.extent,
            np.sign(blank.across.value(self.points[-1, 0]) - blank.across.value(self.points[0, 0])),
        )
        return np.sign(heel - toe) * blank.axial.value(places), up * blank.across.value(places)


@dataclass(frozen=True)
class FlankCompliance(FilletStress):
    """A loaded flank and its compliance.

    `normals` (I, J, 3), out of the body. `smooth` (2 N + 1, n, n), mm/N: displacements into the body, along the normals, of the
    flank's nodes (first index) of teeth -N .. N from the loaded one under unit forces at its nodes (last index), without the
    local contact compliance of the loaded tooth. `coarser`: the stress of a coarser mesh of the same body, to estimate the error.
    """

    normals: Array
    smooth: Array
    coarser: FilletStress | None = None

    def of_tooth(self, loaded: int) -> FlankCompliance:
        """The compliance where tooth `loaded`, counted the way it moves, is loaded: of a whole gear the same for all."""
        return self


@dataclass(frozen=True)
class HeldTeeth(FlankCompliance):
    """A few teeth with the rim under them, the cut faces held as well; loads are on the middle one, with `of_teeth` (K,) on each.

    Teeth that the body does not have neither move nor have stress; loads on them count as on the last one.
    """

    of_teeth: tuple[FlankCompliance, ...] = ()

    def of_tooth(self, loaded: int) -> FlankCompliance:
        middle = len(self.of_teeth) // 2
        return self.of_teeth[min(max(loaded + middle, 0), 2 * middle)]


def rim_depth(tooth: Tooth, cells: Cells = CELLS) -> float:
    """Depth, mm, under the root at which a gear is held by its rim: 1.2 whole depths, less where the body has less."""
    return usual_rim(without_web(tooth), np.linspace(0.0, 1.0, cells.face + 1))


@one_thread()
def flank_compliance(
    tooth: Tooth,
    side: Side,
    material: Material,
    cells: Cells = CELLS,
    rim: float | None = None,
    depth: int | None = None,
    reach: int = 3,
    coarser: Cells | None = None,
    *,
    idler: bool = False,
) -> FlankCompliance:
    """Compliance of a flank of a gear that is held `rim` mm under the root, by default at the bore, without one near the axis.

    No torque reaches the bore of an `idler`: the same load, pulling half a turn away, is its other mesh. The bore has the sum of
    both tangential forces, as the pin of a planet has; that the radial one of the other mesh has the other sense is neglected.

    `depth`: how many elements under the flank are held for the local compliance, those up to the tooth's middle at most and by
    default; `reach`: teeth on either side of the loaded one; `coarser`: elements of the mesh that estimates how far root stress
    is from convergence, by default none.
    """
    deep = whole_rim(without_web(tooth), np.linspace(0.0, 1.0, cells.face + 1)) if rim is None else rim
    around = np.inf if tooth.screw is not None else tooth.joint.cycle(tooth.teeth)
    count = int(min(around, max(tooth.teeth, BAR)))

    def of(wanted: Cells, dented: bool) -> tuple[Sector, FilletStress, Array]:
        sector = Sector.of(tooth, side, material, wanted, deep)
        smooth, stress = _ring_responses(
            sector, count, reach, (depth or sector.inwards) if dented else None, idler=idler
        )
        return sector, sector.fillet_stress(tooth, stress), smooth

    sector, stressed, smooth = of(cells, True)
    less = None if coarser is None else of(coarser, False)[1]
    return FlankCompliance(**vars(stressed), normals=sector.normals, smooth=smooth, coarser=less)


@one_thread()
def held_teeth(
    tooth: Tooth, side: Side, material: Material, cells: Cells = CELLS, rim: float | None = None, teeth: int = 3
) -> HeldTeeth:
    """Compliance of a flank of an odd number of `teeth`, cut out of a gear with a rim of `rim` mm, by default as thick as that of
    `hex_mesh`, and held at its inner face and at the cut faces.

    Raises DesignError for an even number of teeth or one that the gear does not have.
    """
    if teeth % 2 == 0 or not 0 < teeth < tooth.teeth:
        raise DesignError("teeth", teeth, must_be=f"an odd number below {tooth.teeth}, what the gear has")
    sector = Sector.of(tooth, side, material, cells, rim)
    body, local = Condensed.of(sector), _contact_compliance(sector, sector.inwards)
    cuts = _held_cuts(body.stiffness, body.loads, sector.turn, teeth)
    of_teeth = tuple(
        FlankCompliance(**vars(sector.fillet_stress(tooth, stress)), normals=sector.normals, smooth=smooth)
        for smooth, stress in (body.responses(of_each, local) for of_each in cuts)
    )
    return HeldTeeth(**vars(of_teeth[teeth // 2]), of_teeth=of_teeth)


def _ring_responses(sector: Sector, teeth: int, reach: int, depth: int | None, *, idler: bool) -> tuple[Array, Array]:
    """`smooth` (None is the `depth` of those whose local compliance is kept) and `stress` of a ring of sectors; those of the last
    `KEPT` rings are kept: other torques, positions, assemblies and mounts of the same teeth ask again for what takes longest."""
    body = sector.stiffness
    parts = (
        sector.mesh.nodes,
        body.data,
        body.indices,
        body.indptr,
        sector.flank,
        sector.normals,
        sector.fillet,
        sector.held,
    )
    key = (
        hashlib.sha256(b"".join(np.ascontiguousarray(part).tobytes() for part in parts)).digest(),
        teeth,
        reach,
        depth,
        idler,
    )
    responses = _RINGS.get(key)
    if responses is None:
        condensed = Condensed.of(sector)
        cuts = _cuts(condensed.stiffness, condensed.loads, sector.turn, teeth, reach, idler=idler)
        count = sector.flank.size
        responses = condensed.responses(
            cuts, np.zeros((count, count)) if depth is None else _contact_compliance(sector, depth)
        )
        for response in responses:
            response.setflags(write=False)
        # members are asked for side by side
        with _KEEPING:
            _RINGS[key] = responses
            while len(_RINGS) > KEPT:
                del _RINGS[next(iter(_RINGS))]
    return responses


@dataclass(frozen=True)
class Sector:
    """One tooth of a member with its rim: its mesh and stiffness, stations `t` (J,), nodes `flank` (I, J) with `points` and
    `normals`, of the cuts `right`, `left` (C,) in the same order, of the rim's inner face `held`, of the fillet on the loaded side;
    `turn`: by a pitch; `inwards`: elements from flank to middle."""

    mesh: HexMesh
    material: Material
    stiffness: csr_array
    layers: int
    side: Side
    t: Array
    flank: Index
    points: Array
    normals: Array
    right: Index
    left: Index
    held: Index
    fillet: Index
    turn: Array
    inwards: int

    @staticmethod
    def of(tooth: Tooth, side: Side, material: Material, cells: Cells, rim: float | None) -> Sector:
        web = tooth.blank.body.web
        if web is None:
            grid = sector_grid(tooth, side, cells)
        else:
            toe, heel = tooth.blank.extent
            faces = (np.array([web.low, web.high]) - toe) / (heel - toe)
            wanted = replace(cells, rim=max(cells.rim, WEBBED))
            grid = on_stations(sector_grid(tooth, side, wanted, CROWDED_WEB), faces)
        grid = on_breaks(tooth, grid)
        # elements go through the recesses too
        mesh = hex_mesh(without_web(tooth), np.array([0]), grid, rim)
        parts = np.ones(len(mesh.elements)) if web is None else inside(web, mesh.nodes[mesh.elements])
        # nodes without material move with nothing and hold nothing
        bare = np.setdiff1d(np.arange(len(mesh.nodes)), mesh.elements[parts > 0.0])
        sections = layers(tooth, grid.t)
        exact, step = sections.flank(side, grid.lines.flank), sections.step
        held = np.union1d(mesh.node_sets["rim"], bare)
        right = np.setdiff1d(mesh.node_sets["cut_right"], held)
        left = np.setdiff1d(mesh.node_sets["cut_left"], held)
        return Sector(
            mesh,
            material,
            assemble(mesh, material, parts),
            len(grid.t),
            side,
            grid.t,
            _node_numbers(mesh.nodes, exact.points),
            exact.points,
            exact.normals,
            right,
            left[_node_numbers(mesh.nodes[left], step.point(mesh.nodes[right]))],
            held,
            mesh.node_sets[f"fillet_{side}_1"],
            step.rotation,
            len(grid.lines.thickness) - 1,
        )

    @property
    def layer(self) -> Index:
        """Layer (N,) of each node, from toe to heel."""
        return np.arange(len(self.mesh.nodes)) // (len(self.mesh.nodes) // self.layers)

    @property
    def presses(self) -> csr_array:
        """Unit forces (3 N, n) into the body on the flank's nodes."""
        return _columns(unknowns(self.flank.reshape(-1, 1)), -self.normals.reshape(-1, 3), 3 * len(self.mesh.nodes))

    def fillet_stress(self, tooth: Tooth, stress: Array) -> FilletStress:
        """The fillet with its `stress` (2 N + 1, F, 6, n)."""
        fillet = self.mesh.nodes[self.fillet]
        tangent, size = tangent_weights(tooth, self.side, self.t, fillet), FilletSize.of(tooth, self.side)
        return FilletStress(tooth, self.points, fillet, stress, tangent, size.eighth)

    @property
    def stresses(self) -> csr_array:
        """Stresses (3 N, 6 F) at the fillet's nodes, the mean of the elements there, as sums over displacements."""
        from scipy.sparse import coo_array, csr_array

        touching = np.isin(self.mesh.elements, self.fillet)
        element, corner = np.nonzero(touching)
        own, where = np.unique(element, return_inverse=True)
        node = np.searchsorted(self.fillet, self.mesh.elements[element, corner])
        parts = corner_stresses(self.mesh.nodes[self.mesh.elements[own]], self.material)[where, corner]
        parts /= np.bincount(node)[node][:, None, None]
        rows = np.repeat(unknowns(self.mesh.elements[element])[:, None], 6, axis=1)
        columns = np.broadcast_to((6 * node[:, None] + np.arange(6))[:, :, None], rows.shape)
        shape = (3 * len(self.mesh.nodes), 6 * len(self.fillet))
        return csr_array(coo_array((parts.ravel(), (rows.ravel(), columns.ravel())), shape=shape))


def without_web(tooth: Tooth) -> Tooth:
    """The tooth of a body whose recesses are filled."""
    blank = tooth.blank
    return tooth if blank.body.web is None else replace(tooth, blank=replace(blank, body=blank.body.without_web))


def inside(web: Disc, corners: Array) -> Array:
    """Shares (E,) of elements with corners (E, 8, 3), mm, that are hub, web or rim, not recess."""
    steps = (np.arange(ASKED) + 0.5) * 2.0 / ASKED - 1.0
    places = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 1, 3)
    points = np.prod(1.0 + CORNERS * places, axis=-1) / 8.0 @ corners
    rho, z = np.hypot(points[..., 0], points[..., 1]), points[..., 2]
    recess = (rho > web.inner) & (rho < web.outer) & ((z < web.low) | (z > web.high))
    share = 1.0 - recess.mean(axis=1)
    return np.where(share < EMPTY, 0.0, share)


def assemble(mesh: HexMesh, material: Material, shares: Array | None = None) -> csr_array:
    """Stiffness (3 N, 3 N), N/mm, of a mesh of hexahedra, or of `shares` (E,) of them."""
    from scipy.sparse import coo_array, csr_array

    parts, own = stiffness(mesh.nodes[mesh.elements], material), unknowns(mesh.elements)
    if shares is not None:
        parts *= shares[:, None, None]
    rows, columns = np.repeat(own, 24, axis=1), np.tile(own, (1, 24))
    shape = (3 * len(mesh.nodes),) * 2
    return csr_array(coo_array((parts.ravel(), (rows.ravel(), columns.ravel())), shape=shape))


@dataclass(frozen=True)
class Condensed:
    """A sector condensed to its two cuts (2 c unknowns, the right one first): their `stiffness` (2 c, 2 c), what presses and what
    is `asked` for on them (2 c, n + 6 F); `inner` (n + 6 F, n): what is found with both cuts held."""

    sector: Sector
    stiffness: Array
    asked: Array
    inner: Array

    @staticmethod
    def of(sector: Sector) -> Condensed:
        from scipy.sparse import csr_array, hstack

        right, left, held = (unknowns(nodes[:, None]).ravel() for nodes in (sector.right, sector.left, sector.held))
        cut = np.concatenate((right, left))
        layer = np.repeat(sector.layer, 3)
        layer[held] = layer[cut] = -1
        presses, stresses, whole = sector.presses, sector.stresses, sector.stiffness
        loads = [whole[:, cut], presses, stresses]
        columns = np.cumsum([0, *(load.shape[1] for load in loads)])
        y = LayeredStiffness.of(whole, layer).forward(csr_array(hstack(loads)))
        on_cut, pressed, asked = (y[:, low:high] for low, high in pairwise(columns))
        # what may be loaded on the cuts themselves, and is asked for there
        direct = np.concatenate((presses[cut].toarray(), stresses[cut].toarray()), axis=1)
        wanted = np.concatenate((pressed, asked), axis=1)
        condensed = whole[cut][:, cut].toarray() - on_cut.T @ on_cut
        go_on()
        asked_of_cuts = direct - on_cut.T @ wanted
        go_on()
        return Condensed(sector, condensed, asked_of_cuts, wanted.T @ pressed)

    @property
    def loads(self) -> Array:
        """What unit forces on the flank's nodes put on the cuts (2 c, n)."""
        return self.asked[:, : self.inner.shape[1]]

    def responses(self, cuts: Array, local: Array) -> tuple[Array, Array]:
        """`smooth` and `stress` of the body in which both cuts of the sectors -N .. N move by `cuts` (2 N + 1, 2 c, n) under unit
        forces on sector 0; `local` (n, n) are added."""
        count, reach = self.inner.shape[1], len(cuts) // 2
        asked = self.asked.T @ cuts
        asked[reach] += self.inner
        smooth = asked[:, :count]
        smooth[reach] += local
        smooth[reach] = 0.5 * (smooth[reach] + smooth[reach].T)
        return smooth, asked[:, count:].reshape(2 * reach + 1, len(self.sector.fillet), 6, count)


def _cuts(condensed: Array, loads: Array, turn: Array, teeth: int, reach: int, *, idler: bool = False) -> Array:
    """Displacements (2 N + 1, 2 c, n) of both cuts of the sectors -N .. N, each in its own frame, under loads (2 c, n) on those of
    sector 0; `condensed` (2 c, 2 c) is the stiffness of a sector to its cuts, the right one first. Of an
    `idler` sector 0 is loaded so and its opposite one the other way: half a turn is (-1)^k of harmonic k."""
    from scipy.linalg import cho_factor, cho_solve

    own, coupling, first, last = _row(condensed, loads, turn)
    half = len(own)
    places = np.arange(-reach, reach + 2)
    cuts = np.zeros((len(places), half, loads.shape[1]))
    for k in range(1 if idler else 0, teeth // 2 + 1, 2 if idler else 1):
        go_on()
        phase = np.exp(2j * np.pi * k / teeth)
        system = own + phase * coupling + np.conj(phase) * coupling.T
        solved = cho_solve(cho_factor(system, lower=True, check_finite=False), first + last / phase, check_finite=False)
        share = (1.0 if k in (0, teeth / 2) else 2.0) * (2.0 if idler else 1.0) / teeth
        for row, place in enumerate(places):
            cuts[row] += share * (solved * phase**place).real
    return _both(cuts, turn)


def _held_cuts(condensed: Array, loads: Array, turn: Array, teeth: int) -> Array:
    """As `_cuts`, of a row of K = `teeth` sectors of which the outer cuts are held, with each of them loaded in turn: (K, 2 K - 1,
    2 c, n), of the sectors 1 - K .. K - 1 from the loaded one; 0 where the row has none."""
    from scipy.linalg import cho_factor, cho_solve

    own, coupling, first, last = _row(condensed, loads, turn)
    half, inner = len(own), teeth - 1
    matrix = np.zeros((inner, half, inner, half))
    right = np.zeros((inner + 2, half, teeth, loads.shape[1]))
    for k in range(inner):
        matrix[k, :, k] = own
        if k:
            matrix[k - 1, :, k], matrix[k, :, k - 1] = coupling, coupling.T
    for k in range(teeth):
        right[k, :, k], right[k + 1, :, k] = first, last
    size = inner * half
    moved = np.zeros((teeth, 2 * teeth, half, loads.shape[1]))
    if inner:
        factor = cho_factor(matrix.reshape(size, size), lower=True, check_finite=False)
        solved = cho_solve(factor, right[1:-1].reshape(size, -1), check_finite=False).reshape(inner, half, teeth, -1)
        # the first of the inner cuts is that before sector 1
        go_on()
        for k in range(teeth):
            moved[k, teeth - k : teeth - k + inner] = solved[:, :, k]
    return np.stack([_both(row, turn) for row in moved])


def _row(condensed: Array, loads: Array, turn: Array) -> tuple[Array, Array, Array, Array]:
    """Of sectors side by side: stiffness (c, c) of a cut to itself and to the next one, each in the frame of the sector that begins
    there, and what loads (2 c, n) of a sector put on its own first cut and on the next sector's."""
    half = len(condensed) // 2
    right, left = slice(0, half), slice(half, None)
    coupling = _rotate(condensed[right, left].T, turn.T).T
    own = condensed[right, right] + _rotate(_rotate(condensed[left, left], turn.T).T, turn.T).T
    return own, coupling, loads[right], _rotate(loads[left], turn.T)


def _both(cuts: Array, turn: Array) -> Array:
    """Both cuts (K, 2 c, n) of K sectors, each in its own frame, from the right ones (K + 1, c, n) in theirs."""
    return np.stack([np.concatenate((a, _rotate(b, turn))) for a, b in pairwise(cuts)])


def _rotate(columns: Array, by: Array) -> Array:
    """Columns (3 K, n) of vectors, each turned by `by` (3, 3)."""
    turned: Array = by @ columns.reshape(len(columns) // 3, 3, -1)
    return turned.reshape(len(columns), -1)


def _contact_compliance(sector: Sector, depth: int) -> Array:
    """What has to be added (n, n), mm/N, to responses of the gear to remove the local compliance of its elements: - L - u of the
    middle."""
    from scipy.sparse import csr_array, hstack

    mesh, steps = sector.mesh, sector.layers - 1
    outer = [mesh.face_sets[f"{name}_{sector.side}_1"][:, 0] for name in ("flank", "fillet")]
    if "edge" in mesh.face_sets:
        edge = mesh.face_sets["edge"][:, 0]
        outer.append(edge[np.isin(mesh.elements[edge], sector.flank).any(axis=1)])
    # elements under each other follow at the number of elements from toe to heel
    near = np.unique(np.concatenate(outer)[:, None] + steps * np.arange(depth))
    beyond = np.setdiff1d(np.arange(len(mesh.elements)), near)
    free = np.setdiff1d(mesh.elements[near], mesh.elements[beyond])
    base = np.intersect1d(mesh.elements[near], mesh.elements[beyond])
    layer = np.full(len(mesh.nodes), -1)
    layer[free] = sector.layer[free]
    held = unknowns(base[:, None]).ravel()
    loads = csr_array(hstack([sector.presses, sector.stiffness[:, held]]))
    y = LayeredStiffness.of(sector.stiffness, np.repeat(layer, 3)).forward(loads)
    count = sector.flank.size
    pressed, carried = y[:, :count], y[:, count:]
    return -pressed.T @ pressed + (pressed.T @ carried) @ _half_spaces(sector, base)


def _half_spaces(sector: Sector, nodes: Index) -> Array:
    """Displacements (3 K, n), mm/N, of nodes (K,) in half-spaces that are pressed at the flank's nodes, each along its normal, and
    that end at toe and heel.

    Lines of contact run more along the face than up the profile: a node's force is spread along the face, falling to 0 at the next
    nodes, as that of a line of contact is shared by `FlankCompliance.shares`.
    """
    into = -sector.normals
    first = unit(np.cross(into, np.eye(3)[np.abs(into).argmin(axis=-1)]))
    frames = np.stack((first, np.cross(into, first), into), axis=-1)
    images = [_Images.of(sector, nodes, end, inner) for end, inner in ((0, 1), (-1, -2))]
    count, columns = sector.flank.shape
    total = np.zeros((count, columns, len(nodes), 3))
    weight = np.zeros(columns)
    for step in (-1, 1):
        inner = np.s_[1:] if step < 0 else np.s_[:-1]
        ends = sector.points[:, :-1] if step < 0 else sector.points[:, 1:]
        for way in (np.arange(SPREAD) + 0.5) / SPREAD:
            start = sector.points[:, inner] + way * (ends - sector.points[:, inner])
            moved = _surface_displacements(
                sector.mesh.nodes[nodes] - start[:, :, None], frames[:, inner], sector.material
            )
            for image in images:
                moved += image.displacements(start, frames[:, inner])
            total[:, inner] += (1.0 - way) * moved
            weight[inner] += 1.0 - way
    total /= weight[:, None, None]
    return total.reshape(count * columns, -1).T


def _surface_displacements(place: Array, frames: Array, material: Material) -> Array:
    """Displacements (I, J, K, 3), mm/N, at places (I, J, K, 3) from unit forces along the third axes of frames (I, J, 3, 3)."""
    own = place @ frames
    # flanks are not flat: what lies above the plane counts as on it
    own[..., 2] = np.maximum(own[..., 2], 0.0)
    return point_displacements(own, material) @ frames.swapaxes(-1, -2)


@dataclass(frozen=True)
class _Images:
    """Nodes (K,) of a tooth mirrored at one of its end faces, a plane through the end of each row (I,) of the flank at right angles
    to the row: `mirrored` (I, K, 3); `middle` (I, 3) and outward normals `out` (I, 3) of the planes; `x` (I, K), mm: distances."""

    mirrored: Array
    middle: Array
    out: Array
    x: Array
    material: Material

    @staticmethod
    def of(sector: Sector, nodes: Index, end: int, inner: int) -> _Images:
        middle = sector.points[:, end]
        out = unit(middle - sector.points[:, inner])
        x = np.einsum("ik,ink->in", out, middle[:, None] - sector.mesh.nodes[nodes])
        mirrored = sector.mesh.nodes[nodes] + 2.0 * x[..., None] * out[:, None]
        return _Images(mirrored, middle, out, np.maximum(x, 0.0), sector.material)

    def displacements(self, start: Array, frames: Array) -> Array:
        """What the end adds (I, J, K, 3), mm/N, to displacements from forces at `start` (I, J, 3) on a half-space.

        At the surface that is `quarter_space`'s; deeper places are taken to be as much held back as those that are as far along
        the edge.
        """
        place, out = self.mirrored[:, None] - start[:, :, None], self.out[:, None, None]
        image = _surface_displacements(place, frames, self.material)
        image -= 2.0 * (image @ self.out[:, None, :, None]) * out
        both = np.maximum((place * out).sum(axis=-1), SAME)
        beside = np.sqrt(np.maximum((place**2).sum(axis=-1) - both**2, 0.0))
        m = np.minimum(np.abs(2.0 * self.x[:, None] - both) / both, 1.0)
        held = np.polynomial.polynomial.polyval(
            m**2, release(np.arctan2(beside, both), self.material.poisson_ratio), tensor=False
        )
        added: Array = (1.0 + held)[..., None] * image
        return added


def _node_numbers(nodes: Array, places: Array) -> Index:
    """Numbers (...,) of the nodes (N, 3) at places (..., 3)."""
    from scipy.spatial import cKDTree

    distance, number = cKDTree(nodes).query(places)
    assert distance.max() < SAME, "the mesh has no nodes there"
    return np.asarray(number, dtype=np.int64)


def _columns(rows: Index, values: Array, count: int) -> csr_array:
    """A matrix (count, n) with `values` (n, K) in `rows` (n, K) of its columns."""
    from scipy.sparse import coo_array, csr_array

    columns = np.broadcast_to(np.arange(len(rows))[:, None], rows.shape)
    return csr_array(coo_array((values.ravel(), (rows.ravel(), columns.ravel())), shape=(count, len(rows))))
