"""Triangles of the chamfers at the end faces of teeth."""
