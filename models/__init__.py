"""What a simulator believes, as data, and how beliefs are judged against measured logs."""

from realitygap.models.belief.modelfile import ModelFile, load_model, load_models, read_model_file
from realitygap.models.belief.tables import load_tables, save_tables
from realitygap.models.log.measured import MeasuredLog, read_log

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
