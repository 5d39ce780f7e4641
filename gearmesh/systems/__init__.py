"""Gear systems: from a design to a gear set of members and pairs in mesh. There is one folder per system."""
