#!/usr/bin/env bash
# gmsh 4.15.2: names of groups in MED files keep the blanks that fill their 80 characters.
# Expected: a group "body" of a MED file of medcoupling (the library of Salome and Code_Aster) is the physical group "body", as
#   medcoupling and Code_Aster name it; blanks only fill the fixed width of a name in the format.
# Seen: its name is "body" and 76 blanks, so that a script that looks for "body" finds no group. After gmsh has written the file as
#   .msh, the blanks are in its physical names, too. No warning. Files that gmsh itself writes come back without blanks.
# Versions: gmsh 4.15.2, medcoupling 9.15.0 (NumPy 2.4.6).
# Meets: whoever takes a mesh with groups from Salome, Code_Aster or medcoupling into gmsh, or through it to another format.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q gmsh==4.15.2 medcoupling==9.15.0 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'END'
import gmsh
import medcoupling as mc

cube = mc.MEDCouplingCMesh("cube")
cube.setCoords(*[mc.DataArrayDouble([0.0, 1.0])] * 3)
mesh = cube.buildUnstructured()
file = mc.MEDFileUMesh()
file.setMeshAtLevel(0, mesh)
group = mc.DataArrayInt([0])
group.setName("body")
file.setGroupsAtLevel(0, [group])
# gmsh reads MED up to 4.1
file.write40("cube.med", 2)
assert mc.MEDFileUMesh("cube.med").getGroupsNames() == ("body",)

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)


def names(path):
    gmsh.clear()
    gmsh.open(path)
    return [gmsh.model.getPhysicalName(*group) for group in gmsh.model.getPhysicalGroups()]


(first,) = names("cube.med")
gmsh.write("cube.msh")
gmsh.write("again.med")
print(f"medcoupling: 'body'; gmsh: {first!r} ({len(first)} characters)")
print(f"by .msh: {len(names('cube.msh')[0])} characters")
assert first != "body", "gmsh strips the names now"
assert first == "body".ljust(80)
assert names("cube.msh")[0].strip() == "body" != names("cube.msh")[0]
END
