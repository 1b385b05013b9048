"""Do games and learning match RoboCup 2-D, and how fast are they?

`settings` lists what is played and what real games gave, `trajectories` reads recorded games, `run` makes one
measurement, `analysis` turns the table into findings and pictures. The command and the result
are in ``README.md``.
"""
