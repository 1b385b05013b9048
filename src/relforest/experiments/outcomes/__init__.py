"""Do forests predict whether an action succeeds, here and among more objects?

`settings` holds the tasks, `scenes` draws and publishes their scenes, `rivals` and `networks` are the other
learners. `run` learns and tests, `protocol` repeats the source's experiment, `statements` tests what the
source says about it, `analysis` turns the table into findings and figures. The command and the result are in
``README.md``.
"""
