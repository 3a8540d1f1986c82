"""Does a better model bring more food? Three models on board, in altered realities."""
