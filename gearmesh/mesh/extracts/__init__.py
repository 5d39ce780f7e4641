"""Meshes of parts of a member: sectors of some pitches."""
