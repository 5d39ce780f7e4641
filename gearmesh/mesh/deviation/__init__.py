"""Bounds of how far a mesh is from its exact surfaces."""
