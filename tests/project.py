"""A project in a folder, and its command line: called in this process, or in one of its own."""

import contextlib
import io
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

import vines.cli

REPOSITORY = Path(__file__).resolve().parent.parent


@dataclass
class Said:
    """What a call of the command line printed, and its exit code."""

    returncode: int
    stdout: str
    stderr: str


@dataclass
class Project:
    """A project in a folder and its command line."""

    root: Path

    @property
    def environment(self):
        """What the command line finds in the environment beside what is there."""
        return {"VINES_ROOT": str(self.root), "COLUMNS": "160"}

    @property
    def data(self):
        """The folder of results."""
        return self.root / "data"

    def vines(self, *arguments, check=True):
        """Call the command line in this process, from its arguments to its exit code, without starting Python again.

        An error that ``main`` does not turn into a line is raised here, where a process would print its traceback.
        """
        out, err = (io.TextIOWrapper(io.BytesIO(), "utf-8", write_through=True) for _ in range(2))
        with (
            mock.patch.dict(os.environ, self.environment),  # what a command changes there is put back as well
            mock.patch.object(sys, "argv", ["vines", *map(str, arguments)]),
            contextlib.chdir(self.root),
            contextlib.redirect_stdout(out),
            contextlib.redirect_stderr(err),
        ):
            try:
                vines.cli.main(supervised=False)
            except SystemExit as end:
                code = end.code
        said = Said(code, *(stream.buffer.getvalue().decode() for stream in (out, err)))
        if check:
            assert said.returncode == 0, said.stderr + said.stdout
        return said

    def start(self, *arguments, **options):
        """Start the command line in a process of its own, for tests that interrupt it."""
        return subprocess.Popen(
            [sys.executable, "-m", "vines.cli", *map(str, arguments)],
            text=True,
            cwd=self.root,
            env={**os.environ, **self.environment},
            **options,
        )

    def process(self, *arguments, check=True, timeout=300):
        """Call the command line in a process of its own, for tests of what only a process shows."""
        with self.start(*arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
            try:
                out, err = process.communicate(timeout=timeout)
            except BaseException:
                process.kill()
                raise
        if check:
            assert process.returncode == 0, err + out
        return Said(process.returncode, out, err)
