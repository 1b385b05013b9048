"""How accurate are MIL methods when nothing is chosen on test folds?

Five times ten fixed folds of published sets, scored by plain and balanced accuracy and AUC, as others report
them. `settings` holds what is compared, `run` learns from the folds of one repetition, `analysis` turns the
table into findings. The command and the result are in ``README.md``, with what was found in the code of
others.
"""
