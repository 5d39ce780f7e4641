"""Flanks as they are measured: nominal points and normals for machines, and real flanks from what these give back."""
