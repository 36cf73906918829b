"""A detector of one's own: what it reports of three pictures is taken into the belief."""

from skolem.estimation import Belief
from skolem.reasoner import load_rules
from skolem.traces import messages as m


def detect(picture):
    """Yield a detection for each object of a picture: a list of x, y, rgb and log likelihood of a soda, for once."""
    at = {"covariance": (1e-4, 0.0, 0.0, 1e-4, 0.0, 3.0), "points": 200}  # x, y, theta (m, rad): the upper triangle
    for x, y, rgb, soda in picture:
        yield m.Detection(base_T_object=(x, y, 0.68, 0), rgb=rgb, type_log_likelihood={"soda": soda, "can": -3.0}, **at)


words = load_rules().vocabulary
arms = m.RobotState(right_arm=(0,) * 7, left_arm=(0,) * 7)
desk = m.PriorObject(anchor="desk", type={"table": 1}, world_T_object=(1, 0, 0, 0), sd_xy_m=0.02, sd_theta_rad=0.02)
base = {"world_T_base": (0, 0, 0), "base_sd_xy_m": 0.01, "base_sd_theta_rad": 0.01, "robot": arms}
rest = {"colour": m.HsvBelief(mean=(0.5, 0.5, 0.5), variance=(0.1, 0.1, 0.1)), "log_weight": (-1.2, 0.36)}
belief = Belief(m.Prior(objects=(desk,), types=dict(words.types), noise=m.NoiseModel(), **base, **rest))
for step in range(3):
    look = m.Action(step=step, op="look", args=("desk",), command=m.LookAt(pan=0, tilt=0.5))
    seen = tuple(detect([(0.8, 0.1, (0.1, 0.6, 0.1), -0.1), (0.8, -0.2, (0.6, 0.1, 0.1), -2.0)]))
    result = m.ActionResult(step=step, status="done", robot=arms)
    belief.update(look, result, m.Observation(step=step, kind="look", detections=seen))
for name in belief.anchors():
    chances = [f"P({word}) = {belief.prob_property(name, words.meanings[word]):.2f}" for word in ("soda", "green")]
    print(name, f"P(exists) = {belief.prob_exists(name):.2f}", *chances)
