"""Measured flanks: nominal points and normals for measuring machines, and real flanks from their measured points."""
