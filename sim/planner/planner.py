"""The reasoner's geometry, answered by planning motions in the believed world.

An answer is a function of (belief, question, run seed): the believed world is built from the belief alone, candidates
are tried in a fixed order, and every path's seed comes from the run's seed, the belief's version and its stream.
Answers are kept until the belief changes. If an activity is impossible with objects widened by their doubt, it is tried
again with objects of plain size at their mean poses, since the alternative would be to give up.
"""

import contextlib
from collections.abc import Callable, Iterator, Mapping

import numpy as np

from skolem.sim.planner import arm_motions, motion, ways
from skolem.sim.planner.arm_motions import ArmPlanner, Spots
from skolem.sim.planner.believed import BelievedWorld
from skolem.sim.planner.candidates import Candidates
from skolem.sim.planner.clearing import Clearing
from skolem.sim.planner.driving import drive
from skolem.sim.planner.making_room import MakingRoom
from skolem.sim.planner.surveyor import Surveyor
from skolem.sim.planner.trials import Task, Trials
from skolem.sim.planner.ways import Way
from skolem.sim.robot.assets import robot_sha256
from skolem.sim.space.activities import Question, key_of
from skolem.sim.space.room import Room
from skolem.traces.messages import HANDS, Activity, Belief, Command, Hand, MoveBase, ObjectType, Pose2
from skolem.traces.messages.poses import compose2, compose4

BASE_STREAM = 3
SURVEYS_DRIVEN = 8  # stances for a look at a region to which a drive is sought
WAYS_TRIED = 3  # ways that are tried without their blockers
NARROWED = ("look", "pick", "place")
CLEARABLE = ("look", "look_region", "pick")


class PlanningWorld:
    """Answers whether an activity can be done from here, from where it can be done, and which objects block it.

    Attributes:
        robot_sha256: Identity of the robot model.
    """

    def __init__(self, types: Mapping[str, ObjectType], seed: int) -> None:
        """Open a physics client of its own.

        Args:
            types: Shape and size of every type a belief may name.
            seed: The run's seed.
        """
        self.robot_sha256 = robot_sha256()
        self._seed = seed
        self._belief: Belief | None = None
        self._world = BelievedWorld(types)
        arms = ArmPlanner(self._world, lambda stream, attempt: self._path_seed(stream, attempt))
        candidates = Candidates(self._world)
        self._trials = Trials(self._world, arms, candidates)
        self._surveyor = Surveyor(self._world, candidates)
        self._clearing = Clearing(self._world, arms, candidates, self._trials, self._surveyor)
        self._answers: dict[Question, Command | None] = {}
        self._tried: dict[Question, int] = {}  # stances at which motions were planned in vain
        self._ways: dict[Question, Way | None] = {}
        self._making_room = MakingRoom(self._world, candidates)
        self._rooms: dict[Question, Room | None] = {}

    def close(self) -> None:
        """Close the physics client; later questions fail."""
        self._world.close()

    def sync(self, belief: Belief) -> None:
        """Take over a belief; if it equals the last one, answers are kept."""
        if belief != self._belief:
            self._belief = belief
            self._answers, self._tried, self._ways, self._rooms = {}, {}, {}, {}
            self._world.update(belief)
            self._surveyor.update(belief)

    def ready(self, activity: Activity) -> Command | None:
        """Return the command that does the activity from the believed pose of the robot, or None."""
        if activity.kind == "look":
            look = self._kept("ready", activity, self._ready) or self._doubtful_look(activity)
            return None if activity.elsewhere and self.approach(activity) is not None else look
        return self._kept("ready", activity, self._ready) or self._kept("ready", activity, self._ready, narrow=True)

    def approach(self, activity: Activity) -> MoveBase | None:
        """Return a drive to where the activity can be done and its object or spot can be seen, or None."""
        answer = self._kept("approach", activity, self._approach)
        answer = answer or self._kept("approach", activity, self._approach, narrow=True)
        assert answer is None or isinstance(answer, MoveBase)
        return answer

    def tried(self, activity: Activity) -> int:
        """Return the number of stances at which arms or drives were planned in vain; 0 if `approach` has an answer.

        A stance that the base's outline, the reach of the arm or the camera rules out is not counted: that is shown.
        """
        if self.approach(activity) is not None:
            return 0
        searches = ("approach", "approach narrow")
        return sum(self._tried.get(self._key(search, activity), 0) for search in searches)

    def blockers(self, activity: Activity) -> tuple[str, ...] | None:
        """Return all movable objects that block one way of doing the activity, sorted.

        The result is empty if the activity can be done, and if it is impossible even without them. The hand counts as
        empty. For a place, whose object need not be in a hand, only the room for it and the reach of an arm count;
        None if there is none even without movable objects.
        """
        if activity.kind == "place":
            room = self._room(activity)
            return None if room is None else room.blockers
        if activity.kind not in CLEARABLE:
            return ()
        with self._world.emptied(activity.hand):
            if self.ready(activity) is not None or self.approach(activity) is not None:
                return ()
            way = self._kept_way("cleared", activity, self._cleared)
        return () if way is None else way.blockers

    # ---------------------------------------------------------------- memory and doubt

    def _doubtful_look(self, activity: Activity) -> Command | None:
        """Return the look that shows the object at its mean pose; None if another stance is surer.

        No stance counts as surer if the object can be picked from here, but from nowhere with widened objects.
        """
        look = self._kept("ready", activity, self._ready, narrow=True)
        if look is None or self._kept("approach", activity, self._approach) is None:
            return look
        return look if any(self._is_grasped_in_doubt(activity.anchor, hand) for hand in HANDS) else None

    def _is_grasped_in_doubt(self, anchor: str, hand: Hand) -> bool:
        """Return whether an object can be picked from here, but from nowhere with objects widened by their doubt."""
        pick = Activity("pick", anchor, hand)
        return self.ready(pick) is not None and self._kept("approach", pick, self._approach) is None

    def _kept(
        self, question: str, activity: Activity, answer: Callable[[Task | None], Command | None], narrow: bool = False
    ) -> Command | None:
        """Return a kept answer, computed on first use; objects are widened by their doubt unless `narrow`."""
        if narrow and activity.kind not in NARROWED:
            return None
        key = self._key(f"{question} narrow" if narrow else question, activity)
        if key not in self._answers:
            later = activity.clear_of
            clear_of = None if later is None or later.kind == "place" else self._way_to_keep(later)
            self._world.reset()
            with self._world.supposing(activity.anchor), self._world.narrowed() if narrow else contextlib.nullcontext():
                task = self._task(activity, clear_of)
                self._answers[key] = answer(task)
                self._tried[key] = 0 if task is None else len(task.in_vain)
        return self._answers[key]

    def _kept_way(self, question: str, activity: Activity, answer: Callable[[Activity], Way | None]) -> Way | None:
        key = self._key(question, activity)
        if key not in self._ways:
            with self._world.supposing(activity.anchor):
                self._ways[key] = answer(activity)
        return self._ways[key]

    def _room(self, activity: Activity) -> Room | None:
        """Return the kept room for a place."""
        key = self._key("room", activity)
        if key not in self._rooms:
            self._world.reset()
            self._rooms[key] = self._making_room.room(activity, self._believed.world_T_base)
        return self._rooms[key]

    def _key(self, question: str, activity: Activity) -> Question:
        """Return the key of an answer; it has the full hands, since a hand may be taken for empty."""
        full = (hand for hand in HANDS if hand in self._world.carried)
        return (question, *key_of(activity), *full)

    @property
    def _believed(self) -> Belief:
        assert self._belief is not None, "sync comes first"
        return self._belief

    def _path_seed(self, *stream: int) -> int:
        return motion.seed_of(self._seed, self._believed.version, *stream)

    # ---------------------------------------------------------------- from here, and from elsewhere

    def _task(self, activity: Activity, clear_of: Way | None) -> Task | None:
        """Return the activity with the spots that it may use; None if it is impossible with the present hands."""
        if activity.kind == "look_region":
            return Task(activity) if activity.anchor in self._believed.regions else None
        if not self._trials.possible(activity):
            return None
        if activity.kind != "place":
            return Task(activity)
        assert activity.hand is not None
        assert activity.support is not None
        carried, table = self._world.carried[activity.hand], self._world.standing[activity.support]
        spots = arm_motions.free_spots(self._world, table, carried)
        if activity.clear_of is not None and activity.clear_of.kind == "place":
            if activity.clear_of.support == activity.support:
                spots = self._making_room.beside(activity.clear_of, spots, carried.type, self._believed.world_T_base)
            return Task(activity, spots)
        if clear_of is None:
            return Task(activity, spots)
        top = table.type.size_m[2]
        places = [compose4(table.world_T_object, (float(x), float(y), top, 0.0))[:3] for x, y in spots.places]
        keep = ways.leaves_room(self._world, clear_of, carried, np.reshape(np.array(places), (-1, 3)))
        return Task(activity, Spots(spots.places[keep], spots.room[keep]))

    def _ready(self, task: Task | None) -> Command | None:
        if task is None:
            return None
        if task.activity.kind == "look_region":
            return self._surveyor.look(task.activity.anchor)
        return self._trials.here(task)

    def _approach(self, task: Task | None) -> MoveBase | None:
        """Return the drive to the first stance that serves and can be reached; None if there is none."""
        if task is None:
            return None
        if task.activity.kind == "weigh":
            return MoveBase(start_T_waypoint=((0.0, 0.0, 0.0),))
        for drives, stance in enumerate(self._serving(task)):
            path = drive(self._world, self._believed.world_T_base, stance, self._path_seed(BASE_STREAM, drives))
            if path is not None:
                return MoveBase(start_T_waypoint=path)
            task.in_vain.append(stance)
        return None

    def _serving(self, task: Task) -> Iterator[Pose2]:
        if task.activity.kind == "look_region":
            return (stance for stance, _ in self._surveyor.stances(task.activity.anchor)[:SURVEYS_DRIVEN])
        return self._trials.serving(task, self._believed)

    # ---------------------------------------------------------------- ways

    def _cleared(self, activity: Activity) -> Way | None:
        """Return the way with the fewest blockers without which the activity can be done; None if there is none."""
        self._world.reset()
        if self._task(activity, None) is None:
            return None
        with self._world.narrowed() if activity.kind in NARROWED else contextlib.nullcontext():
            for way in self._clearing.ways(activity, self._believed)[:WAYS_TRIED]:
                with self._world.removed(way.blockers):
                    if self._approach(self._task(activity, None)) is not None:
                        return way
        return None

    def _way_to_keep(self, activity: Activity) -> Way | None:
        """Return the way of an activity that will be done later, once the held object is put down."""
        with self._world.emptied(activity.hand):
            return self._kept_way("kept", activity, self._free_or_cleared)

    def _free_or_cleared(self, activity: Activity) -> Way | None:
        here: Pose2 = self._believed.world_T_base
        if self.ready(activity) is None:
            move = self.approach(activity)
            if move is None:
                return self._kept_way("cleared", activity, self._cleared)
            here = compose2(here, move.start_T_waypoint[-1])
        way = self._clearing.way_from(activity, here)
        if way is None:
            with self._world.narrowed():
                way = self._clearing.way_from(activity, here)
        return way
