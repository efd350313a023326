"""Random starts at the points of a sweep, and a basins stage, through the command line."""

import json

DECLARED = """
title = "beside each other"
[params]
mu = 0.01
A = 0.02
[stages.many]
kind = "sweep"
vary.Omega = [1.0]
random = 3
seed = 5
settle = 100
[stages.plane]
kind = "basins"
x = { name = "x2", from = -0.9, to = 0.9, count = 6 }
y = { name = "v2", from = 0.05, to = 0.3, count = 6 }
[stages.picture]
kind = "figure"
plot = "basins"
needs = ["plane"]
"""


def test_coexisting_attractors_are_listed_and_basins_drawn(project):
    (project.root / "pipelines" / "beside.toml").write_text(DECLARED, encoding="utf-8")
    project.vines("run", "beside", "--quiet")
    asked = "select stage, name, fraction from attractors order by stage, attractor"
    told = project.vines("query", asked, "--format", "csv")
    rows = [line.split(",") for line in told.stdout.strip().splitlines()[1:]]
    assert {row[0] for row in rows} == {"many", "plane"}
    many = [row for row in rows if row[0] == "many"]
    assert many[0][1] == "1:1"
    assert sum(float(row[2]) for row in many) == 1.0
    assert list(project.data.glob("results/*/picture.png"))


RANDOM = """
title = "from random starts"
[params]
mu = 0.01
[stages.drawn]
kind = "sweep"
vary.A = { from = 0.022, to = 0.024, count = COUNT }
start = "random"
seed = 3
settle = 200
record = 8
"""


def test_random_starts_follow_from_seed_and_parameters_alone(project):
    drawn = {}
    for count in (3, 5):
        (project.root / "pipelines" / f"drawn_{count}.toml").write_text(RANDOM.replace("COUNT", str(count)))
        project.vines("run", f"drawn_{count}", "--quiet")
        asked = f"select A, x1, v1, x2, v2, seed, carry from points where pipeline = 'drawn_{count}'"
        drawn[count] = json.loads(project.vines("query", asked, "--format", "json").stdout)
    starts = {count: {row["A"]: tuple(row.values()) for row in rows} for count, rows in drawn.items()}
    assert starts[3].items() <= starts[5].items()
    assert len({row["x1"] for row in drawn[5]}) == 5
    assert all(row["seed"] == 3 and row["carry"] is None for row in drawn[5])
    assert all(abs(row["x1"] - row["x2"]) <= 1 for row in drawn[5])
