"""Workshop drawings of members: views with dimensions, the table of gear data, the title block."""
