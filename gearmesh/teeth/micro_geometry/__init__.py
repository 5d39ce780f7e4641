"""Micro-geometry: modifications of flanks, and topographies measured on them."""
