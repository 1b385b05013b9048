"""Does a run that is killed and restarted end with the same bytes?

`settings` holds the variants, `run` kills ``relforest learn`` and compares what it leaves behind, `analysis`
turns the table into findings. The command and the result are in ``README.md``.
"""
