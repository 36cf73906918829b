from itertools import permutations

import pytest
from pydantic import ValidationError

from skolem.estimation.events import EVENT, Looked, Missed, Moved, Picked, Sighting, canonical_order
from skolem.traces.messages import Detection

VARIANCE = (1e-4, 0.0, 0.0, 1e-4, 0.0, 3.24)


def detection(x: float, red: float = 0.5, points: int = 90) -> Detection:
    return Detection(
        base_T_object=(x, 0.0, 0.7, 0.0),
        covariance=VARIANCE,
        type_log_likelihood={"soda": -1.0, "carton": -9.0},
        rgb=(red, 0.1, 0.1),
        points=points,
    )


def test_events_survive_their_json_form() -> None:
    sighting = Sighting(
        anchor="_o1_",
        new=True,
        support="table1",
        camera_T_object=(1.0, 0.1, 0.2),
        covariance=VARIANCE,
        z=0.7,
        z_sd_m=0.01,
        odds=1.0,
        detection=detection(1.0),
    )
    log = [
        Moved(start_T_end=(0.1, 0.2, 1 / 3), sd_m=0.01, sd_rad=0.02),
        Looked(
            camera_covariance=VARIANCE,
            sightings=(sighting,),
            missed=(Missed(anchor="can1", p_reported=0.9),),
        ),
        Picked(hand="left", anchor="can1", base_T_tool=(0.6, 0.1, 0.8, 0.0), tool_T_object=(0.0, 0.0, -0.05, 0.0)),
    ]
    assert [EVENT.validate_json(event.canonical()) for event in log] == log


def test_unknown_kind_of_event_is_refused() -> None:
    with pytest.raises(ValidationError, match="kind"):
        EVENT.validate_json('{"kind": "teleported"}')


def test_detections_have_one_order_whichever_the_sensor_chose() -> None:
    detections = [detection(0.5), detection(0.4), detection(0.4, red=0.6), detection(0.4, points=80)]
    orders = [canonical_order(order) for order in permutations(detections)]
    assert all(order == orders[0] for order in orders)
    assert [d.points for d in orders[0]] == [80, 90, 90, 90]
