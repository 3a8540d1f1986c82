"""The gap in fitness: what a simulator promised (F_S) less what reality paid (F_R), taken apart.

`by_third` needs nothing but a run's generations: what the robot's model and what a wrong belief
about the light add. `anew` evaluates the deployed controllers once more, with the model that was on
board, and so also tells the winner's curse. `generations` says which generations count.
"""
