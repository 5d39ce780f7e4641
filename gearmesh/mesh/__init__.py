"""Triangles to a tolerance, closed solids, hexahedra."""
