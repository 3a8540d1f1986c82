"""Lab formats, read into the measured log's table. One module per format."""
