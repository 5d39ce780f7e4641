"""Files from users, read within limits, and tables of text; an error is one line."""
