"""Pictures of tools in place: tools that generate a flank, and cutters on their passes."""
