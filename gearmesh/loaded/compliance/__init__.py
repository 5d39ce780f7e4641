"""Compliance of teeth: bending of teeth and body by hexahedra, local contact compliance by half-spaces."""
