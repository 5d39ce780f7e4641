"""Files that people hand in, read within limits, and tables of text: what is wrong with them is one line."""
