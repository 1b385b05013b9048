from .arff import read_arff
from .c45 import read_c45
from .csv_table import read_csv

__all__ = ["read_arff", "read_c45", "read_csv"]
