"""Passes of a ball-end cutter that finishes the spaces between teeth on a five-axis machine, and the proof of what it leaves."""
