"""Compliance of teeth under loads on their flanks: bending, shear, base and body of a whole gear.

The compliance of all teeth is computed from one tooth. All teeth of a gear are copies of one tooth, rotated by pitches.
The tooth's sector with the rim under it is held at the rim's inner face. It is condensed to its two cut faces and to
the nodes of the loaded flank. The ring of z sectors is block-circulant, so that a Fourier series over the teeth gives
the whole gear exactly, without any influence of cut faces. Of a body with a web only the part within its profile is
stiff. An element that the profile cuts is as stiff as its share inside. q_j are the displacements of the cut before
sector j in the sector's own frame. T is the rotation by a pitch, S the sector's stiffness to its right and left cut,
and g the loads on the cuts.

    S_RR q_j + S_RL T q_(j+1) + T' S_LR q_(j-1) + T' S_LL T q_j = g_R,j + T' g_L,(j-1)

For harmonic k, q_(j+1) = q_j exp(2 pi i k / z): one system of the size of a cut.

The teeth of a sliding bar are such a ring too, without rotation. A bar is held at its back, loads a few tooth heights
away hardly affect it, and it is modelled as endless.

The nodes of a flank are coarse, so that the local contact deflection around a load is wrong. It is removed and replaced
by half-space theory. For this, the elements between the flank and the middle of the tooth are solved once more, with
all other elements held. The half-space's own deflection at the middle is subtracted:

    compliance = C(gear) - L(held at the middle) - u(half-space, at the middle) + u(half-space, at the flank)

The last term belongs to the contact's own grid (`contact_compliance`). All other terms are smooth and are computed
here. The elements transfer the third term from the middle to the flank, so that the sum does not depend on the position
of the middle.

Finite-element models have a few teeth only, whose cut faces are held. The same condensed sectors in a row, with the
first and the last cut held, are these bodies (`HeldTeeth`). A comparison with such a model needs bodies that are held
like it.
"""

from __future__ import annotations

import hashlib
from dataclasses import replace
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
from gearmesh.kernel.numeric.lattice import numbers_at
from gearmesh.loaded.compliance.condensation import condensed
from gearmesh.loaded.compliance.half_space import point_displacements
from gearmesh.loaded.compliance.incompatible_modes import UNIT_CORNERS, corner_stresses, stiffness, unknowns
from gearmesh.loaded.compliance.quarter_space import release
from gearmesh.loaded.compliance.sector_grid import WEB_RIM_POWER, FilletSize, sector_grid
from gearmesh.loaded.compliance.threads import one_thread
from gearmesh.loaded.root_tangent import tangent_weights
from gearmesh.mesh.hexahedra.hexahedra import Cells, hex_mesh, on_breaks, on_stations, usual_rim, whole_rim
from gearmesh.mesh.hexahedra.hexes import HexMesh
from gearmesh.mesh.hexahedra.layers import layers, running_angle
from gearmesh.progress import go_on
from gearmesh.records import dataclass
from gearmesh.teeth.blank.body import Disc
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Index = NDArray[np.int64]

#: distance, in eighths of the flank's height, within which a node of the fillet is a node of the flank
BORDER_SHARE = 1e-6
#: default elements of a sector
SECTOR_CELLS = Cells(flank=8, fillet=12, thickness=4, rim=5, face=11)
#: three quarters of these each way; the difference of root stress estimates the error
COARSER_CELLS = Cells(flank=6, fillet=9, thickness=3, rim=4, face=8)
#: elements whose nodes tell how far bodies differ
SHAPE_CELLS = Cells(flank=3, fillet=2, thickness=2, rim=1, face=4)
#: largest number of rings in memory, about 10 MB each
MAX_KEPT_RINGS = 16
#: responses of the last rings, by a hash of their sector
_KEPT_RINGS: dict[tuple[bytes, int, int, int | None, bool], tuple[Array, Array]] = {}
#: both members may be computed at the same time
_RINGS_LOCK = Lock()
#: least number of teeth after which a bar repeats, far enough away to have no effect
MIN_BAR_TEETH = 30
#: points on the way to the next node over which a node's force is spread
SPREAD_POINTS = 4
#: least number of elements from root to bore of a body with a web
WEB_RIM_ELEMENTS = 12
#: points in each direction of an element at which its material is tested
SAMPLES_PER_EDGE = 4
#: share of material in an element below which it counts as empty
MIN_MATERIAL_SHARE = 0.02
#: distance, mm, within which nodes of two meshes are the same
NODE_TOLERANCE_MM = 1e-6


@dataclass(frozen=True)
class EndPlane:
    """Plane through `middle` (3,) with the outward normal `out` (3,)."""

    middle: Array
    out: Array

    def images(self, places: Array, ways: Array) -> tuple[Array, Array]:
        """Return places (..., 3) and directions (..., 3) mirrored at the plane."""
        distance = (places - self.middle) @ self.out
        return places - 2.0 * distance[..., None] * self.out, ways - 2.0 * (ways @ self.out)[..., None] * self.out


@dataclass(frozen=True)
class FilletStress:
    """Stress in the fillet below a loaded flank, in the member's own frame, under loads on the flank.

    N is the number of teeth on either side of the loaded tooth that are included, n = I J the number of the flank's
    nodes.
    """

    #: loaded tooth
    tooth: Tooth
    #: nodes (I, J, 3), mm, of the flank, from form point to tip by toe to heel
    points: Array
    #: nodes (F, 3), mm, of the fillet on the loaded side
    fillet: Array
    #: stresses (2 N + 1, F, 6, n), MPa/N, at the fillet's nodes of teeth -N .. N under unit forces into the body at the
    #: flank's nodes of tooth 0; teeth are counted in the direction of motion, stresses are in each tooth's own frame
    stress: Array
    #: weights (K, F) that interpolate them to the tangent of 30 deg (`root_tangent`), one row per station
    tangent: Array
    #: mean height, mm, of the lowest eighth of the flank: about one element
    eighth: float

    @property
    def reach(self) -> int:
        """Number N of teeth on either side of the loaded tooth."""
        return len(self.stress) // 2

    @cached_property
    def below_flank(self) -> NDArray[np.bool_]:
        """True (F,) for nodes of the fillet that are not on its border with the flank, where nodes carry the load."""
        apart = np.linalg.norm(self.fillet[:, None] - self.points[0], axis=-1).min(axis=1)
        below: NDArray[np.bool_] = apart > BORDER_SHARE * self.eighth
        return below

    def of_tooth(self, loaded: int) -> FilletStress:
        """Return the stress under loads on tooth `loaded`, counted in the direction of motion; all teeth of a whole
        gear are equal."""
        return self

    def along_helix(self, turned: Array, places: Array) -> Rigid:
        """Return motions (M,) from the tooth's own frame, rotated by angles (M,), rad, to the frame of `points`.

        A thread is known over an arc around the x axis only. A screw motion along its helix maps the thread onto itself
        and moves the places (M, X, 3) into this arc.
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
        """Return the nodes (..., 4) around places (..., 3) on the flank, own frame, and the share (..., 4) of a load
        there that each takes."""
        station, height = self._coordinates(places)
        stations, heights = self._table
        # bilinear interpolation: between two stations, then between two rows of nodes
        column = np.clip(np.searchsorted(stations, station) - 1, 0, len(stations) - 2)
        station_share = np.clip((station - stations[column]) / (stations[column + 1] - stations[column]), 0.0, 1.0)
        lines = (1.0 - station_share) * heights[:, column] + station_share * heights[:, column + 1]
        row = np.clip((lines < height).sum(axis=0) - 1, 0, len(heights) - 2)
        low, high = (np.take_along_axis(lines, (row + k)[None], axis=0)[0] for k in (0, 1))
        height_share = np.clip((height - low) / (high - low), 0.0, 1.0)
        count = len(stations)
        nodes = np.stack([(row + i) * count + column + j for i in (0, 1) for j in (0, 1)], axis=-1)
        return nodes, np.stack(
            [a * b for a in (1.0 - height_share, height_share) for b in (1.0 - station_share, station_share)], axis=-1
        )

    @cached_property
    def _table(self) -> tuple[Array, Array]:
        """Stations (J,) of the nodes and their heights (I, J), mm, both increasing."""
        stations, heights = self._coordinates(self.points)
        return stations[0], heights

    def _coordinates(self, places: Array) -> tuple[Array, Array]:
        """Return positions of places (..., 3) along the face and from form point to tip, in mm, both increasing; for
        threads the first is the angle around the axis, rad."""
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
    """A loaded flank with its compliance and the stress in its fillet."""

    #: normals (I, J, 3) at the flank's nodes, out of the body
    normals: Array
    #: displacements (2 N + 1, n, n), mm/N, into the body along the normals, of the flank's nodes (first index) of teeth
    #: -N .. N under unit forces at the nodes (last index) of tooth 0, without local contact compliance
    smooth: Array
    #: stress on a coarser mesh of the same body, for the error estimate
    coarser: FilletStress | None = None

    def of_tooth(self, loaded: int) -> FlankCompliance:
        """Return the compliance under loads on tooth `loaded`, counted in the direction of motion; all teeth of a whole
        gear are equal."""
        return self


@dataclass(frozen=True)
class HeldTeeth(FlankCompliance):
    """A few teeth with the rim under them, whose cut faces are held too.

    `of_teeth` (K,) has the response to loads on each tooth. The fields describe loads on the middle tooth. Teeth that
    the body does not have neither move nor have stress; loads on them count as loads on the last tooth.
    """

    of_teeth: tuple[FlankCompliance, ...] = ()

    def of_tooth(self, loaded: int) -> FlankCompliance:
        middle = len(self.of_teeth) // 2
        return self.of_teeth[min(max(loaded + middle, 0), 2 * middle)]


def rim_depth(tooth: Tooth, cells: Cells = SECTOR_CELLS) -> float:
    """Return the depth, mm, below the root at which a gear is held by its rim: 1.2 whole depths, or less if the body is
    thinner."""
    return usual_rim(without_web(tooth), np.linspace(0.0, 1.0, cells.face + 1))


@dataclass(frozen=True)
class BodyOutline:
    """Places of a tooth and of the body below it, by which nearly equal gears are known."""

    #: number of teeth
    teeth: int
    #: web of the body
    web: Disc | None
    #: places (N, 3), mm
    nodes: Array
    #: 1.2 whole depths, mm, or less
    depth: float

    @staticmethod
    def of(tooth: Tooth, side: Side) -> BodyOutline:
        """Return the outline of a gear of teeth that are loaded on one side."""
        whole = without_web(tooth)
        rim = whole_rim(whole, np.linspace(0.0, 1.0, SHAPE_CELLS.face + 1))
        grid = on_breaks(whole, sector_grid(whole, side, SHAPE_CELLS))
        nodes = hex_mesh(whole, np.array([0]), grid, rim).nodes
        return BodyOutline(tooth.teeth, tooth.blank.body.web, nodes, rim_depth(tooth))

    def shift(self, other: BodyOutline) -> float:
        """Return the largest distance between the same places of two outlines over their depth; infinite for other
        numbers of teeth or other webs."""
        if self.teeth != other.teeth or self.nodes.shape != other.nodes.shape or self.web != other.web:
            return np.inf
        return float(np.linalg.norm(self.nodes - other.nodes, axis=1).max() / self.depth)

    def moved(self, first: Rigid, second: Rigid) -> float:
        """Return the largest distance between the places after two motions, over their depth."""
        return float(np.linalg.norm(first.point(self.nodes) - second.point(self.nodes), axis=1).max() / self.depth)


@one_thread()
def flank_compliance(
    tooth: Tooth,
    side: Side,
    material: Material,
    cells: Cells = SECTOR_CELLS,
    rim: float | None = None,
    depth: int | None = None,
    reach: int = 3,
    coarser: Cells | None = None,
    *,
    idler: bool = False,
) -> FlankCompliance:
    """Compute the compliance of a flank of a gear.

    - `rim`: depth, mm, below the root at which the gear is held; by default at the bore, or near the axis without a
      bore.
    - `depth`: number of elements under the flank that are free for the local compliance; by default and at most up to
      the tooth's middle.
    - `reach`: number of teeth on either side of the loaded tooth.
    - `coarser`: elements of the mesh that estimates the error of root stress; none by default.
    - `idler`: True if no torque reaches the bore, because the other mesh, half a turn away, takes it.

    The bore of an idler, as the pin of a planet, takes the sum of both tangential forces. The model neglects that the
    radial force of the other mesh points the other way.
    """
    rim_below_root = whole_rim(without_web(tooth), np.linspace(0.0, 1.0, cells.face + 1)) if rim is None else rim
    teeth_of_turn = np.inf if tooth.screw is not None else tooth.joint.cycle(tooth.teeth)
    count = int(min(teeth_of_turn, max(tooth.teeth, MIN_BAR_TEETH)))

    def responses_of(mesh_cells: Cells, with_local: bool) -> tuple[Sector, FilletStress, Array]:
        sector = Sector.of(tooth, side, material, mesh_cells, rim_below_root)
        smooth, stress = _ring_responses(
            sector, count, reach, (depth or sector.inwards) if with_local else None, idler=idler
        )
        return sector, sector.fillet_stress(tooth, stress), smooth

    sector, fillet, smooth = responses_of(cells, True)
    coarser_stress = None if coarser is None else responses_of(coarser, False)[1]
    return FlankCompliance(**vars(fillet), normals=sector.normals, smooth=smooth, coarser=coarser_stress)


@one_thread()
def held_teeth(
    tooth: Tooth, side: Side, material: Material, cells: Cells = SECTOR_CELLS, rim: float | None = None, teeth: int = 3
) -> HeldTeeth:
    """Compute the compliance of a flank of an odd number of `teeth`, cut out of a gear with a rim of `rim` mm.

    The rim is by default as thick as that of `hex_mesh`. It is held at its inner face and at the cut faces.

    Raises DesignError for an even number of teeth, or for as many teeth as the gear has.
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
    """Return `smooth` and `stress` of a ring of sectors.

    `depth` is the number of elements for the local compliance; with None the local compliance stays in. The last
    `MAX_KEPT_RINGS` results are kept: other torques, positions, assemblies and mounts of the same teeth need them
    again.
    """
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
    responses = _KEPT_RINGS.get(key)
    if responses is None:
        condensed = Condensed.of(sector)
        cuts = _cuts(condensed.stiffness, condensed.loads, sector.turn, teeth, reach, idler=idler)
        count = sector.flank.size
        responses = condensed.responses(
            cuts, np.zeros((count, count)) if depth is None else _contact_compliance(sector, depth)
        )
        for response in responses:
            response.setflags(write=False)
        # both members may be computed at the same time
        with _RINGS_LOCK:
            _KEPT_RINGS[key] = responses
            while len(_KEPT_RINGS) > MAX_KEPT_RINGS:
                del _KEPT_RINGS[next(iter(_KEPT_RINGS))]
    return responses


@dataclass(frozen=True)
class Sector:
    """One tooth of a member with its rim, as a mesh with its stiffness."""

    #: mesh of N nodes
    mesh: HexMesh
    #: material of the member
    material: Material
    #: stiffness (3 N, 3 N), N/mm
    stiffness: csr_array
    #: number of layers of nodes from toe to heel
    layers: int
    #: loaded side
    side: Side
    #: stations (J,) of the layers
    t: Array
    #: numbers (I, J) of the flank's nodes
    flank: Index
    #: points (I, J, 3), mm, of these nodes
    points: Array
    #: normals (I, J, 3) there, out of the body
    normals: Array
    #: nodes (C,) of the right cut
    right: Index
    #: nodes (C,) of the left cut, in the same order
    left: Index
    #: nodes of the rim's inner face, and nodes without material
    held: Index
    #: nodes of the fillet on the loaded side
    fillet: Index
    #: rotation (3, 3) by a pitch
    turn: Array
    #: number of elements from the flank to the middle
    inwards: int

    @staticmethod
    def of(tooth: Tooth, side: Side, material: Material, cells: Cells, rim: float | None) -> Sector:
        web = tooth.blank.body.web
        if web is None:
            grid = sector_grid(tooth, side, cells)
        else:
            toe, heel = tooth.blank.extent
            faces = (np.array([web.low, web.high]) - toe) / (heel - toe)
            web_cells = replace(cells, rim=max(cells.rim, WEB_RIM_ELEMENTS))
            grid = on_stations(sector_grid(tooth, side, web_cells, WEB_RIM_POWER), faces)
        grid = on_breaks(tooth, grid)
        # the mesh fills the recesses of a web; elements there have no stiffness
        mesh = hex_mesh(without_web(tooth), np.array([0]), grid, rim)
        material_shares = np.ones(len(mesh.elements)) if web is None else inside(web, mesh.nodes[mesh.elements])
        # nodes without material are held, so that the stiffness stays regular
        bare_nodes = np.setdiff1d(np.arange(len(mesh.nodes)), mesh.elements[material_shares > 0.0])
        sections = layers(tooth, grid.t)
        exact, step = sections.flank(side, grid.lines.flank), sections.step
        held = np.union1d(mesh.node_sets["rim"], bare_nodes)
        right = np.setdiff1d(mesh.node_sets["cut_right"], held)
        left = np.setdiff1d(mesh.node_sets["cut_left"], held)
        return Sector(
            mesh,
            material,
            assemble(mesh, material, material_shares),
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
    def column(self) -> Index:
        """Column (N,) of each node: nodes of the same place in all layers."""
        return np.arange(len(self.mesh.nodes)) % (len(self.mesh.nodes) // self.layers)

    @property
    def presses(self) -> csr_array:
        """Unit forces (3 N, n) into the body on the flank's nodes."""
        return _columns(unknowns(self.flank.reshape(-1, 1)), -self.normals.reshape(-1, 3), 3 * len(self.mesh.nodes))

    def fillet_stress(self, tooth: Tooth, stress: Array) -> FilletStress:
        """Return the fillet with its `stress` (2 N + 1, F, 6, n)."""
        fillet = self.mesh.nodes[self.fillet]
        tangent, size = tangent_weights(tooth, self.side, self.t, fillet), FilletSize.of(tooth, self.side)
        return FilletStress(tooth, self.points, fillet, stress, tangent, size.eighth)

    @property
    def stresses(self) -> csr_array:
        """Matrix (3 N, 6 F) whose columns give the stresses at the fillet's nodes from displacements: means over the
        elements at a node."""
        from scipy.sparse import coo_array, csr_array

        touching = np.isin(self.mesh.elements, self.fillet)
        element, corner = np.nonzero(touching)
        elements, row_of_element = np.unique(element, return_inverse=True)
        node = np.searchsorted(self.fillet, self.mesh.elements[element, corner])
        element_stresses = corner_stresses(self.mesh.nodes[self.mesh.elements[elements]], self.material)[
            row_of_element, corner
        ]
        element_stresses /= np.bincount(node)[node][:, None, None]
        rows = np.repeat(unknowns(self.mesh.elements[element])[:, None], 6, axis=1)
        columns = np.broadcast_to((6 * node[:, None] + np.arange(6))[:, :, None], rows.shape)
        shape = (3 * len(self.mesh.nodes), 6 * len(self.fillet))
        return csr_array(coo_array((element_stresses.ravel(), (rows.ravel(), columns.ravel())), shape=shape))


def without_web(tooth: Tooth) -> Tooth:
    """Return the tooth with the recesses of its body filled."""
    blank = tooth.blank
    return tooth if blank.body.web is None else replace(tooth, blank=replace(blank, body=blank.body.without_web))


def inside(web: Disc, corners: Array) -> Array:
    """Return the share (E,) of elements with corners (E, 8, 3), mm, that is hub, web or rim and not recess."""
    steps = (np.arange(SAMPLES_PER_EDGE) + 0.5) * 2.0 / SAMPLES_PER_EDGE - 1.0
    places = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 1, 3)
    points = np.prod(1.0 + UNIT_CORNERS * places, axis=-1) / 8.0 @ corners
    rho, z = np.hypot(points[..., 0], points[..., 1]), points[..., 2]
    recess = (rho > web.inner) & (rho < web.outer) & ((z < web.low) | (z > web.high))
    share = 1.0 - recess.mean(axis=1)
    return np.where(share < MIN_MATERIAL_SHARE, 0.0, share)


def assemble(mesh: HexMesh, material: Material, shares: Array | None = None) -> csr_array:
    """Return the stiffness (3 N, 3 N), N/mm, of a mesh of hexahedra, with each element's stiffness times its share (E,)
    if given."""
    from scipy.sparse import bsr_array, csr_array

    parts, count = stiffness(mesh.nodes[mesh.elements], material), len(mesh.nodes)
    if shares is not None:
        parts *= shares[:, None, None]
    # blocks (3, 3) of two nodes, summed over the elements that have both
    blocks = parts.reshape(-1, 8, 3, 8, 3).swapaxes(2, 3).reshape(-1, 9)
    couples = (mesh.elements[:, :, None] * count + mesh.elements[:, None]).ravel()
    order = np.argsort(couples, kind="stable")
    couples = couples[order]
    first = np.flatnonzero(np.diff(couples, prepend=-1))
    rows, columns = np.divmod(couples[first], count)
    summed = np.add.reduceat(blocks[order], first, axis=0).reshape(-1, 3, 3)
    begin = np.searchsorted(rows, np.arange(count + 1))
    return csr_array(bsr_array((summed, columns, begin), shape=(3 * count,) * 2))


@dataclass(frozen=True)
class Condensed:
    """A sector condensed to its two cuts with 2 c unknowns, the right cut first."""

    #: condensed sector
    sector: Sector
    #: stiffness (2 c, 2 c) of the cuts
    stiffness: Array
    #: columns (2 c, n + 6 F) on the cuts: loads on the flank, and the wanted displacements and stresses, which are dual
    #: to them
    asked: Array
    #: wanted values (n + 6 F, n) under loads on the flank with both cuts held
    inner: Array

    @staticmethod
    def of(sector: Sector) -> Condensed:
        from scipy.sparse import csr_array, hstack

        right, left, held = (unknowns(nodes[:, None]).ravel() for nodes in (sector.right, sector.left, sector.held))
        cuts = np.concatenate((right, left))
        column = np.repeat(sector.column, 3)
        column[held] = column[cuts] = -1
        presses = sector.presses
        loads = csr_array(hstack([presses, sector.stresses]))
        return Condensed(sector, *condensed(sector.stiffness, column, cuts, loads, presses.shape[1]))

    @property
    def loads(self) -> Array:
        """Forces (2 c, n) on the cuts due to unit forces on the flank's nodes."""
        return self.asked[:, : self.inner.shape[1]]

    def responses(self, cuts: Array, local: Array) -> tuple[Array, Array]:
        """Return `smooth` and `stress` of the body under unit forces on sector 0.

        `cuts` (2 N + 1, 2 c, n) are displacements of both cuts of sectors -N .. N. `local` (n, n) is added to `smooth`
        of sector 0.
        """
        count, reach = self.inner.shape[1], len(cuts) // 2
        wanted_values = self.asked.T @ cuts
        wanted_values[reach] += self.inner
        smooth = wanted_values[:, :count]
        smooth[reach] += local
        smooth[reach] = 0.5 * (smooth[reach] + smooth[reach].T)
        return smooth, wanted_values[:, count:].reshape(2 * reach + 1, len(self.sector.fillet), 6, count)


def _cuts(condensed: Array, loads: Array, turn: Array, teeth: int, reach: int, *, idler: bool = False) -> Array:
    """Solve a ring for displacements (2 N + 1, 2 c, n) of both cuts of sectors -N .. N, each in its own frame.

    - `condensed` (2 c, 2 c): stiffness of a sector to its cuts, the right cut first.
    - `loads` (2 c, n): forces on the cuts of sector 0.
    - `idler`: the opposite sector has the opposite load; half a turn is the factor (-1)^k of harmonic k, so that only
      odd k remain.
    """
    from scipy.linalg import cho_factor, cho_solve

    self_stiffness, coupling, on_own_cut, on_next_cut = _row(condensed, loads, turn)
    cut_size = len(self_stiffness)
    places = np.arange(-reach, reach + 2)
    cuts = np.zeros((len(places), cut_size, loads.shape[1]))
    for k in range(1 if idler else 0, teeth // 2 + 1, 2 if idler else 1):
        go_on()
        # one system per harmonic; harmonic -k is the complex conjugate, so that k counts twice
        phase = np.exp(2j * np.pi * k / teeth)
        system = self_stiffness + phase * coupling + np.conj(phase) * coupling.T
        solved = cho_solve(
            cho_factor(system, lower=True, check_finite=False), on_own_cut + on_next_cut / phase, check_finite=False
        )
        weight = (1.0 if k in (0, teeth / 2) else 2.0) * (2.0 if idler else 1.0) / teeth
        phases = weight * phase**places
        parts = np.stack((solved.real, -solved.imag)).reshape(2, -1)
        cuts += (np.stack((phases.real, phases.imag), axis=1) @ parts).reshape(cuts.shape)
    return _both(cuts, turn)


def _held_cuts(condensed: Array, loads: Array, turn: Array, teeth: int) -> Array:
    """Solve a row of K = `teeth` sectors for displacements (K, 2 K - 1, 2 c, n) of their cuts.

    The outer cuts are held. The first index is the loaded sector. The second index runs over sectors 1 - K .. K - 1
    from the loaded one; it is 0 for sectors that the row does not have.
    """
    from scipy.linalg import cho_factor, cho_solve

    self_stiffness, coupling, on_own_cut, on_next_cut = _row(condensed, loads, turn)
    cut_size, inner_cuts = len(self_stiffness), teeth - 1
    matrix = np.zeros((inner_cuts, cut_size, inner_cuts, cut_size))
    right = np.zeros((inner_cuts + 2, cut_size, teeth, loads.shape[1]))
    # block tridiagonal stiffness of the inner cuts
    for k in range(inner_cuts):
        matrix[k, :, k] = self_stiffness
        if k:
            matrix[k - 1, :, k], matrix[k, :, k - 1] = coupling, coupling.T
    # loads on sector k act on the cut before it and on the next cut
    for k in range(teeth):
        right[k, :, k], right[k + 1, :, k] = on_own_cut, on_next_cut
    size = inner_cuts * cut_size
    moved = np.zeros((teeth, 2 * teeth, cut_size, loads.shape[1]))
    if inner_cuts:
        factor = cho_factor(matrix.reshape(size, size), lower=True, check_finite=False)
        solved = cho_solve(factor, right[1:-1].reshape(size, -1), check_finite=False).reshape(
            inner_cuts, cut_size, teeth, -1
        )
        # the first inner cut is the cut before sector 1
        go_on()
        for k in range(teeth):
            moved[k, teeth - k : teeth - k + inner_cuts] = solved[:, :, k]
    return np.stack([_both(row, turn) for row in moved])


def _row(condensed: Array, loads: Array, turn: Array) -> tuple[Array, Array, Array, Array]:
    """Return stiffness and loads of the cuts between sectors side by side.

    - stiffness (c, c) of a cut to itself.
    - stiffness (c, c) of a cut to the next cut, each in the frame of the sector that begins there.
    - forces from `loads` (2 c, n) of a sector on the sector's first cut.
    - forces from them on the next sector's first cut.
    """
    cut_size = len(condensed) // 2
    right, left = slice(0, cut_size), slice(cut_size, None)
    coupling = _rotate(condensed[right, left].T, turn.T).T
    self_stiffness = condensed[right, right] + _rotate(_rotate(condensed[left, left], turn.T).T, turn.T).T
    return self_stiffness, coupling, loads[right], _rotate(loads[left], turn.T)


def _both(cuts: Array, turn: Array) -> Array:
    """Return displacements (K, 2 c, n) of both cuts of K sectors, each in its own frame, from those of the right cuts
    (K + 1, c, n)."""
    return np.stack([np.concatenate((a, _rotate(b, turn))) for a, b in pairwise(cuts)])


def _rotate(columns: Array, by: Array) -> Array:
    """Return columns (3 K, n) of vectors, each rotated by `by` (3, 3)."""
    turned: Array = by @ columns.reshape(len(columns) // 3, 3, -1)
    return turned.reshape(len(columns), -1)


def _contact_compliance(sector: Sector, depth: int) -> Array:
    """Return the correction (n, n), mm/N, that removes the elements' local compliance from responses of the gear: - L -
    u(middle)."""
    mesh, steps = sector.mesh, sector.layers - 1
    surface_elements = [mesh.face_sets[f"{name}_{sector.side}_1"][:, 0] for name in ("flank", "fillet")]
    if "edge" in mesh.face_sets:
        edge = mesh.face_sets["edge"][:, 0]
        surface_elements.append(edge[np.isin(mesh.elements[edge], sector.flank).any(axis=1)])
    # an element lies `steps` after the element above it in the mesh's numbering
    inner_elements = np.unique(np.concatenate(surface_elements)[:, None] + steps * np.arange(depth))
    # nodes between the flank and the base are free; the base, where the other elements begin, is held
    other_elements = np.setdiff1d(np.arange(len(mesh.elements)), inner_elements)
    free = np.setdiff1d(mesh.elements[inner_elements], mesh.elements[other_elements])
    base_nodes = np.intersect1d(mesh.elements[inner_elements], mesh.elements[other_elements])
    column = np.full(len(mesh.nodes), -1)
    column[free] = sector.column[free]
    base_unknowns, presses = unknowns(base_nodes[:, None]).ravel(), sector.presses
    _, on_base, local = condensed(sector.stiffness, np.repeat(column, 3), base_unknowns, presses, presses.shape[1])
    # L of the flank's nodes; deflections of the half-space at the base, transferred to the flank by the elements
    transfer = -on_base.T
    return -local + transfer @ _half_spaces(sector, base_nodes)


def _half_spaces(sector: Sector, nodes: Index) -> Array:
    """Return displacements (3 K, n), mm/N, of nodes (K,) in half-spaces pressed at the flank's nodes.

    Each force is normal to the flank. The half-spaces end at toe and heel. Lines of contact run more along the face
    than up the profile. A node's force is therefore spread along the face and falls to 0 at the next nodes, as
    `FlankCompliance.shares` divides the force of a line of contact.
    """
    into = -sector.normals
    tangent = unit(np.cross(into, np.eye(3)[np.abs(into).argmin(axis=-1)]))
    frames = np.stack((tangent, np.cross(into, tangent), into), axis=-1)
    images = [_Images.of(sector, nodes, end, inner) for end, inner in ((0, 1), (-1, -2))]
    count, columns = sector.flank.shape
    total = np.zeros((count, columns, len(nodes), 3))
    weight = np.zeros(columns)
    # forces on the way to the neighbour on either side, with weights that fall linearly to 0
    for step in (-1, 1):
        rows = np.s_[1:] if step < 0 else np.s_[:-1]
        neighbours = sector.points[:, :-1] if step < 0 else sector.points[:, 1:]
        for share in (np.arange(SPREAD_POINTS) + 0.5) / SPREAD_POINTS:
            start = sector.points[:, rows] + share * (neighbours - sector.points[:, rows])
            displacement = _surface_displacements(
                sector.mesh.nodes[nodes] - start[:, :, None], frames[:, rows], sector.material
            )
            for image in images:
                displacement += image.displacements(start, frames[:, rows])
            total[:, rows] += (1.0 - share) * displacement
            weight[rows] += 1.0 - share
    total /= weight[:, None, None]
    return total.reshape(count * columns, -1).T


def _surface_displacements(place: Array, frames: Array, material: Material) -> Array:
    """Return displacements (I, J, K, 3), mm/N, at places (I, J, K, 3) under unit forces along the third axes of frames
    (I, J, 3, 3)."""
    local_place = place @ frames
    # a flank is not flat: a place above the tangent plane counts as on it
    local_place[..., 2] = np.maximum(local_place[..., 2], 0.0)
    return point_displacements(local_place, material) @ frames.swapaxes(-1, -2)


@dataclass(frozen=True)
class _Images:
    """Nodes (K,) of a tooth mirrored at an end face: for each row (I,) of the flank, a plane through its end at right
    angles to the row."""

    #: mirrored nodes (I, K, 3), mm
    mirrored: Array
    #: ends (I, 3) of the rows, mm
    middle: Array
    #: outward normals (I, 3) of the planes
    out: Array
    #: distances (I, K), mm, of the nodes from the planes
    x: Array
    #: material of the tooth
    material: Material

    @staticmethod
    def of(sector: Sector, nodes: Index, end: int, inner: int) -> _Images:
        middle = sector.points[:, end]
        out = unit(middle - sector.points[:, inner])
        x = np.einsum("ik,ink->in", out, middle[:, None] - sector.mesh.nodes[nodes])
        mirrored = sector.mesh.nodes[nodes] + 2.0 * x[..., None] * out[:, None]
        return _Images(mirrored, middle, out, np.maximum(x, 0.0), sector.material)

    def displacements(self, start: Array, frames: Array) -> Array:
        """Return the displacements (I, J, K, 3), mm/N, that the end face adds to those on a half-space.

        Forces are at `start` (I, J, 3). At the surface they follow `quarter_space`. Deeper places are assumed to be as
        much restrained as places as far away along the edge.
        """
        place, out = self.mirrored[:, None] - start[:, :, None], self.out[:, None, None]
        image = _surface_displacements(place, frames, self.material)
        image -= 2.0 * (image @ self.out[:, None, :, None]) * out
        distance_sum = np.maximum((place * out).sum(axis=-1), NODE_TOLERANCE_MM)
        beside = np.sqrt(np.maximum((place**2).sum(axis=-1) - distance_sum**2, 0.0))
        m = np.minimum(np.abs(2.0 * self.x[:, None] - distance_sum) / distance_sum, 1.0)
        release_value = np.polynomial.polynomial.polyval(
            m**2, release(np.arctan2(beside, distance_sum), self.material.poisson_ratio), tensor=False
        )
        added: Array = (1.0 + release_value)[..., None] * image
        return added


def _node_numbers(nodes: Array, places: Array) -> Index:
    """Return the numbers (...,) of the nodes (N, 3) at places (..., 3)."""
    numbers = numbers_at(nodes, places, NODE_TOLERANCE_MM)
    assert numbers.min() >= 0, "the mesh has no nodes there"
    return numbers


def _columns(rows: Index, values: Array, count: int) -> csr_array:
    """Return a matrix (count, n) whose columns have `values` (n, K) in `rows` (n, K)."""
    from scipy.sparse import coo_array, csr_array

    columns = np.broadcast_to(np.arange(len(rows))[:, None], rows.shape)
    return csr_array(coo_array((values.ravel(), (rows.ravel(), columns.ravel())), shape=(count, len(rows))))
