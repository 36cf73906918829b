"""Room on a table for an object that may be in no hand yet, and the movable objects that take it."""

import numpy as np

from skolem.sim.planner import arm_motions
from skolem.sim.planner.arm_motions import Spots
from skolem.sim.planner.believed import BelievedWorld
from skolem.sim.planner.candidates import Candidates
from skolem.sim.planner.standing import Standing
from skolem.sim.space import grasps, room
from skolem.sim.space.room import Room
from skolem.traces.messages import HANDS, Activity, ObjectType, Pose2


class MakingRoom:
    """Finds room in the believed world, with objects of plain size at their mean poses."""

    def __init__(self, world: BelievedWorld, candidates: Candidates) -> None:
        """Keep the world and the source of base poses."""
        self._world = world
        self._candidates = candidates

    def room(self, activity: Activity, here: Pose2) -> Room | None:
        """Return the spot of a place with the fewest objects to take away; None if none is within reach."""
        table, kind = self._world.standing.get(activity.support or ""), self._type(activity.anchor)
        if table is None or kind is None or table.type.shape != "table":
            return None
        with self._world.narrowed():
            found = self._rooms(activity, self._world.standing[table.anchor], kind)
            first = next((each for each in found[:1] if self._has_stance(activity, table, kind, [each], here)), None)
            if first is not None or not self._has_stance(activity, table, kind, found, here):
                return first
            return next((each for each in found[1:] if self._has_stance(activity, table, kind, [each], here)), None)

    def beside(self, activity: Activity, spots: Spots, thing: ObjectType, here: Pose2) -> Spots:
        """Return the spots for a thing, on the support of a later place, that leave the room for that place."""
        kept, wanted = self.room(activity, here), self._type(activity.anchor)
        if kept is None or wanted is None:
            return spots
        keep = room.leaves_room(spots.places, thing, kept.spot, wanted)
        return Spots(spots.places[keep], spots.room[keep])

    def _type(self, anchor: str) -> ObjectType | None:
        carried = [item.type for item in self._world.carried.values() if item.anchor == anchor]
        standing = self._world.standing.get(anchor)
        return carried[0] if carried else None if standing is None else standing.type

    def _rooms(self, activity: Activity, table: Standing, kind: ObjectType) -> list[Room]:
        others = arm_motions.on_table(self._world, table)
        others.pop(activity.anchor, None)
        movable = {anchor: disc for anchor, disc in others.items() if self._world.standing[anchor].type.graspable}
        fixed = {anchor: disc for anchor, disc in others.items() if anchor not in movable}
        return room.rooms(table.type, kind, fixed, movable)

    def _has_stance(
        self, activity: Activity, table: Standing, kind: ObjectType, found: list[Room], here: Pose2
    ) -> bool:
        """Return whether a base can stand where an arm may reach one of some spots."""
        if not found:
            return False  # `around_spots` needs a spot
        places = np.array([each.spot for each in found])
        spots, below = Spots(places, np.full(len(places), grasps.ENOUGH_M)), grasps.tool_height(kind)
        hands = HANDS if activity.hand is None else (activity.hand,)
        around = (self._candidates.around_spots(table, hand, kind, below, spots, here)[0] for hand in hands)
        return any(len(stances.target) for stances in around)
