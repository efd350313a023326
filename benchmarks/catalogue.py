"""The catalogue's speed: a cold query, a narrow range on 10^7 rows, verify; the peers in the same run.

``python -m benchmarks.catalogue [rows]`` prints one line a measure with a ratio; medians of seven.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import duckdb
import numpy as np
import pyarrow as pa
import pyarrow.dataset as ds
import pyarrow.parquet as pq

from vines import schema
from vines.catalogue import connect
from vines.store import Store, TableFile, describe_table

TIMES = 7
NARROW = "A between 0.0200 and 0.0201"


def median(call):
    """Return the median of the wall times of a call [s], after one that warms up."""
    call()
    took = []
    for _ in range(TIMES):
        began = time.perf_counter()
        call()
        took.append(time.perf_counter() - began)
    return statistics.median(took)


def rows_of(start, count, total):
    """Return rows of a sweep: sorted in A, results that vary from row to row."""
    at = np.arange(start, start + count)
    A = 0.001 + 0.06 * at / total
    wave = np.sin(at * 0.7) ** 2
    columns = {
        "point_id": pa.array(np.char.mod("%020x", at)),
        "A": A,
        "mu": np.full(count, 0.01),
        "Omega": np.full(count, 1.0),
        "kinetic_ratio": wave,
        "max_abs_x1": A * (10 + wave),
        "rms_x1": A * (7 + wave),
        "lyapunov": wave - 0.5,
        "status": np.full(count, "ok"),
    }
    return pa.table(columns)


def store_of(folder, total):
    """Make a store with one pinned sweep of that many points."""
    store = Store(folder / "data")
    key = "a" * 64
    with store.staging() as place:
        staged = place / "result"
        staged.mkdir()
        path = staged / "points.parquet"
        with TableFile(path, "points", provenance={"key": key}, sorted_by=["A"]) as file:
            for start in range(0, total, 10**6):
                file.add(schema.cast("points", rows_of(start, min(10**6, total - start), total)))
        manifest = {"kind": "sweep", "provenance": {"key": key}, "logs": [], "points": total, "failed": 0}
        store.commit(key, staged, {**manifest, "tables": {"points": describe_table("points", total)}})
    store.pin("big", "up", {"result": key})
    return store, store.result(key).folder / "points.parquet"


def unsorted_of(path, folder):
    """Write the same rows in random order with pyarrow's own settings, as a script that appends would leave them."""
    table = pq.read_table(path, columns=["A", "kinetic_ratio", "max_abs_x1", "rms_x1", "lyapunov"])
    order = np.random.default_rng(0).permutation(table.num_rows)
    other = folder / "unsorted.parquet"
    pq.write_table(table.take(pa.array(order)), other)
    return other


def narrow(folder, total):
    store, path = store_of(folder, total)
    other = unsorted_of(path, folder)
    sizes = [each.stat().st_size / 1e6 for each in (path, other)]
    print(f"{total} rows: {sizes[0]:.0f} MB sorted with all columns, {sizes[1]:.0f} MB unsorted with five")
    sql = f"select avg(kinetic_ratio), max(max_abs_x1) from {{}} where {NARROW}"
    plain = duckdb.connect()
    with connect(store) as catalogue:
        ours = median(lambda: catalogue.fetch(sql.format("points")))
        whole = median(lambda: catalogue.fetch("select avg(kinetic_ratio) from points"))
    range_ = (ds.field("A") >= 0.02) & (ds.field("A") <= 0.0201)
    columns = ["kinetic_ratio", "max_abs_x1"]
    peers = {
        "DuckDB on the unsorted file": median(lambda: plain.sql(sql.format(f"'{other}'")).fetchall()),
        "pyarrow dataset on ours": median(lambda: ds.dataset(path).to_table(columns=columns, filter=range_)),
        "pandas on the unsorted file": median(lambda: pa_pandas(other, columns)),
    }
    print(f"narrow range, warm: {1e3 * ours:.1f} ms (target 50 ms); a full column: {1e3 * whole:.0f} ms")
    for name, peer in peers.items():
        print(f"  {name}: {1e3 * peer:.0f} ms, ratio {peer / ours:.1f}")


def pa_pandas(path, columns):
    import pandas as pd

    return pd.read_parquet(path, columns=columns, filters=[("A", ">=", 0.02), ("A", "<=", 0.0201)])


def cold(root):
    """Time whole commands on the small tables of the quickstart, beside plain DuckDB on one of their files."""
    path = next(Path(root, "data", "results").glob("*/points.parquet"))
    plain = f"import duckdb; print(duckdb.sql(\"select count(*) from '{path}'\").fetchall())"
    command = [sys.executable, "-m", "vines.cli", "query", "select count(*) from points"]
    ours = median(lambda: subprocess.run(command, cwd=root, check=True, capture_output=True))
    peer = median(lambda: subprocess.run([sys.executable, "-c", plain], check=True, capture_output=True))
    ratio = f"ratio {ours / peer:.1f}"
    print(f"vines query, cold: {ours:.2f} s (target 0.5 s); Python with duckdb alone: {peer:.2f} s, {ratio}")


def audit(folder, total):
    """Time the physics of verify on 10^6 impacts, beside reading the file with pandas."""
    from vines.stages.audit._impacts import impact_defects
    from vines.stages.audit._rows import Rows

    count = min(total, 10**6)
    rng = np.random.default_rng(0)
    v1, v2 = rng.normal(size=count), rng.normal(size=count)
    mu, r = 0.01, 0.65
    side = np.where(v1 > v2, 1, -1).astype(np.int8)
    x1 = rng.normal(size=count)
    columns = {
        "point_id": pa.array(np.char.mod("%020x", np.arange(count))),
        **{
            name: np.full(count, value)
            for name, value in {"mu": mu, "A": 0.02, "Omega": 1.0, "r": r, "lam": 0.012}.items()
        },
        **{"side": side, "x1": x1, "x2": x1 - side, "v1": v1, "v2": v2, "w_dot": v1 - v2, "dt_next": np.ones(count)},
        "v1_after": ((1 - r * mu) * v1 + mu * (1 + r) * v2) / (1 + mu),
        "v2_after": ((1 + r) * v1 + (mu - r) * v2) / (1 + mu),
    }
    path = folder / "impacts.parquet"
    with TableFile(path, "impacts", provenance={}) as file:
        file.add(schema.cast("impacts", pa.table(columns)))
    import pandas as pd

    def ours():
        for defect in impact_defects(Rows(pq.read_table(path))):
            assert not (defect.values > defect.allowed).any(), defect.name

    mine, peer = median(ours), median(lambda: pd.read_parquet(path))
    ratio = f"ratio {mine / peer:.1f}"
    print(f"verify, law of impact on {count} rows: {mine:.2f} s; pandas reads them in {peer:.2f} s, {ratio}")


def main():
    total = int(sys.argv[1]) if len(sys.argv) > 1 else 10**7
    root = Path(os.environ.get("VINES_ROOT", ".")).resolve()
    with tempfile.TemporaryDirectory() as folder:
        narrow(Path(folder), total)
        audit(Path(folder), total)
    if any((root / "data" / "results").glob("*/points.parquet")):
        cold(root)
    else:
        print("vines query, cold: run 'vines run quickstart' first")


if __name__ == "__main__":
    main()
