from .attractors import Attractor as Attractor
from .attractors import classify_many as classify_many
from .attractors import settle as settle
from .dynamics import Ensemble as Ensemble
from .dynamics import Scatter as Scatter
from .dynamics import Trajectory as Trajectory
from .dynamics import ball_locked as ball_locked
from .dynamics import ensemble as ensemble
from .dynamics import no_ball as no_ball
from .dynamics import simulate as simulate
from .errors import OrbitNotFound as OrbitNotFound
from .errors import VinesError as VinesError
from .model import Params as Params
from .model import PhysicalParams as PhysicalParams
from .model import Word as Word
from .orbits import Branch as Branch
from .orbits import Orbit as Orbit
from .orbits import all_orbits as all_orbits
from .orbits import continue_orbit as continue_orbit
from .orbits import find_orbit as find_orbit
from .orbits import switch_branch as switch_branch
from .stages import Study as Study
from .stages import query as query
from .stages import run as run
from .stages import study as study
from .stages import table as table

__version__: str
