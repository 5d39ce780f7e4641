"""Parts of a member as CAD solids."""
