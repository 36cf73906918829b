import numpy as np
import pytest
from kit.tabletop import BLUE, GREEN, HEAD, TABLE, TYPES, picture

from skolem.sim.physics import camera
from skolem.sim.robot import bodies
from skolem.sim.robot.bullet import p
from skolem.sim.space.pinhole import pixel_rays

PIXEL_STRIDE = 4
AGREES_M = 1e-5
SCENE = [TABLE, ("soda", (1.0, -0.2, 0.68, 0.0), GREEN), ("carton", (1.2, 0.25, 0.68, 0.6), BLUE)]


def test_depth_agrees_with_ray_casting() -> None:
    client = bodies.connect()
    bodies.floor(client)
    for name, world_T_object, _ in SCENE:
        bodies.object_body(client, TYPES[name], world_T_object, bodies.WOOD, 0.0)
    image = camera.render(client, HEAD)
    rays = pixel_rays(320, 240)[::PIXEL_STRIDE, ::PIXEL_STRIDE].reshape(-1, 3) @ HEAD.axes.T
    near, far = HEAD.origin + rays * camera.NEAR_M, HEAD.origin + rays * camera.FAR_M
    hits = p.rayTestBatch(near.tolist(), far.tolist(), physicsClientId=client)
    bodies.disconnect(client)
    cast = camera.NEAR_M + np.array([hit[2] for hit in hits]) * (camera.FAR_M - camera.NEAR_M)
    body = np.array([hit[0] for hit in hits])
    same = body == image.body[::PIXEL_STRIDE, ::PIXEL_STRIDE].ravel()
    error = np.abs(cast - image.depth[::PIXEL_STRIDE, ::PIXEL_STRIDE].ravel())[same & (body >= 0)]
    assert same.mean() > 0.99
    assert np.percentile(error, 95) < AGREES_M


def test_equal_scenes_give_equal_pictures() -> None:
    first, second = picture(SCENE), picture(SCENE)
    assert first.rgb.tobytes() == second.rgb.tobytes()
    assert first.depth.tobytes() == second.depth.tobytes()


def test_a_thing_shows_its_paint_darkened_by_shading() -> None:
    image = picture([TABLE, ("soda", (1.0, 0.0, 0.68, 0.0), GREEN)])
    green = camera.exposed(image.rgb, camera.RENDERER_GAIN)[..., 1][image.body == 2]
    assert green.mean() / GREEN[2] == pytest.approx(camera.RENDERER_GAIN, abs=0.05)


def test_exposure_scales_values_to_the_asked_gain() -> None:
    rgb = np.full((1, 1, 3), 100, dtype=np.uint8)
    half = camera.exposed(rgb, camera.RENDERER_GAIN / 2.0)
    assert half == pytest.approx(np.full((1, 1, 3), 50.0 / 255.0))
    assert camera.exposed(rgb, 10.0).max() == 1.0
