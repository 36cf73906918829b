"""Assumptions of the estimator beyond the noise model of the prior, each with its unit and reason."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class EstimatorConfig:
    """Assumptions of the estimator.

    Attributes:
        listed: Least P(exists) of a listed anchor. A less likely object is not worth a look.
        likely: Least P(exists) of an anchor that takes room, supports objects and explains depth readings.
        sure: Least P(an object exists), at any time before, with which it must be elsewhere if it is gone.
        most_sure: P(exists) of an object of the prior, and the greatest P(exists) of any object, as someone may have
            taken it. From here, two to three missed detections in plain view unlist an anchor if the picture shows
            nothing in its place.
        retired: Least P(exists) of an anchor that is matched with detections.
        gate: Greatest squared Mahalanobis distance of a detection from its anchor: chi-square, 3 degrees, .999.
        sure_gate: The same for a detected table that overlaps a known one and so must be it: 3 degrees, 1 - 1e-9. At a
            distance between the two gates, the base most likely stands elsewhere than believed, and the look tells so.
        new_per_look: Expected number per look of real objects without an anchor.
        new_tables_per_look: The same for tables; a room has few.
        view_area_m2: Floor area over which false detections and unknown objects are spread.
        seen_share: Least share of an object's outline that is in sight if the object can be detected.
        depth_margin_m: Least distance in front of an object at which another one hides it: errors of camera and fit.
        sight_m: Greatest distance from the camera at which objects are detected.
        sought_sd_m: Sd of a place, along its largest axis, from which a missed detection moves the place out of sight.
        place_step_m: Distance between the weighted places of such an object: about an object's width.
        look_width_m: Width around a place that a look shows: a third of the picture at a distance of one metre.
        unshown: P(missed detection | an object is in sight and the picture shows nothing solid in its place), relative
            to that of an object that the picture shows: edges of depth images, errors of the camera's calibration.
        voxel_m: Edge of the voxels of regions: about half of the thinnest object that is searched for.
        voxel_margin_m: Greatest distance at which a reading may end before the centre of an empty voxel: depth's error.
        hit_margin_m: Greatest distance of a reading from the support or believed object that it has hit: errors of
            voxels and of the edges of objects.
        hit_sds: Number of sds that are added to it; the sd is that of a place by the camera's calibration error.
        arm_m: Greatest distance from an arm's axis of a reading that has hit the arm or the object in its hand.
        least_hits: Least number of readings that count in a region; fewer are errors at edges.
        refuted: Factor on the expected number of false detections at a place if the picture shows the space behind it.
        coincidence: Share of false detections at whose place the picture shows something solid: about the share of a
            top that objects cover.
        other_solid: P(an unexplained solid stands in the place of an object | the object does not exist).
        other_solids: Expected number of solids above a support that are of no type that the detector reports. An
            unexplained solid in a region is one of them, or one of the objects that the prior expects there.
        unseen_points: Greatest number of points for the unseen part of a region in a snapshot.
        typical_range_m: Horizontal distance of the camera from an object that the robot examines.
        typical_drop_m: Height of the camera above objects: a head at 1.4 m, a table at 0.7 m.
        fit_sd_m: Sd of a detection's place, without the camera's error.
        fit_sd_rad: Sd of the heading of a box, without the camera's error.
        table_sd_m: Sd of a table's place, without the camera's error.
        table_sd_rad: The same for its heading.
        unknown_heading_sd_rad: Sd of the heading of a cylinder, uniform over the circle: pi / sqrt(3).
        height_sd_m: Sd of the height of a resting object's base, given its support.
        height_tolerance_m: Greatest distance in height between a support's top and the base of an object on it.
        capture_sd_m: Sd of a held object's place between the fingers, each axis: uniform over 3.5 cm each way.
        capture_sd_rad: The same for its heading.
        pushed_sd_m: Sd of an object's motion by a failed pick, each axis.
        pushed_sd_rad: Sd of its turn by a failed pick.
        dropped_sd_m: Sd of an object's place around the point at which a failed place released it, each axis.
        lost_sd_m: Sd of a lost object's place around the hand that was found empty, each axis: the object fell on the
            way, or somebody took it and put it down nearby.
        lost_sd_z_m: The same for its height: from the floor to a table.
        lost_rests: P(a lost object stands on a known support, and not on the floor or out of all sight).
        touched_sd_m: Sd of the base around its believed place after an arm touched something, each axis.
        touched_sd_rad: The same for its heading.
        bulky_kg: Median weight of an object that cannot be lifted, such as a table, if the prior states none.
        bulky_sigma: Sd of the logarithm of that weight.
        pick_fails: P(a pick closes on nothing | the object exists).
        pick_deceives: P(a pick closes on something | the object does not exist).
        closed_gap_m: Gap between the fingers below which they hold nothing.
        hypotheses: Number of hypotheses kept when the detections of a look are assigned jointly; 0: each pair is scored
            alone.
        place_gate: As `gate`, for a place without heading: chi-square, 2 degrees, .99.
        merge_doubt: P(two anchors stand apart) below which they are of one object.
        same_sd_m: Sd of the distance between the places of two anchors of one object, each axis.
        consolidate_after: Number of drives and looks after which the past is summed up; usual runs are shorter.
        coupled: Greatest number of variables that one factor of the sum couples; larger matrices take too long.
        remembers: Whether the past is summed up without the poses from which objects were first picked. A goal that
            speaks of the start asks for them.
        least_sd: Floor of every sd in the graph, metres or radians. It keeps the information matrix well conditioned.
            No sensor resolves a tenth of a millimetre.
    """

    listed: float = 0.05
    likely: float = 0.5
    sure: float = 0.9
    most_sure: float = 0.99
    retired: float = 1e-3
    gate: float = 16.266
    sure_gate: float = 44.8
    new_per_look: float = 0.05
    new_tables_per_look: float = 1e-3
    view_area_m2: float = 1.0
    seen_share: float = 0.75
    depth_margin_m: float = 0.03
    sight_m: float = 2.4
    sought_sd_m: float = 0.15
    place_step_m: float = 0.08
    look_width_m: float = 0.2
    unshown: float = 0.1
    voxel_m: float = 0.03
    voxel_margin_m: float = 0.01
    hit_margin_m: float = 0.03
    hit_sds: float = 2.5
    arm_m: float = 0.2
    least_hits: int = 4
    refuted: float = 100.0
    coincidence: float = 0.05
    other_solid: float = 0.1
    other_solids: float = 0.05
    unseen_points: int = 64
    typical_range_m: float = 1.0
    typical_drop_m: float = 0.7
    fit_sd_m: float = 0.002
    fit_sd_rad: float = 0.05
    table_sd_m: float = 0.01
    table_sd_rad: float = 0.01
    unknown_heading_sd_rad: float = 1.8138
    height_sd_m: float = 0.003
    height_tolerance_m: float = 0.03
    capture_sd_m: float = 0.02
    capture_sd_rad: float = 0.2
    pushed_sd_m: float = 0.03
    pushed_sd_rad: float = 0.3
    dropped_sd_m: float = 0.05
    lost_sd_m: float = 1.0
    lost_sd_z_m: float = 0.35
    lost_rests: float = 0.5
    touched_sd_m: float = 0.02
    touched_sd_rad: float = 0.02
    bulky_kg: float = 20.0
    bulky_sigma: float = 0.6
    pick_fails: float = 0.1
    pick_deceives: float = 0.01
    closed_gap_m: float = 0.005
    hypotheses: int = 20
    place_gate: float = 9.210
    merge_doubt: float = 0.01
    same_sd_m: float = 1e-3
    consolidate_after: int = 100
    coupled: int = 30
    remembers: bool = False
    least_sd: float = 1e-4
