"""How teeth give way: bending of teeth and body by hexahedra, contact compliance of half-spaces."""
