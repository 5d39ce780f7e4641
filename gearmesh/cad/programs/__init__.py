"""Parts and assemblies as CAD programs have them."""
