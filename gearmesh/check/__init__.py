"""Checks independent of the contact solver: deviation of meshes from exact surfaces, and the roll test."""
