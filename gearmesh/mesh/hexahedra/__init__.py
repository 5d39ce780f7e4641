"""Hexahedra of teeth, rim and body for finite-element models."""
