"""Pictures of tools in place: what generates a flank, and cutters on their passes."""
