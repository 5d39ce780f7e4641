"""Trains of several stages: kinematics, positions in mesh, bodies, and transmission error of the output."""
