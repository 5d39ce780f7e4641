"""Tool paths of ball-end cutters: passes, tool axes, motions, proof and cutter location files."""
