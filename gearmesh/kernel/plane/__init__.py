"""Plane geometry: lines and arcs of sections and openings."""
