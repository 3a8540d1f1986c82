"""What a simulator believes, as data, and how beliefs are judged against measured logs."""

from models.log import MeasuredLog, read_log
from models.modelfile import ModelFile, load_model, load_models, read_model_file
from models.tables import load_tables, save_tables

__all__ = [
    "MeasuredLog",
    "ModelFile",
    "load_model",
    "load_models",
    "load_tables",
    "read_log",
    "read_model_file",
    "save_tables",
]
