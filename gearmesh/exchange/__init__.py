"""Files that gear programs exchange: REXS models, read and written; what gears they describe is up to the systems."""
