"""Suffixes of the files that hold CAD solids and sections."""

#: of STEP files
STEP = (".step", ".stp")
#: of drawings of a section, one each
DXF, SVG = ".dxf", ".svg"
#: of all of them
SECTIONS = (DXF, SVG)
#: the section through the axis, in the place of z
AXIAL = "axial"
