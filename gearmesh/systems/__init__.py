"""Gear systems: a design becomes a train of members and the pairs that mesh. One folder a system."""
