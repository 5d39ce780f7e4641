"""Fit of gears: backlash, clearance of tips, interference, and the movement that frees a pair."""
