"""Faces of teeth for CAD: surfaces with the parameter curves of their edges, and chamfers of end faces."""
