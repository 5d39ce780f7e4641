"""The report page: one HTML file with everything about a design; it needs no network.

`stage` makes the data of the three-dimensional view. `page` makes the file from texts, tables, figures and the scripts
in this folder. scripts/build_three.py builds three.js.
"""
