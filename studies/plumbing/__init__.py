"""What every command stands on: whole outputs, rooms, workers, signals, progress, provenance."""
