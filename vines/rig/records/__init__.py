"""What is kept of a run: rows of tables, its log, its reconstruction."""

from vines.rig.records._comparison_rows import comparison_rows, cycle_rows, row_id
from vines.rig.records._keep import load_reconstruction, save_reconstruction
from vines.rig.records._log import LOG_RATE, write_log
from vines.rig.records._reconstruction_rows import budget_rows, failed_row, impact_columns, reconstruction_row
from vines.rig.records._split import Piece, split_run
from vines.rig.records._tables import channel_rows, refused_row, run_row

__all__ = [
    "LOG_RATE",
    "Piece",
    "budget_rows",
    "channel_rows",
    "comparison_rows",
    "cycle_rows",
    "failed_row",
    "impact_columns",
    "load_reconstruction",
    "reconstruction_row",
    "refused_row",
    "row_id",
    "run_row",
    "save_reconstruction",
    "split_run",
    "write_log",
]
