"""The nominal physical world: every dimension with its unit and where it comes from."""

from __future__ import annotations

import math

# Arena (paper, III-I)
ARENA_RADIUS = 0.60
"""m: a circle of diameter 1.2 m."""
WALL_HEIGHT = 0.10
"""m; our choice: higher than a robot."""
WALL_THICKNESS = 0.02
"""m; our choice: several times what a robot moves in one physics step."""
WALL_FACETS = 120
"""Boxes that make the ring; their middles touch the circle, their corners leave it by 0.2 mm."""
NEST = (0.50, 0.0, 0.20)
"""m: x, y, radius. Radius and cutting the boundary: the paper. The centre: our choice."""
FOOD_ITEMS = 7
"""Always present (paper, III-I)."""
FOOD_RADIUS = 0.05
"""m; our choice: an item is under a robot when the robot covers part of a 15 mm token."""

# Body of an e-puck
BODY_RADIUS = 0.035
"""m; gctronic driver, argos3-epuck."""
BODY_BOTTOM = 0.006
"""m above the floor; our choice, only skids and wheels touch the floor."""
BODY_TOP = 0.075
"""m; an e-puck (0.05 m) with its Linux extension board: our estimate (paper, Fig. 3)."""
MASS = 0.15
"""kg (e-puck)."""
WHEEL_MASS = 0.008
"""kg; our choice."""
SKID_MASS = 0.001
"""kg; our choice."""
BODY_INERTIA = tuple(
    (MASS - 2.0 * WHEEL_MASS - SKID_MASS) / 12.0 * squares
    for squares in 2 * ((2.0 * BODY_RADIUS) ** 2 + (BODY_TOP - BODY_BOTTOM) ** 2,)
    + (2.0 * (2.0 * BODY_RADIUS) ** 2,)
)
"""kg m^2 about x, y, z of what is neither wheel nor skid: as pybullet has it, of the box around."""
WHEEL_RADIUS = 0.0205
"""m; argos3-epuck."""
AXLE = 0.053
"""m; gctronic driver, argos3-epuck."""
WHEEL_INERTIA = 1e-5
"""kg m^2 about a wheel's axis: hardly the wheel's own, but that of its motor's rotor (some
4e-9 kg m^2, our estimate for so small a stepper) seen through the e-puck's 50:1 gear. With the bare
wheel's 1.3e-6 motor and tyre would fight each other in the solver, which then needs four times the
iterations."""
CENTRE_OF_MASS = (0.008, 0.0, 0.010)
"""m from the axle's middle on the floor: low and ahead of the axle, as the battery sits.
Higher or further back tips the robot when it brakes or starts."""
SKID = 0.030
"""m ahead of the axle: where a frictionless skid carries a quarter of the weight."""
SKID_RADIUS = 0.004
"""m; our choice."""
SKID_CLEARANCE = 1e-4
"""m between the skid and the floor while the body is level; our choice."""
WHEEL_SPEED_MAX = 2.0 * math.pi
"""rad/s: 1000 steps/s at 1000 steps per revolution."""
WHEEL_STEP = 2.0 * math.pi / 1000.0
"""rad the encoders resolve: 1000 steps per revolution (e-puck's steppers)."""

# Motors and friction
MOTOR_TORQUE = 0.0076
"""N m per wheel; our choice: 3.8 m/s^2, so that a full stop does not skid. A fresh command reaches
two thirds of its displacement in the first 40 ms."""
WHEEL_FRICTION = 1.2
"""Rubber tyre on the floor (floor friction 1); our choice: full reversals do not skid."""
GRAVITY = 9.81
"""m/s^2."""
BODY_FRICTION = 0.3
"""Plastic against wall and other robots; our choice."""

# Physics: see docs/convergence.md for the study behind these
PHYSICS_STEP = 0.010
"""s."""
SOLVER_ITERATIONS = 14
"""Of pybullet."""
STRICT_ITERATIONS = 26
"""Of pybullet held to every bound: with 24 robots creep by 0.012 mm/s at rest, with 27 they gain
1.7 % of momentum when they meet."""
STRICT_SLOP = 1e-6
"""m by which contacts overlap unpunished there: with none, what headings differ by doubles; with
3e-6 robots roll faster by themselves."""
NEWTON_ITERATIONS = 50
"""Most of MuJoCo's, which stops after a few; with one or two it is wrong."""
CONTACT_THRESHOLD = 3e-5
"""m; the engine's default of 2 cm keeps stale contacts under rolling wheels."""
CONTROL_STEP = 0.04
"""s (paper, III-D)."""

# Infrared (real e-puck2: counts = A / (d + 9 mm)^2)
SENSOR_HEIGHT = 0.033
"""m above the floor (e-puck ring)."""
IR_OFFSET = 0.009
"""m, of the inverse-square law."""
IR_CONTACT_COUNTS = (3600.0, 540.0, 900.0, 900.0, 900.0, 900.0, 540.0, 3600.0)
"""counts at contact, head on: front pair 3400-3900 and side-front 540 measured; the others lie
between and are our choice."""
IR_RANGE = 0.15
"""m; our choice: beyond, a front sensor reads under 12 counts."""
IR_NOISE = 0.14
"""relative s.d. (real e-puck2, robust)."""
IR_NOISE_FLOOR = 2.0
"""counts s.d.; our choice."""
IR_OUTLIERS = (0.20, 0.03, 0.03, 0.03, 0.03, 0.03, 0.03, 0.20)
"""share of gross outliers: front pair 18-26 %, sides at most 4 % (real e-puck2)."""
COUNTS_MAX = 4095.0
"""12-bit converter."""

# Light
LAMP_RADIUS = 0.60
"""m from the centre: a window in the arena's wall (paper, Fig. 3)."""
LAMP_HEIGHT = 0.10
"""m above the floor; our choice."""
LAMP_POWER = 23.7
"""counts m^2: a facing sensor of a robot at 0.8 m reads 40 counts, the controller's contrast
threshold; contrast that fades at 0.6-1.0 m gives the paper's ordering of conditions."""
LIGHT_EXPONENT = 2.0
"""of the inverse-square law."""
LIGHT_DARK = 4095.0
"""counts in full darkness, falling with light (Webots; the real driver uses 4096 - raw)."""
LIGHT_AMBIENT = 60.0
"""counts of room light on every sensor; our choice."""
LIGHT_NOISE = 5.0
"""counts s.d.; our choice, an eighth of the contrast threshold."""

# Tracker and radio
TRACKER_NOISE = 5e-4
"""m s.d. per axis (Vicon-like)."""
TRACKER_YAW_NOISE = math.radians(0.3)
"""rad s.d."""
RADIO_RANGE = 0.20
"""m between centres (paper, III-B)."""
RADIO_PERIOD = 0.2
"""s between broadcasts; our choice: two robots that pass one another exchange several."""
START_WITHIN = 5.0
"""s: robots start asynchronously "within seconds" (paper, III-I)."""
