"""The report page: one HTML file with everything about a design, which needs no network.

`stage` makes the data of the three-dimensional view, `page` the file of texts, tables, figures and the scripts beside it; three.js
is built by scripts/build_three.py.
"""
