"""Spiral, zerol, straight bevel and hypoid gears cut by head cutters [AB; CR3553; ISO 23509], and conjugate geometries."""
