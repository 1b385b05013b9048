"""How does covariant aggregation compare with other MIL methods?

The data sets are those of Palmer (2015), chapter 3. `data` and `methods` name what is compared, `settings`
pairs them and sets the bounds, `published` holds the source's tables. `run` learns from a fold in a process
with limited time. `results` groups the rows of the table, `analysis` lays them out, `bounds` checks them, and
`pictures` draws them. The command and the result are in ``README.md``.
"""
