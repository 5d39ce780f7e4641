"""File formats of meshes, a module each."""
