"""Meshes against the exact surfaces, and the roll test, of flanks and of whole members, which never sees the solver."""
