from .page import play_page
from .program import Program, program_of
from .python_code import python_code
from .sql_code import sql_code

__all__ = ["Program", "play_page", "program_of", "python_code", "sql_code"]
