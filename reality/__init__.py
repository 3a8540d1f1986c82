"""The pybullet world: what stands for reality, and the physical effects that can be hidden in it."""
