"""Code_Aster: mesh and groups as MED (.med), and beside it the commands (.comm) of a static analysis with contact.

medcoupling writes the MED file. Its hexahedra count their bottom clockwise seen from the top, opposite to ours. Groups of
volumes and faces have the names of the sets. A rigid set follows a node of its own (DIS_TR without stiffness) by
LIAISON_SOLIDE. Contact is that of the method CONTINUE with penalty, the stiffness as pressure over penetration.
"""

from __future__ import annotations

from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import OutputError
from gearmesh.fe.decks.fields import T_PER_MM3_OF_KG_PER_M3, all_points, corners_then_middles, one_line
from gearmesh.fe.decks.hdf5_times import without_times
from gearmesh.fe.decks.registry import register
from gearmesh.fe.model import ContactPair, Model, RigidTie
from gearmesh.formats import COMM_SUFFIX, MED_SUFFIX
from gearmesh.io.atomic import whole_file, whole_text
from gearmesh.mesh.hexahedra.hexes import HEX_EDGES, HexMesh

#: message without medcoupling
MISSING_PACKAGE_MESSAGE = 'MED files need medcoupling: pip install "gearmesh[med]"'
#: longest name of a group in Code_Aster
MAX_GROUP_NAME_LENGTH = 24
#: place in our order of each corner of a MED hexahedron
MED_CORNER_ORDER = (0, 3, 2, 1, 4, 7, 6, 5)
#: its edges: bottom, top, uprights
MED_EDGE_CORNERS = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
#: place in our order of each of its nodes
MED_NODE_ORDER = [
    *MED_CORNER_ORDER,
    *(
        8 + next(i for i, edge in enumerate(HEX_EDGES) if {*edge} == {MED_CORNER_ORDER[a], MED_CORNER_ORDER[b]})
        for a, b in MED_EDGE_CORNERS
    ),
]
#: degrees of freedom, and the keywords of forces at nodes
MOTION_NAMES = ("DX", "DY", "DZ", "DRX", "DRY", "DRZ")
LOAD_NAMES = ("FX", "FY", "FZ", "MX", "MY", "MZ")


def require(path: Path) -> None:
    """Raise OutputError without medcoupling."""
    if find_spec("medcoupling") is None:
        raise OutputError("cannot write", path, reason=MISSING_PACKAGE_MESSAGE)


def write(model: Model, path: Path) -> None:
    """Write the mesh, and the commands beside it."""
    if model.cyclic is not None:
        reason = "cyclic symmetry of a sector is written for CalculiX, Abaqus, Ansys, Nastran and LS-DYNA alone"
        raise OutputError("cannot write", path, reason=reason)
    _refuse_long_names(model, path)
    whole_text(path.with_suffix(COMM_SUFFIX), "".join(_commands(model, path)))
    with whole_file(path) as temporary:
        temporary.unlink()
        _med(model).write40(str(temporary), 2)
        without_times(temporary)


def _refuse_long_names(model: Model, path: Path) -> None:
    names = [*model.mesh.node_sets, *model.mesh.element_sets, *map(_reference, model.ties)]
    for name in names:
        if len(name) > MAX_GROUP_NAME_LENGTH:
            raise OutputError(
                "cannot write", path, reason=f"Code_Aster takes names of {MAX_GROUP_NAME_LENGTH} letters, not {name}"
            )


def _reference(tie: RigidTie) -> str:
    """Return the name of a tie's reference node."""
    return f"{tie.node_set}_node"


def _node(index: int) -> str:
    """Return the name of the group of one node."""
    return f"N{index + 1}"


def face_group(mesh: HexMesh, name: str) -> str:
    """Return the name of the group of a face set; groups of faces and of volumes share names in Code_Aster."""
    return f"{name}_faces" if name in mesh.element_sets else name


def _med(model: Model) -> Any:
    """Return the mesh file: volumes, named faces, reference nodes as points, groups."""
    import medcoupling as mc

    mesh = model.mesh
    points = all_points(model)
    coordinates = mc.DataArrayDouble(np.ascontiguousarray(points))
    coordinates.setInfoOnComponents(["X [mm]", "Y [mm]", "Z [mm]"])
    order = MED_NODE_ORDER if mesh.second_order else list(MED_CORNER_ORDER)
    # each face once, by its number among all faces of all elements
    numbers = {name: faces @ [6, 1] for name, faces in mesh.face_sets.items()}
    face_numbers = np.unique(np.concatenate([np.empty(0, np.int64), *numbers.values()]))
    places = {name: np.searchsorted(face_numbers, number) for name, number in numbers.items()}
    faces = np.zeros((len(face_numbers), 8 if mesh.second_order else 4), np.int64)
    for name, place in places.items():
        faces[place] = corners_then_middles(mesh, name)
    references = np.arange(len(mesh.nodes), len(points))[:, None]
    kinds = (mc.NORM_HEXA20, mc.NORM_QUAD8) if mesh.second_order else (mc.NORM_HEXA8, mc.NORM_QUAD4)
    file = mc.MEDFileUMesh()
    levels = [(0, kinds[0], mesh.elements[:, order]), (-1, kinds[1], faces), (-3, mc.NORM_POINT1, references)]
    for level, kind, cells in levels:
        if len(cells):
            file.setMeshAtLevel(level, _umesh(mc, coordinates, 3 + level, kind, cells))
    file.setName("gears")
    # a name of user, time and process, which nothing needs
    file.setUnivNameWrStatus(False)
    file.setDescription(one_line(model.title)[:150])
    groups: dict[int, dict[str, NDArray[np.int64]]] = {
        1: mesh.node_sets
        | {_reference(tie): references[k] for k, tie in enumerate(model.ties)}
        | {_node(k): np.array([k]) for forces in model.forces for k in forces.nodes.tolist()},
        0: mesh.element_sets,
        -1: {face_group(mesh, name): place for name, place in places.items()},
        -3: {_reference(tie): np.array([k]) for k, tie in enumerate(model.ties)},
    }
    for level, named in groups.items():
        arrays = []
        for name, members in named.items():
            array = mc.DataArrayInt(np.sort(members))
            array.setName(name)
            arrays.append(array)
        if arrays:
            file.setGroupsAtLevel(level, arrays)
    _join_ungrouped(file)
    return file


def _join_ungrouped(file: Any) -> None:
    """Put nodes and cells that are in no group into family 0, which has none; meshio refuses other families without a group."""
    ungrouped = [file.getFamilyId(name) for name in file.getFamiliesNames() if not file.getGroupsOnFamily(name)]
    for level in file.getFamArrNonEmptyLevelsExt():
        families = file.getFamilyFieldAtLevel(level)
        for number in ungrouped:
            families.changeValue(number, 0)
    file.removeOrphanFamilies()


def _umesh(mc: Any, coordinates: Any, dimension: int, kind: Any, cells: NDArray[np.int64]) -> Any:
    mesh = mc.MEDCoupling1SGTUMesh("gears", kind)
    mesh.setCoords(coordinates)
    mesh.setNodalConnectivity(mc.DataArrayInt(np.ascontiguousarray(cells).ravel()))
    return mesh.buildUnstructured()


def _commands(model: Model, path: Path) -> Iterator[str]:
    """Return the command file. It follows Code_Aster 14 and later; unit 20 is the mesh, unit 80 the result."""
    mesh = model.mesh
    yield f"# {one_line(model.title)}\n# mm, N, MPa, t; unit 20: {path.name}, unit 80: results as MED\n"
    yield from (f"# {line}\n" for line in model.note_lines)
    yield "DEBUT(LANG='EN')\n\nmesh = LIRE_MAILLAGE(FORMAT='MED', UNITE=20)\n\n"
    contact_faces = [face_group(mesh, name) for pair in model.contacts for name in (pair.slave, pair.master)]
    solids = [*model.materials, *dict.fromkeys(contact_faces)]
    yield "model = AFFE_MODELE(MAILLAGE=mesh, AFFE=(\n"
    yield f"    _F(GROUP_MA={_names(solids)}, PHENOMENE='MECANIQUE', MODELISATION='3D'),\n"
    references = [_reference(tie) for tie in model.ties]
    if references:
        yield f"    _F(GROUP_MA={_names(references)}, PHENOMENE='MECANIQUE', MODELISATION='DIS_TR'),\n"
    yield "))\n\n"
    yield from _materials(model)
    if references:
        yield f"discrete = AFFE_CARA_ELEM(MODELE=model, DISCRET=_F(GROUP_MA={_names(references)}, "
        yield "CARA='K_TR_D_N', VALE=(0.0,) * 6))\n\n"
    yield from _charges(model)
    yield from _contact_zones(model)
    yield from _solution(model)
    yield "FIN()\n"


def _names(names: list[str]) -> str:
    return "(" + "".join(f"'{name}', " for name in names).rstrip() + ")"


def _materials(model: Model) -> Iterator[str]:
    for k, material in enumerate(model.materials.values(), 1):
        density = "" if material.density is None else f", RHO={T_PER_MM3_OF_KG_PER_M3 * material.density:.12g}"
        yield f"elastic{k} = DEFI_MATERIAU(ELAS=_F(E={material.youngs_modulus:.12g}, "
        yield f"NU={material.poisson_ratio:.12g}{density}))\n"
    yield "matter = AFFE_MATERIAU(MAILLAGE=mesh, AFFE=(\n"
    yield from (f"    _F(GROUP_MA='{name}', MATER=elastic{k}),\n" for k, name in enumerate(model.materials, 1))
    yield "))\n\n"


def _charges(model: Model) -> Iterator[str]:
    """Return supports and rigid sets (fixed), then loads and motions, which grow with the time."""
    held: list[str] = []
    moved: list[str] = []
    for support in model.supports:
        values = ", ".join(f"{MOTION_NAMES[d]}={support.value:.12g}" for d in support.directions)
        (moved if support.value else held).append(f"_F(GROUP_NO='{support.node_set}', {values})")
    loads: list[str] = []
    for tie in model.ties:
        name = _reference(tie)
        for motion, load, move, force in zip(tie.motion, tie.load, MOTION_NAMES, LOAD_NAMES, strict=True):
            if motion is not None:
                (moved if motion else held).append(f"_F(GROUP_NO='{name}', {move}={motion:.12g})")
            elif load:
                loads.append(f"_F(GROUP_NO='{name}', {force}={load:.12g})")
    rigid = [f"_F(GROUP_NO=('{tie.node_set}', '{_reference(tie)}'))" for tie in model.ties]
    yield from _charge("held", ("DDL_IMPO", held), ("LIAISON_SOLIDE", rigid))
    yield from _charge("loads", ("DDL_IMPO", moved), ("FORCE_NODALE", [*loads, *_node_forces(model)]))


def _node_forces(model: Model) -> list[str]:
    """Return forces on nodes; each node is a group, since names of nodes differ between versions."""
    return [
        f"_F(GROUP_NO='{_node(node)}', "
        + ", ".join(f"{a}={x:.12g}" for a, x in zip(LOAD_NAMES, force, strict=False))
        + ")"
        for forces in model.forces
        for node, force in zip(forces.nodes.tolist(), forces.forces.tolist(), strict=True)
    ]


def _charge(name: str, *keywords: tuple[str, list[str]]) -> Iterator[str]:
    given = [(keyword, entries) for keyword, entries in keywords if entries]
    if given:
        yield f"{name} = AFFE_CHAR_MECA(MODELE=model"
        for keyword, entries in given:
            yield f", {keyword}=(\n" + "".join(f"    {entry},\n" for entry in entries) + ")"
        yield ")\n\n"


def _contact_zones(model: Model) -> Iterator[str]:
    if not model.contacts:
        return
    rough = any(contact.friction for contact in model.contacts)
    yield "contact = DEFI_CONTACT(MODELE=model, FORMULATION='CONTINUE'"
    yield ", FROTTEMENT='COULOMB'" if rough else ""
    yield ", ALGO_RESO_CONT='NEWTON', ALGO_RESO_GEOM='POINT_FIXE', REAC_GEOM='SANS', ZONE=(\n"
    yield from (_zone(model.mesh, contact, rough) for contact in model.contacts)
    yield "))\n\n"


def _zone(mesh: HexMesh, contact: ContactPair, rough: bool) -> str:
    sides = f"GROUP_MA_MAIT='{face_group(mesh, contact.master)}', GROUP_MA_ESCL='{face_group(mesh, contact.slave)}'"
    slip = f", COULOMB={contact.friction:.12g}, ALGO_FROT='PENALISATION', COEF_PENA_FROT={0.1 * contact.stiffness:.12g}"
    stiffness = f"ALGO_CONT='PENALISATION', COEF_PENA_CONT={contact.stiffness:.12g}"
    return f"    _F({sides}, CONTACT_INIT='INTERPENETRE', {stiffness}{slip if rough else ''}),\n"


def _solution(model: Model) -> Iterator[str]:
    yield "ramp = DEFI_FONCTION(NOM_PARA='INST', VALE=(0.0, 0.0, 1.0, 1.0))\n"
    yield "times = DEFI_LIST_REEL(DEBUT=0.0, INTERVALLE=_F(JUSQU_A=1.0, NOMBRE=1))\n\n"
    held = bool(model.supports or model.ties)
    charges = ["_F(CHARGE=held)"] if held else []
    charges += ["_F(CHARGE=loads, FONC_MULT=ramp)"] if model.is_loaded else []
    yield "result = STAT_NON_LINE(\n    MODELE=model,\n    CHAM_MATER=matter,\n"
    yield "    CARA_ELEM=discrete,\n" if model.ties else ""
    yield f"    EXCIT=({', '.join(charges)},),\n"
    yield "    CONTACT=contact,\n" if model.contacts else ""
    yield "    COMPORTEMENT=_F(TOUT='OUI', RELATION='ELAS', DEFORMATION='PETIT'),\n"
    yield "    INCREMENT=_F(LIST_INST=times),\n    NEWTON=_F(MATRICE='TANGENTE', REAC_ITER=1),\n)\n\n"
    solids = _names(list(model.materials))
    yield f"result = CALC_CHAMP(reuse=result, RESULTAT=result, GROUP_MA={solids}, CONTRAINTE=('SIGM_NOEU',))\n"
    yield "IMPR_RESU(FORMAT='MED', UNITE=80, RESU=_F(RESULTAT=result))\n"


register(
    "aster", MED_SUFFIX, "Code_Aster: mesh and groups as MED, commands (.comm) beside it", write, require, sectors=False
)
