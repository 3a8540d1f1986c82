"""The names of the manoeuvres in `probes.MENU`, for who only lists them: it needs no numpy."""

NAMES = (
    "straights",
    "spins",
    "steps",
    "square",
    "slow-ramp",
    "circle",
    "figure-eight",
    "tour",
    "dark-tour",
    "face-to-face",
    "alone",
)
"""In the order they are shown."""
