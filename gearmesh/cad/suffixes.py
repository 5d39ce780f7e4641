"""Suffixes of files with CAD solids and sections."""

#: suffixes of STEP files
STEP_SUFFIXES = (".step", ".stp")
#: suffixes of section drawings
DXF_SUFFIX, SVG_SUFFIX = ".dxf", ".svg"
#: suffixes of all section drawings
SECTION_SUFFIXES = (DXF_SUFFIX, SVG_SUFFIX)
#: word in the place of z for the section through the axis
AXIAL_PLANE = "axial"
