from ._cubic_barriers import CubicBarriers as CubicBarriers
from ._drag import Drag as Drag
from ._friction import Friction as Friction
from ._harvest import Harvest as Harvest
from ._impact_pair import ImpactPair as ImpactPair
from ._parallel import Parallel as Parallel
from ._register import names as names
from ._register import parameters as parameters
