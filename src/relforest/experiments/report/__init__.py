"""What studies and runs have found, as one page that opens offline.

`section` is what a page consists of, `folders` and `of_run` read it from folders, `page` writes it as HTML.
"""
