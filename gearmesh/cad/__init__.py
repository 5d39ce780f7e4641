"""Members as CAD solids, of spline faces, planes, cylinders and cones, and their sections: STEP, DXF, SVG."""
