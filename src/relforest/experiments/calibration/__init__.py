"""How often does each test accept a question about noise?

`settings` holds the sizes of the scene sets, `run` grows trees on shuffled labels, `analysis` turns the table
into false-positive rates and a figure. The command and the result are in ``README.md``.
"""
