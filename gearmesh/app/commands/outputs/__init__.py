"""Commands that write what is made: solids, models, pictures, reports."""
