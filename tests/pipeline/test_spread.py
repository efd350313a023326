"""Bodies of the whole shape that share parts of their work among processes."""

import importlib

import pytest

from vines.errors import RunFailed
from vines.pipeline import Kind, register

BODY = '''
"""A body that squares numbers in as many processes as there are."""

import multiprocessing
import os
from pathlib import Path

import msgspec

from vines.pipeline import Batch


class SquareOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    numbers: tuple[float, ...] = (1.0, 2.0, 3.0, 4.0)
    die: str = ""
    always: bool = False


def square(item):
    number, die, always = item
    if number < 0:
        raise ValueError(f"{number:g} is negative")
    if die and number == 3.0 and multiprocessing.parent_process() and (always or not Path(die).exists()):
        Path(die).touch()
        os._exit(1)
    return number**2


def squares(job):
    options = job.options
    made = job.spread(square, [(number, options.die, options.always) for number in options.numbers])
    return Batch(tables={"checks": [{"id": "square", "our_value": value} for value in made]})
'''


@pytest.fixture
def squares(lab):
    """Return a laboratory with a kind that squares numbers."""
    lab.source("squares", BODY)
    bodies = importlib.import_module("toylab.squares")
    body = "toylab.squares:squares"
    register(Kind("squares", "squares", "whole", bodies.SquareOptions, body, tables=("checks",)))
    return lab


def declared(lab, more=""):
    return lab.declare(f'title = "squares"\n[stages.all]\nkind = "squares"\n{more}')


def test_results_come_in_order_whoever_made_them(squares):
    squares.run(declared(squares), jobs=1)
    alone = squares.bytes_of("all")
    assert [row["our_value"] for row in squares.rows("all")] == [1.0, 4.0, 9.0, 16.0]
    squares.run(declared(squares), jobs=2, force=True)
    assert squares.bytes_of("all") == alone
    told = [(event.done, event.wanted, event.jobs) for event in squares.events if event.what == "progress"]
    assert told == [(1, 4, 2), (2, 4, 2), (3, 4, 2), (4, 4, 2)]


def test_a_worker_that_dies_once_costs_nothing(squares):
    squares.run(declared(squares, f'die = "{squares.folder / "died"}"'), jobs=2)
    assert [row["our_value"] for row in squares.rows("all")] == [1.0, 4.0, 9.0, 16.0]
    assert (squares.folder / "died").exists()


def test_workers_that_die_again_and_again_end_the_stage_in_one_line(squares):
    more = f'always = true\ndie = "{squares.folder / "died"}"'
    outcome = squares.run(declared(squares, more), jobs=2).stages[0]
    assert outcome.state == "failed"
    assert "worker processes died 3 times" in outcome.reason


@pytest.mark.parametrize("jobs", [1, 2])
def test_an_error_of_an_item_is_that_of_the_stage(squares, jobs):
    summary = squares.run(declared(squares, "numbers = [1.0, -2.0]"), jobs=jobs)
    with pytest.raises(RunFailed, match="-2 is negative"):
        summary.check()
