"""Faces of teeth as CAD has them: their shapes in parameters, and the chamfers of end faces."""
