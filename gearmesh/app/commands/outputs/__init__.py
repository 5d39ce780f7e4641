"""Commands that write files: solids, models, pictures, reports."""
