"""How fast does SMRF-RPI learn, and what do densities add?

`settings` holds the conditions and the rewards to be reached, `run` learns one run, `analysis` turns the
table into findings and Figures 7.2 to 7.4. The command and the result are in ``README.md``.
"""
