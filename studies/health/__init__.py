"""Health: what sound robots do, from logs or from runs recorded for it."""
