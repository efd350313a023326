"""The hashed locks: what is in each, the same versions in all, and nothing of the machine that made them."""

import re
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from vines.packages import OPTIONAL

REPOSITORY = Path(__file__).resolve().parent.parent
RUN, DEV, NODE = "requirements.lock", "requirements-dev.lock", "requirements-node.lock"
PROJECT = tomllib.loads((REPOSITORY / "pyproject.toml").read_text())
ASKED_FOR = {"numpy", "scipy", "mcap", "rerun-sdk", "pandas", "pyarrow"}


def read(name):
    """Return the logical lines of a lock without its comments, and the comments."""
    text = (REPOSITORY / name).read_text()
    lines = text.replace("\\\n", " ").splitlines()
    return [line for line in lines if line and not line.lstrip().startswith("#")], re.findall(r"#.*", text)


def pins(name):
    """Return the version of each package of a lock."""
    requirements = [Requirement(line.partition("--hash")[0]) for line in read(name)[0]]
    return {canonicalize_name(each.name): str(each.specifier) for each in requirements}


def names(requirements):
    return {canonicalize_name(Requirement(text).name) for text in requirements}


def node_in():
    lines = (REPOSITORY / "requirements-node.in").read_text().splitlines()
    return names(line for line in lines if line and not line.startswith("#"))


def extras(*of):
    return names(text for extra in of for text in PROJECT["project"]["optional-dependencies"][extra])


@pytest.mark.parametrize("lock", [RUN, DEV, NODE])
def test_each_line_is_one_version_with_its_hashes(lock):
    packages, _ = read(lock)
    assert packages
    for line in packages:
        assert re.fullmatch(r"[a-z0-9.-]+==\S+( ; .*?)?(\s+--hash=sha256:[0-9a-f]{64})+\s*", line), line


@pytest.mark.parametrize("lock", [RUN, DEV, NODE])
def test_no_line_names_a_host_or_a_place_of_a_machine(lock):
    packages, comments = read(lock)
    for line in [*packages, *comments]:
        assert not re.search(r"://|file:/|@ |(^|[\s='\"])[/~\\]|[A-Za-z]:\\", line), line
    command = next(line for line in comments if "pip-compile" in line and "--" in line)
    assert "--no-emit-index-url" in command
    assert "--no-emit-find-links" in command


def test_what_develops_is_what_runs_and_more_in_the_same_versions():
    run, dev = pins(RUN), pins(DEV)
    assert run.items() < dev.items()
    assert not {"pytest", "ruff", "basedpyright", "hypothesis", "pip-tools", "distributed", "polars"} & run.keys()


def test_what_a_node_has_is_part_of_what_runs_in_the_same_versions():
    node = pins(NODE)
    assert node.items() < pins(RUN).items()
    missing = {canonicalize_name(package) for _, package, _ in OPTIONAL.values()}
    assert not (missing | {"pillow", "contourpy"}) & node.keys()


def test_the_locks_hold_what_is_declared():
    declared, build = names(PROJECT["project"]["dependencies"]), names(PROJECT["build-system"]["requires"])
    assert declared >= ASKED_FOR
    assert pins(RUN).keys() >= declared | build
    assert pins(DEV).keys() >= extras("dev", "rig", "dask", "browse")
    assert declared | build >= node_in() >= build
    assert pins(NODE).keys() >= node_in()


def test_the_locked_versions_are_in_the_declared_ranges():
    run = pins(RUN)
    for text in PROJECT["project"]["dependencies"]:
        requirement = Requirement(text)
        assert requirement.specifier.contains(run[canonicalize_name(requirement.name)].removeprefix("==")), text


def test_each_package_that_a_node_lacks_is_known_with_what_installs_it():
    brought = {canonicalize_name(package): install for _, package, install in OPTIONAL.values()}
    assert brought.keys() >= names(PROJECT["project"]["dependencies"]) - node_in()
    for package, install in brought.items():
        extra = re.search(r"\[(\w+)\]", install)
        assert package in (extras(extra[1]) if extra else pins(RUN)), package
