from .belief import Belief as Belief
from .config import EstimatorConfig as EstimatorConfig
