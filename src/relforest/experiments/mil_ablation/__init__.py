"""What does each part of a committee of volumes contribute?

`made_up` draws bags that mimic difficulties of published sets, `settings` holds the data sets and the
variants, `run` turns a data set into rows, `analysis` turns the table into findings and a figure. The
command and the result are in ``README.md``.
"""
