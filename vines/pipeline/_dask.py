"""Chunks on a dask cluster: a given scheduler, or a cluster of its own on this machine."""

from __future__ import annotations

import contextlib
import logging
import multiprocessing
import re
import time
from concurrent.futures import CancelledError, Executor
from functools import partial
from typing import Any

from vines.errors import DeclarationError, EngineError
from vines.packages import need
from vines.pipeline._worker import compute_apart

__all__ = ["Dask", "check_address"]

_ADDRESS = re.compile(r"([a-z]+://)?([^\s:/\[\]]+|\[[0-9a-fA-F:.%]+\]):\d{1,5}")
_CONNECT_SECONDS = 10
_REFRESH_SECONDS = 2.0


def check_address(address: str) -> None:
    """See that an address is one of a scheduler, before anything is sought there.

    Raises
    ------
    DeclarationError
        If it is none.

    Examples
    --------
    >>> check_address("tcp://node1:8786")
    >>> check_address("node1")
    Traceback (most recent call last):
        ...
    vines.errors.DeclarationError: --scheduler node1 is not an address such as tcp://node1:8786
    """
    if not _ADDRESS.fullmatch(address):
        raise DeclarationError(f"--scheduler {address} is not an address such as tcp://node1:8786")


class Dask:
    """A dask cluster, through the executor that its client gives.

    Parameters
    ----------
    address : str or None
        Address of a scheduler; None starts a scheduler and workers on this machine.
    jobs : int
        Workers to start where none is given.

    Raises
    ------
    PackageMissingError
        If dask is not installed.
    """

    worth = 0.0
    """Who asks for dask gets it: the time to start a cluster, or to reach one, is spent already."""
    apart = True

    def __init__(self, address: str | None, jobs: int) -> None:
        need("distributed")
        self._address = address
        self._jobs = jobs
        self._cluster: Any = None
        self._client: Any = None
        self._executor: Executor | None = None
        self._before: set[object] = set()
        self._size = 1
        self._counted = -_REFRESH_SECONDS

    def size(self) -> int:
        """Return how many threads the workers have together; workers may come and go."""
        if self._client is None:
            return 1
        if time.monotonic() - self._counted > _REFRESH_SECONDS:
            self._counted = time.monotonic()
            workers = self._client.scheduler_info(n_workers=-1)["workers"].values()
            self._size = max(1, sum(worker["nthreads"] for worker in workers))
        return self._size

    def executor(self) -> Executor:
        """Return the executor of the client.

        Raises
        ------
        EngineError
            If nobody answers at the address.
        """
        if self._executor is None:
            self._connect()
            self._executor = _Apart(self._client.get_executor(pure=False))
        return self._executor

    def is_loss(self, error: BaseException) -> bool:
        """Whether workers died with a chunk more often than dask tries again by itself."""
        from distributed.scheduler import KilledWorker

        self.look()
        return isinstance(error, KilledWorker | CancelledError)

    def look(self) -> None:
        """See that the scheduler is still there."""
        comm = getattr(self._client, "scheduler_comm", None)
        if self._client.status != "running" or comm is None or comm.comm.closed():
            where = self._address or "of this run"
            text = f"the dask scheduler {where} is gone; what was computed is kept"
            raise EngineError(f"{text}; the same command goes on when it is back, or without --engine dask")

    def stop(self, *, now: bool) -> None:
        """Leave the cluster; one of its own is ended."""
        client, cluster, self._client, self._cluster, self._executor = self._client, self._cluster, None, None, None
        if client is None:
            return
        with contextlib.suppress(Exception):
            if now and cluster is not None:
                for child in set(multiprocessing.active_children()) - self._before:
                    child.kill()
            client.close(timeout=0.3 if now else 5)
        if cluster is not None and not now:
            cluster.close()

    def _connect(self) -> None:
        import distributed

        # what it says of lost connections is said in one line here
        for name in [*logging.root.manager.loggerDict, "tornado.application"]:
            if name.partition(".")[0] in ("distributed", "tornado"):
                logging.getLogger(name).setLevel(logging.CRITICAL)
        if self._address is None:
            self._before = set(multiprocessing.active_children())
            self._cluster = distributed.LocalCluster(
                n_workers=self._jobs,
                threads_per_worker=1,
                processes=True,
                host="127.0.0.1",
                dashboard_address="127.0.0.1:0",
                env={"NUMBA_NUM_THREADS": "1"},
                silence_logs=logging.CRITICAL,
            )
            self._client = distributed.Client(self._cluster)
            return
        try:
            self._client = distributed.Client(self._address, timeout=_CONNECT_SECONDS, set_as_default=False)
        except (OSError, ValueError, TimeoutError) as error:
            text = (str(error).splitlines() or [type(error).__name__])[0]
            raise EngineError(
                f"no dask scheduler answers at {self._address}: {text}; start it or drop --scheduler"
            ) from None


class _Apart(Executor):
    """An executor whose processes are set up by each task, because nobody asked them to be."""

    def __init__(self, executor: Executor) -> None:
        self._executor = executor

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Any:
        """Submit a call."""
        return self._executor.submit(partial(compute_apart, fn), *args, **kwargs)
