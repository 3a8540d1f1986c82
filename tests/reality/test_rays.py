"""Rays in closed form, ray by ray: against the surfaces' own equations and beside the engines'."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from realitygap.reality import constants as k
from realitygap.reality.effects import parse_effects
from realitygap.reality.pybullet_engine import PybulletEngine
from realitygap.reality.rays import RAYS, ClosedRays
from realitygap.reality.world import World, scatter
from tests.reality.test_senses import rays

RADIUS = k.ARENA_RADIUS
EXACT = 1e-9
"""m: rounding, of rays that all but graze what they meet."""
_CORNER = RADIUS / math.cos(math.pi / k.WALL_FACETS)
_AT = 2.0 * math.pi * (np.arange(k.WALL_FACETS + 1) - 0.5) / k.WALL_FACETS
CORNERS = _CORNER * np.stack([np.cos(_AT), np.sin(_AT)], axis=1)
"""Of the polygon whose sides touch the arena's circle."""


class Hits(NamedTuple):
    fraction: np.ndarray
    normals: np.ndarray
    on_robot: np.ndarray


def asked(of: Any, start: np.ndarray, end: np.ndarray) -> Hits:
    """What somebody answers of rays."""
    n = len(start)
    hits = Hits(np.zeros(n), np.zeros((n, 2)), np.zeros(n, dtype=np.bool_))
    of.cast(start, end, *hits)
    return hits


def facet_met(p: np.ndarray, q: np.ndarray) -> tuple[float, int]:
    """Share of the way from p to q at which the polygon is crossed, and by which side (or 1)."""
    best, side = 1.0, -1
    for i in range(k.WALL_FACETS):
        along = CORNERS[i + 1] - CORNERS[i]
        both = np.stack([q - p, -along], axis=1)
        if abs(np.linalg.det(both)) < 1e-15:
            continue
        t, u = np.linalg.solve(both, CORNERS[i] - p)
        if 0.0 <= t < best and -1e-12 <= u <= 1.0 + 1e-12:
            best, side = float(t), i
    return best, side


def cylinder_met(p: np.ndarray, q: np.ndarray, centre: np.ndarray) -> float:
    """Share of the way from p to q at which a body is entered, or 1."""
    way, off = q - p, p - centre
    found = np.roots([way @ way, 2.0 * off @ way, off @ off - k.BODY_RADIUS**2])
    real = [float(root.real) for root in found if abs(root.imag) < 1e-15 and 0 <= root.real <= 1]
    return min(real, default=1.0)


angles = st.floats(-math.pi, math.pi)


@settings(max_examples=150, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    robots=st.integers(0, 12),
    bearing=angles,
    out=st.floats(0.0, 0.999),
    heading=angles,
    reach=st.floats(0.01, 1.3),
)
def test_a_ray_ends_where_the_nearest_of_all_surfaces_is_by_its_own_equation(
    seed: int, robots: int, bearing: float, out: float, heading: float, reach: float
) -> None:
    poses = scatter(robots, np.random.default_rng(seed))
    p = RADIUS * out * np.array([math.cos(bearing), math.sin(bearing)])
    q = p + reach * np.array([math.cos(heading), math.sin(heading)])
    apart = np.hypot(*(poses[:, :2] - p).T)
    assume((apart >= k.BODY_RADIUS).all())  # rays begin outside of bodies
    assume(all(abs(off) > 1e-9 for off in _beside(p, q, poses)))  # and none grazes one
    wall, side = facet_met(p, q)
    bodies = [cylinder_met(p, q, pose[:2]) for pose in poses]
    expected = min([wall, *bodies])
    start, end = (np.array([[*point, k.SENSOR_HEIGHT]]) for point in (p, q))
    hits = asked(ClosedRays(poses, RADIUS), start, end)
    assert hits.fraction[0] * reach == pytest.approx(expected * reach, abs=EXACT)
    if expected == 1.0:
        return
    met = p + expected * (q - p)
    assert hits.on_robot[0] == (min(bodies, default=1.0) < wall)
    if hits.on_robot[0]:
        normal = (met - poses[int(np.argmin(bodies)), :2]) / k.BODY_RADIUS
    else:
        facing = CORNERS[side] + CORNERS[side + 1]
        normal = -facing / np.hypot(*facing)
        if min(np.hypot(*(CORNERS - met).T)) < EXACT:  # in a corner either side will do
            return
    assert hits.normals[0] == pytest.approx(normal, abs=1e-7)


def _beside(p: np.ndarray, q: np.ndarray, poses: np.ndarray) -> list[float]:
    """m by which a line misses, or cuts, the rims of the bodies."""
    u = (q - p) / np.hypot(*(q - p))
    off = poses[:, :2] - p
    return (np.abs(off[:, 0] * u[1] - off[:, 1] * u[0]) - k.BODY_RADIUS).tolist()


def test_a_ray_that_begins_in_a_body_or_behind_the_wall_meets_it_at_once() -> None:
    start = np.array([[0.01, 0.0, 0.0], [0.61, 0.0, 0.0], [0.61, 0.0, 0.0]])
    end = np.array([[-0.1, 0.0, 0.0], [0.7, 0.0, 0.0], [0.5, 0.0, 0.0]])
    hits = asked(ClosedRays(np.zeros((1, 3)), RADIUS), start, end)
    assert hits.fraction.tolist() == [0.0, 0.0, 1.0]  # the last comes back in


def test_a_ray_that_just_reaches_the_wall_ends_there_and_one_that_does_not_meets_nothing() -> None:
    middles = 2.0 * math.pi * np.arange(k.WALL_FACETS) / k.WALL_FACETS
    out = np.stack([np.cos(middles), np.sin(middles), 0.0 * middles], axis=1)
    nobody = np.zeros((0, 3))
    for beyond, met in ((1e-6, True), (-1e-6, False)):
        hits = asked(ClosedRays(nobody, RADIUS), 0.5 * out, (RADIUS + beyond) * out)
        assert ((hits.fraction < 1.0) == met).all()
        if met:
            assert 0.5 + hits.fraction * (RADIUS + beyond - 0.5) == pytest.approx(RADIUS, abs=EXACT)
            assert hits.normals == pytest.approx(-out[:, :2], abs=1e-12)


def test_without_a_wall_only_bodies_are_met() -> None:
    start, end = np.array([[0.0, 0.0, 0.0]] * 2), np.array([[9.0, 0.0, 0.0], [0.0, 9.0, 0.0]])
    hits = asked(ClosedRays(np.array([[1.0, 0.0, 0.0]]), None), start, end)
    assert hits.fraction == pytest.approx([(1.0 - k.BODY_RADIUS) / 9.0, 1.0])


def compared(of: Any, crowds: int) -> dict[str, np.ndarray]:
    """m by which somebody's sensor rays are longer than the closed form's, by what they meet.

    `of` makes who is asked from poses; "apart": which rays meet something else.
    """
    random = np.random.default_rng(5)
    longer, robot, apart = [], [], []
    for _ in range(crowds):
        poses = scatter(10, random)
        other, exact = (
            asked(of(poses), *rays(poses)),
            asked(ClosedRays(poses, RADIUS), *rays(poses)),
        )
        differs = (other.on_robot != exact.on_robot) & (exact.fraction < 1.0)
        apart.append(differs | ((other.fraction < 1.0) != (exact.fraction < 1.0)))
        longer.append(k.IR_RANGE * (other.fraction - exact.fraction))
        robot.append(np.where(exact.fraction < 1.0, exact.on_robot, np.nan))
    met, both = np.concatenate(robot), ~np.concatenate(apart)
    length = np.concatenate(longer)
    return {
        "robot": length[both & (met == 1.0)],
        "wall": length[both & (met == 0.0)],
        "apart": np.concatenate(apart),
    }


def test_pybullets_rays_are_shorter_by_what_its_cylinders_are_thicker() -> None:
    """Half a millimetre in the mean, 3 mm at most but where rays graze; walls to a quarter."""

    def of(poses: np.ndarray) -> PybulletEngine:
        world = PybulletEngine()
        worlds.append(world)
        world.add_ring()
        for pose in poses.tolist():
            world.add_epuck(pose)
        return world

    worlds: list[PybulletEngine] = []
    off = compared(of, 60)
    for world in worlds:
        world.close()
    assert min(len(off["robot"]), len(off["wall"])) > 150
    assert -1e-3 < off["robot"].mean() < -1e-4
    assert np.quantile(np.abs(off["robot"]), 0.9) < 3e-3
    assert np.abs(off["wall"]).mean() < 2.5e-4
    assert off["apart"].mean() < 0.01


def test_mujocos_own_rays_against_cylinders_and_boxes_end_in_the_same_places() -> None:
    mujoco = pytest.importorskip("mujoco")

    class Solid:
        """Cylinders and the wall's facets as MuJoCo's shapes."""

        def __init__(self, poses: np.ndarray) -> None:
            spec = mujoco.MjSpec()
            thick = 0.01
            for facet in 2.0 * np.pi * np.arange(k.WALL_FACETS) / k.WALL_FACETS:
                spec.worldbody.add_geom(
                    type=mujoco.mjtGeom.mjGEOM_BOX,
                    size=[thick, RADIUS * math.tan(math.pi / k.WALL_FACETS), 0.1],
                    pos=[(RADIUS + thick) * math.cos(facet), (RADIUS + thick) * math.sin(facet), 0],
                    quat=[math.cos(0.5 * facet), 0.0, 0.0, math.sin(0.5 * facet)],
                )
            for x, y, _ in poses.tolist():
                spec.worldbody.add_geom(
                    type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=[k.BODY_RADIUS, 0.1, 0], pos=[x, y, 0]
                )
            self._model = spec.compile()
            self._data = mujoco.MjData(self._model)
            mujoco.mj_forward(self._model, self._data)

        def cast(self, start: Any, end: Any, fraction: Any, normals: Any, on_robot: Any) -> None:
            hit = np.zeros(1, dtype=np.int32)
            for n in range(len(start)):
                way = end[n] - start[n]
                far = mujoco.mj_ray(self._model, self._data, start[n], way, None, 1, -1, hit)
                fraction[n] = far if 0.0 <= far < 1.0 else 1.0
                on_robot[n] = fraction[n] < 1.0 and hit[0] >= k.WALL_FACETS

    off = compared(Solid, 15)
    assert min(len(off["robot"]), len(off["wall"])) > 40
    assert not off["apart"].any()
    assert np.abs(off["robot"]).max() < 1e-9
    assert np.abs(off["wall"]).max() < 1e-9


@pytest.mark.parametrize("albedo", [1.0, 0.5])
def test_a_world_with_closed_rays_reads_all_but_what_one_with_the_engines_reads(
    albedo: float,
) -> None:
    """The same motion and noise as with the engine's: what differs is what its cylinders do."""
    specs = () if albedo == 1.0 else (f"wall_albedo:scale={albedo}",)
    seen: dict[str, list[np.ndarray]] = {name: [] for name in RAYS}
    for name in RAYS:
        hidden = parse_effects(specs, 8)
        world = World(8, np.random.SeedSequence(2), effects=hidden, rays=name)
        for _ in range(50):
            world.sense()
            seen[name].append(world.infrared.counts.copy())
            world.act(np.full((8, 2), 5.0))
        world.close()
    engine, closed = (np.array(seen[name]) for name in ("engine", "closed"))
    assert 0.0 < np.abs(engine - closed).mean() < 2.0
    assert np.corrcoef(engine.ravel(), closed.ravel())[0, 1] > 0.995
