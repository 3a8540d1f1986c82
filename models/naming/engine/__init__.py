"""The mixed model that judges every channel: it knows neither wheels nor sensors."""
