"""Figures by which measured cylindrical gears are evaluated."""
