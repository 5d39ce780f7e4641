"""Sheets of bevel pairs and members: settings, dimensions, forces, measures."""
