"""The layout of a recorded run in the viewer, with all views at once."""

import rerun.blueprint as rrb

from skolem.traces.scene.camera import DEPTH, PICTURE
from skolem.traces.scene.eye import Eye
from skolem.traces.scene.rows import SIM_TIME

_WORLD = (
    "/robot/**",
    "- /robot/pr2/collision_geometries/**",
    "/truth/**",
    "/belief/**",
    "/regions/**",
    "/detections/**",
)


def blueprint(pictures: bool, eye: Eye | None, entropy: tuple[float, float] | None = None) -> rrb.Blueprint:
    """Return the layout.

    Args:
        pictures: Whether the camera view shows pictures; otherwise the coarse depth.
        eye: The first eye of the 3D view; None: the viewer's default.
        entropy: Lower and upper end of the axis of entropy [nats]; None: the range of the curves.
    """
    camera = PICTURE if pictures else DEPTH
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Vertical(
                rrb.Spatial3DView(
                    name="World: true things solid, believed ones outlined",
                    origin="/",
                    contents=_WORLD,
                    eye_controls=None if eye is None else rrb.EyeControls3D(position=eye.at, look_target=eye.target),
                    background=(24, 26, 30),
                ),
                rrb.Horizontal(
                    rrb.Spatial2DView(name="Camera and detections", origin=f"/{camera}"),
                    rrb.TimeSeriesView(
                        name="P(it is what is meant)",
                        origin="/plots/den",
                        axis_y=rrb.ScalarAxis(range=(-0.08, 1.05)),
                        plot_legend=rrb.Corner2D.LeftTop,
                    ),
                    column_shares=[4, 5],
                ),
                row_shares=[13, 7],
            ),
            rrb.Vertical(
                rrb.GraphView(name="Plan stack", origin="/plan"),
                rrb.TimeSeriesView(
                    name="Entropy per object since the start [nats]",
                    origin="/plots/entropy",
                    axis_y=None if entropy is None else rrb.ScalarAxis(range=entropy),
                    plot_legend=rrb.Corner2D.LeftBottom,
                ),
                rrb.TextLogView(
                    name="Decisions",
                    origin="/log",
                    columns=rrb.TextLogColumns(text_log_columns=["LogLevel", "Body"]),
                ),
                row_shares=[10, 5, 5],
            ),
            column_shares=[11, 9],
        ),
        rrb.TimePanel(state="collapsed", timeline=SIM_TIME),
        rrb.SelectionPanel(state="hidden"),
        rrb.BlueprintPanel(state="hidden"),
        auto_views=False,
    )
