"""Do trees, forests and rules recover known concepts, also in larger scenes?

`settings` holds the concepts and thresholds, `run` learns a model and tests it, `analysis` turns the table
into findings and a figure. The command and the result are in ``README.md``.
"""
