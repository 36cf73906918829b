"""Parallel runs on dask.distributed: in processes of this machine, or on the workers of any scheduler.

A worker that dies loses no finished run: traces are fetched at once, and another worker does its other runs.
"""

import atexit
import logging
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager, suppress
from multiprocessing import active_children
from tempfile import TemporaryDirectory

import dask
from distributed import Client, Future, KilledWorker, LocalCluster, as_completed
from distributed.deploy.spec import close_clusters
from distributed.utils import silence_logging_cmgr

from skolem.tools.sweep import task as sweep_task
from skolem.tools.sweep.rows import lost_row
from skolem.tools.sweep.task import Finished, Task, WorkerRefusedError, run_on_worker
from skolem.traces.errors import Fault, InputError

ATTEMPTS = 4  # number of workers that may die in a run before it is given up
CONNECT_S = 10  # longest wait for an answer of the scheduler
TROUBLE = (OSError, RuntimeError, CancelledError)  # of dask: lost connections, waits that expire, a process that ends
SILENCE = logging.CRITICAL  # of dask: what is lost is told by the run that it costs
SETTINGS = {
    "distributed.scheduler.allowed-failures": ATTEMPTS - 1,
    "distributed.scheduler.worker-saturation": 1.0,  # runs wait at the scheduler: a dying worker counts for one alone
    "distributed.comm.timeouts.connect": CONNECT_S,
    "distributed.worker.profile.enabled": False,  # it keeps what it samples, more with every run
}


@contextmanager
def local_workers(count: int) -> Iterator[Client]:
    """Start single-threaded worker processes, reachable from this machine alone, and stop them at the end.

    Raises:
        InputError: If they cannot be started.
    """
    with (
        dask.config.set(SETTINGS),
        TemporaryDirectory(prefix="skolem-sweep-", ignore_cleanup_errors=True) as folder,
        ExitStack() as opened,
    ):
        atexit.unregister(close_clusters)  # it would wait for a cluster whose start was interrupted
        opened.callback(_kill_children)
        try:
            cluster = LocalCluster(
                n_workers=count,
                threads_per_worker=1,
                processes=True,
                host="127.0.0.1",
                dashboard_address=None,
                scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},  # any free port: two sweeps may run at a time
                preload=[sweep_task.__name__],
                memory_limit=None,
                local_directory=folder,
                silence_logs=SILENCE,
                env={"OPENBLAS_NUM_THREADS": "1"},
            )
            opened.enter_context(_closed(cluster))
            client = Client(cluster)
        except KeyboardInterrupt:
            logging.disable(logging.CRITICAL)  # this process ends: what is left of the start may fail
            raise
        except TROUBLE as error:
            raise _refused(f"the processes could not be started: {error}", "--workers") from None
        opened.enter_context(_closed(client))
        with _ended_at_once(cluster):
            yield client


@contextmanager
def workers_of(scheduler: str) -> Iterator[Client]:
    """Use the workers of a scheduler, also those that join later; they stay when the block ends.

    Raises:
        InputError: If the scheduler does not answer, or has no worker.
    """
    with dask.config.set(SETTINGS), silence_logging_cmgr(SILENCE):
        try:
            client = Client(scheduler, timeout=CONNECT_S)
        except (OSError, ValueError, TypeError) as error:
            raise _refused(f"no scheduler answers at '{scheduler}': {error}") from None
        with _closed(client):
            try:
                client.wait_for_workers(1, timeout=CONNECT_S)
            except TimeoutError:
                said = f"no worker has joined {scheduler}; start some: dask worker {scheduler} --nthreads 1"
                raise _refused(said) from None
            yield client


@contextmanager
def _ended_at_once(cluster: LocalCluster) -> Iterator[None]:
    """Kill the workers if the block is interrupted: they would first end their runs, which nobody waits for."""
    try:
        yield
    except KeyboardInterrupt:
        for nanny in cluster.workers.values():
            nanny.close_gracefully()  # it starts no new process
        _kill_children()
        raise


def _kill_children() -> None:
    for process in active_children():
        process.kill()


@contextmanager
def _closed(opened: LocalCluster | Client) -> Iterator[None]:
    """Close something of dask at the end; if that fails, the runs are finished, or another error is told."""
    try:
        yield
    finally:
        with suppress(*TROUBLE):
            opened.close()


def run_all(client: Client, tasks: Sequence[Task]) -> Generator[tuple[Task, Finished], None, None]:
    """Yield every run when it is finished, in any order; the end of the iteration cancels the others.

    Raises:
        InputError: If a worker refuses a run, or the scheduler is lost.
    """
    futures = {client.submit(run_on_worker, task, pure=False): task for task in tasks}
    try:
        for future in as_completed(list(futures)):
            task = futures.pop(future)
            yield task, _finished(future, task)
            future.release()
    finally:
        with suppress(*TROUBLE):
            client.cancel(list(futures))


def _finished(future: Future[Finished], task: Task) -> Finished:
    """Return the result of a run that is no longer under way."""
    error: BaseException | None = None
    try:
        if future.status == "finished":
            finished: Finished = future.result()
            return finished
        if future.status == "error":
            error = future.exception()
    except TROUBLE:
        pass
    if error is None:
        raise _refused("the scheduler was lost; the finished runs are kept, and the same command does the others")
    if isinstance(error, WorkerRefusedError):
        raise _refused(str(error))
    reason = (
        f"each of the {ATTEMPTS} workers that tried it died"
        if isinstance(error, KilledWorker)
        else f"{type(error).__name__}: {error}"
    )
    return Finished(lost_row(task.start, task.expected, reason), b"")


def _refused(said: str, about: str = "--scheduler") -> InputError:
    return InputError([Fault(about, 0, 0, " ".join(said.split()))])
