"""Meshes of parts of a member: sectors of some pitches, spaces between teeth, flanks."""
