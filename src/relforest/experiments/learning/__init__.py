"""How many episodes do learners need, how well do they play then, and does that carry over to more objects?

`settings` lists the learners and the hand-made policies of each task, `run` plays what they have learned,
`analysis` compares them, `statements` has what the source says, and `figures` its curves. One package is four
studies: keepaway, high towers, color grouping and arches. The commands and the results are in ``README.md``.
"""
