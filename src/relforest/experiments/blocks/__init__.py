"""Does our blocks world match the author's, and which policies work?

`settings` lists what is dropped, lifted and played and what the author's simulator gave, `run` makes one
measurement with the help of `episodes`, `samples` groups the rows of the table, `analysis` turns them into
findings and `pictures` into figures. The command and the result are in ``README.md``.
"""
