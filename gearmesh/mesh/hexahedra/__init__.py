"""Hexahedra of teeth and rim, as finite-element models want them."""
