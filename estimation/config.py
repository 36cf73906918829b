"""What the estimator assumes beyond the noise model it is given, each number with its unit and reason."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class EstimatorConfig:
    """Assumptions of the estimator.

    Attributes:
        listed: Existence from which an anchor is listed: what is less likely is not worth a look.
        likely: Existence from which an anchor takes room, carries things and explains what a picture shows.
        met: How often an object was seen or picked, so that it must be elsewhere if it is gone: once may be an error.
        most_sure: Existence of an object the robot is told of, and the most it believes of any: someone may have taken
            it. From here two to three misses in plain view unlist it, where the picture shows nothing in its place.
        retired: Existence below which an anchor is no longer matched with detections.
        gate: Squared Mahalanobis distance beyond which a detection is of something else: chi-square, 3 degrees, .999.
        sure_gate: The same for a table that would stand in a known one and so must be known: 3 degrees, 1 - 1e-9.
            Beyond the other gate, the base most likely stands elsewhere than believed, and this look is what tells.
        new_per_look: Expected number of real objects per look of which the robot had no anchor.
        new_tables_per_look: The same for tables: rooms have few.
        view_area_m2: Floor area over which false detections and unknown objects are spread.
        seen_share: Share of an object's outline that must be in sight for the detector to report it.
        depth_margin_m: Something nearer than an object's front by more than this hides it; camera and fit errors.
        sight_m: Distance from the camera beyond which objects are not detected.
        sought_sd_m: Sd of a place, largest axis, from which silence moves it to where the look did not reach.
        place_step_m: Distance between the places that are then weighed against one another: about a thing's width.
        look_width_m: A look at a place shows what is so far beside it: a third of the picture at a metre's distance.
        unshown: P(silence | an object is in sight and the picture shows nothing solid in its place), next to that of
            silence about one that it shows: edges of depth images, errors of the camera's calibration.
        voxel_m: Edge of the voxels in which regions are searched: about half of the thinnest thing that is looked for.
        voxel_margin_m: A reading this much before the centre of a voxel still shows it empty; the depth's error.
        hit_margin_m: A reading nearer than this to a support or to an object that is believed to be there has hit that,
            and not something unknown; voxels and the edges of objects.
        hit_sds: Added to it, times the sd that the camera's calibration error gives a place.
        arm_m: A reading this near the axis of an arm has hit the arm, or what is in its hand.
        least_hits: Fewer readings in a region than this are errors at edges.
        refuted: How many times likelier a detection is of nothing than of an object if the picture shows what is behind
            its place; otherwise it may just not show that.
        coincidence: Share of detections of nothing at whose place the picture shows something solid all the same: as
            much of a top as things cover.
        other_solid: P(something that nothing explains stands where an object is believed to be | it does not exist).
        other_solids: Expected number of solids above a support that are of no type that is looked for: what was hit in
            a region is one of them, or one of the objects that were told to be expected there.
        unseen_points: Most points by which a snapshot tells the unseen part of a region.
        typical_range_m: Horizontal distance from which the robot looks at what it examines.
        typical_drop_m: How far below the camera things stand: a head at 1.4 m, a table at 0.7 m.
        fit_sd_m: Of a detection's place beside the camera's error.
        fit_sd_rad: Of the heading of a box beside the camera's error.
        table_sd_m: Of a table's place beside the camera's error.
        table_sd_rad: The same for its heading.
        unknown_heading_sd_rad: Of the heading of a cylinder, uniform over the circle: pi / sqrt(3).
        height_sd_m: Of where the base of a resting object is, given its support.
        height_tolerance_m: Height above a support's top up to which an object can be resting on it.
        capture_sd_m: Where an object can be between the fingers that hold it, each axis: uniform over 3.5 cm each way.
        capture_sd_rad: The same for its heading.
        pushed_sd_m: How far a failed pick may push the object, each axis.
        pushed_sd_rad: How far a failed pick may turn it.
        dropped_sd_m: How far an object may lie from where a failed place released it, each axis.
        lost_sd_m: How far what is no longer in a hand may be from where the hand was found empty, each axis: it fell on
            the way, or somebody took it and put it down nearby.
        lost_sd_z_m: The same for its height: from the floor to a table.
        lost_rests: P(it stands on a support that is known, rather than on the floor or where nobody looks).
        touched_sd_m: How far the base may stand from where it was believed to when an arm touched something, each axis.
        touched_sd_rad: The same for its heading.
        bulky_kg: Median weight of what cannot be lifted, tables above all, if nothing is told of it.
        bulky_sigma: Sd of the logarithm of that.
        pick_fails: P(a pick closes on nothing | the object exists).
        pick_deceives: P(a pick closes on something | the object does not exist).
        closed_gap_m: Gap between the fingers below which they hold nothing.
        hypotheses: How many are kept when the detections of a look are assigned jointly; 0: pairs are judged alone.
        place_gate: The same for a place alone: chi-square, 2 degrees, .99.
        merge_doubt: Probability of standing apart below which two anchors that overlap are of one object.
        same_sd_m: How far apart the places of two anchors can be that are of one object, each axis.
        consolidate_after: Drives and looks after which the past is summed up; runs of the usual length never are.
        coupled: Variables that one factor may couple when it is; beyond, matrices grow too large to work with often.
        least_sd: Floor of every sd that enters the graph, metres or radians: keeps the information matrix well
            conditioned; a tenth of a millimetre is below what any sensor resolves.
    """

    listed: float = 0.05
    likely: float = 0.5
    met: int = 2
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
    least_sd: float = 1e-4
