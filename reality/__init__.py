"""The pybullet world: what stands for reality, and the physical effects hidden in it."""
