"""Gear systems: a design becomes a gear set of members and the pairs that mesh. One folder per system."""
