"""Answers of the geometry that a run recorded are those of its replay."""

import pytest
from kit.minds import TableGeometry

from skolem.tools.loop.recorded_geometry import RecordedGeometry
from skolem.tools.loop.stopwatch import Stopwatch
from skolem.tools.recorded.geometry import RecalledGeometry
from skolem.traces.errors import NotRecordedError
from skolem.traces.messages import Activity, Geometry, Message

PICK = Activity("pick", "it", "right")


def test_how_many_stances_were_tried_in_vain_is_recorded_with_the_drive_and_recalled() -> None:
    written: list[Message] = []
    table = TableGeometry()
    table.impossible, table.spent = {str(PICK)}, {str(PICK): 12}
    recorded = RecordedGeometry(table, lambda _, message: written.append(message), Stopwatch())
    assert recorded.approach(PICK) is None
    assert recorded.tried(PICK) == 12
    recalled = RecalledGeometry()
    recalled.take(message for message in written if isinstance(message, Geometry))
    assert recalled.approach(PICK) is None
    assert recalled.tried(PICK) == 12
    assert len(written) == 1


def test_an_older_trace_tells_of_no_budget_and_an_unasked_drive_of_nothing() -> None:
    recalled = RecalledGeometry()
    recalled.take([Geometry.model_validate({"step": 0, "query": f"approach {PICK}", "belief_version": 0})])
    assert recalled.tried(PICK) == 0
    with pytest.raises(NotRecordedError, match="approach pick"):
        recalled.tried(Activity("pick", "other", "right"))


def test_room_is_supposed_only_where_that_is_asked_for_and_nothing_is_recorded() -> None:
    place = Activity("place", "it", "right", "table1")
    recalled = RecalledGeometry(suppose_room=True)
    assert recalled.blockers(place) == ()
    recalled.take([Geometry(step=0, query=f"blockers {place}", belief_version=0, blockers=("front",))])
    assert recalled.blockers(place) == ("front",)
    with pytest.raises(NotRecordedError, match="blockers place"):
        RecalledGeometry().blockers(place)
