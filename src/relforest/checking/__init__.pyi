from .models import check_model
from .policies import check_policy
from .situations import Situation, Verdict, read_situations

__all__ = ["Situation", "Verdict", "check_model", "check_policy", "read_situations"]
