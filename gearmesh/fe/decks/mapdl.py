"""Ansys archive (.cdb): hexahedra as SOLID185 or SOLID186, a component for each set, and materials.

mapdl-archive writes it. The archive has no supports, contacts and loads; the components for them are there.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gearmesh.errors import OutputError
from gearmesh.fe.decks.registry import register
from gearmesh.fe.decks.vtu import members
from gearmesh.fe.model import Model
from gearmesh.formats import CDB_SUFFIX
from gearmesh.io.atomic import whole_file

#: message without mapdl-archive
MISSING_PACKAGE = 'Ansys archives need mapdl-archive: pip install "gearmesh[ansys]"'
#: enhanced strains, as in C3D8I, for SOLID185, which is type 3 of mapdl-archive
_ENHANCED_STRAINS = "KEYOPT,3,2,2\n"


def write(model: Model, path: Path) -> None:
    """Write mesh, sets and materials. Raises OutputError without mapdl-archive."""
    try:
        import mapdl_archive
    except ImportError:
        raise OutputError("cannot write", path, reason=MISSING_PACKAGE) from None
    import pyvista

    mesh = model.mesh
    kind = pyvista.CellType.QUADRATIC_HEXAHEDRON if mesh.second_order else pyvista.CellType.HEXAHEDRON
    grid = pyvista.UnstructuredGrid({kind: mesh.elements}, mesh.nodes)
    material = np.zeros(len(mesh.elements), np.int32)
    properties = [] if mesh.second_order else [_ENHANCED_STRAINS]
    for number, (name, own) in enumerate(model.materials.items(), 1):
        material[mesh.element_sets[name]] = number
        properties.append(f"MP,EX,{number},{own.youngs_modulus:.12g}\nMP,PRXY,{number},{own.poisson_ratio:.12g}\n")
    grid.cell_data["ansys_material_type"] = material
    grid.cell_data["ansys_real_constant"] = np.ones(len(mesh.elements), np.int32)
    for name, nodes in mesh.node_sets.items():
        grid.point_data[name] = members(nodes, len(mesh.nodes))
    for name, elements in mesh.element_sets.items():
        grid.cell_data[name] = members(elements, len(mesh.elements))
    with whole_file(path) as temporary:
        mapdl_archive.save_as_archive(temporary, grid, reset_etype=True, comments=["mm, N, MPa", *model.note_lines])
        with open(temporary, "a", encoding="ascii", newline="\n") as file:
            file.writelines(properties)


register("ansys", CDB_SUFFIX, "Ansys archive: mesh, a component for each set, materials", write)
