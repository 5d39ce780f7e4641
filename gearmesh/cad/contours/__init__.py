"""Contours of sections: their curves, drawn as arcs, splines or polylines, and their parallels for wire and laser."""
