"""Planes of sections."""

#: word in the place of z for the section through the axis
AXIAL_PLANE = "axial"
