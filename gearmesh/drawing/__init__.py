"""Workshop drawings of members: views with dimensions, table of gear data, title block."""
