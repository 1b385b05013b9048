from .conversion import as_model
from .model import Model, Predictions
from .model_file import read_model, write_model
from .prediction_table import prediction_table
from .saving import load, save
from .training_data import TrainingData, read_training_data

__all__ = [
    "Model",
    "Predictions",
    "TrainingData",
    "as_model",
    "load",
    "prediction_table",
    "read_model",
    "read_training_data",
    "save",
    "write_model",
]
