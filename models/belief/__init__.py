"""What a simulator believes, as data: model files, captured tables, and the catalogue of causes."""
