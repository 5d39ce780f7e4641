"""STEP files as three programs read them: OpenCASCADE, gmsh and FreeCAD, each in a process of its own but the first
and `gmsh_model`.

Of every solid: volume (mm^3) and centre of mass (mm).
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

needs_freecad = pytest.mark.skipif(shutil.which("freecadcmd") is None, reason="apt-get install freecad")
#: packages that write STEP files and read them again; tests import them when they run, for each takes 100 MB
needs_step = pytest.mark.skipif(not (find_spec("OCP") and find_spec("gmsh")), reason="OCP or gmsh is not installed")

GMSH = r"""
import json, sys
import gmsh
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.model.occ.importShapes(sys.argv[1])
gmsh.model.occ.synchronize()
solids = gmsh.model.getEntities(3)
print(json.dumps([[gmsh.model.occ.getMass(*solid), *gmsh.model.occ.getCenterOfMass(*solid)] for solid in solids]))
"""
#: with the reader's default, to read compounds as one, version 0.20 crashes on assemblies, its own among them
FREECAD = r"""
import json
import FreeCAD, Import, Part
FreeCAD.ParamGet("User parameter:BaseApp/Preferences/Mod/Import/hSTEP").SetBool("ReadShapeCompoundMode", False)
read = Part.read("{file}")
document = FreeCAD.newDocument("set")
Import.insert("{file}", document.Name)
found = {{
    "valid": read.isValid(),
    "solids": [[solid.Volume, *solid.CenterOfMass] for solid in read.Solids],
    "features": {{own.Label: len(own.Shape.Solids) for own in document.Objects}},
}}
open("{out}", "w").write(json.dumps(found))
"""


def by_opencascade(file: Path) -> list[list[float]]:
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer

    reader = STEPControl_Reader()
    reader.ReadFile(str(file))
    reader.TransferRoots()
    shape = reader.OneShape()
    assert BRepCheck_Analyzer(shape).IsValid()
    explorer, solids = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_SOLID), []
    while explorer.More():
        mass = GProp_GProps()
        BRepGProp.VolumeProperties_s(explorer.Current(), mass)
        centre = mass.CentreOfMass()
        solids.append([mass.Mass(), centre.X(), centre.Y(), centre.Z()])
        explorer.Next()
    return solids


@contextmanager
def gmsh_model(file: Path) -> Iterator[Any]:
    """The file as gmsh reads it, in this process."""
    import gmsh

    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.model.occ.importShapes(str(file))
        gmsh.model.occ.synchronize()
        yield gmsh.model
    finally:
        gmsh.finalize()


def by_gmsh(file: Path) -> list[list[float]]:
    done = subprocess.run([sys.executable, "-c", GMSH, str(file)], capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


def by_freecad(file: Path) -> dict[str, Any]:
    program, out = file.with_suffix(".py"), file.with_suffix(".json")
    program.write_text(FREECAD.format(file=file, out=out))
    subprocess.run(["freecadcmd", str(program)], input="", capture_output=True, text=True, check=True, cwd=file.parent)
    return json.loads(out.read_text())
