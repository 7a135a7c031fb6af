"""Studies from Python."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from passo.config.origins import Origins
from passo.study.cache import Cache
from passo.study.local_engine import MEMORY_MB, TIMEOUT_S, LocalEngine
from passo.study.plan import plan_study
from passo.study.run import Watch, run_study
from passo.study.study_file import study_of

if TYPE_CHECKING:
    from passo.study.engine import Engine
    from passo.study.settings import Setting
    from passo.study.study_file import What

_DASK = "dask://"


def batch(
    files: Iterable[str | os.PathLike[str]],
    machines: Iterable[str | os.PathLike[str]] = ("i3",),
    settings: Iterable[Setting] = ({},),
    *,
    what: What = "estimate",
    options: Mapping[str, Any] | None = None,
    output: str | os.PathLike[str] | None = None,
    jobs: int | None = None,
    on: str | None = None,
    cache: str | os.PathLike[str] | None = None,
    timeout_s: float = TIMEOUT_S,
    memory_mb: int = MEMORY_MB,
) -> list[dict[str, Any]]:
    """Computes each file on each machine under each setting, like `passo batch`.

    Files are paths or patterns; machines are names or paths; a setting has keys of the machine file
    by their path, with their values. `options` are those of the study file. Returns one row for
    each case, in the order of files, machines and settings; a case that fails is a row, too.
    `output` is a folder that keeps the rows, so that the next call computes only what is missing.
    It starts `jobs` processes, by default one for each processor; `on` is a cluster,
    `dask://host:8786`. With `jobs=0` it computes in this process, without limits of time and
    memory. Raises ConfigError, InputError and MachineError.
    """
    data = {
        "files": [os.fspath(file) for file in files],
        "machines": [os.fspath(machine) for machine in machines],
        "settings": [dict(setting) for setting in settings],
        "what": what,
        "options": dict(options or {}),
    }
    study = study_of(data, Origins("passo.batch", ""))
    plan = plan_study(study, Path.cwd())
    engine = engine_of(on, os.cpu_count() or 1 if jobs is None else jobs, timeout_s, memory_mb)
    shared = None if cache is None else Cache(Path(cache))
    if output is not None:
        return run_study(plan, engine, Path(output), cache=shared)
    with TemporaryDirectory(prefix="passo-") as folder:
        return run_study(plan, engine, Path(folder), cache=shared)


def run_file(
    path: str | os.PathLike[str],
    output: str | os.PathLike[str],
    engine: Engine,
    watch: Watch,
    cache: str | os.PathLike[str] | None = None,
) -> list[dict[str, Any]]:
    """Runs the study of a file; see `run_study`. Raises ConfigError, InputError, MachineError."""
    from passo.study.study_file import load_study

    try:
        plan = plan_study(load_study(path), Path(path).parent)
        shared = None if cache is None else Cache(Path(cache))
    except BaseException:
        engine.close()
        raise
    return run_study(plan, engine, Path(output), watch, shared)


def engine_of(on: str | None, jobs: int, timeout_s: float, memory_mb: int) -> Engine:
    """The engine for a study. Raises MachineError for a cluster that cannot be used."""
    if on is not None:
        from passo.study.dask_engine import DaskEngine

        return DaskEngine.at(f"tcp://{on.removeprefix(_DASK)}", timeout_s)
    if jobs == 0:
        from passo.study.engine import Inline

        return Inline()
    return LocalEngine(jobs, timeout_s, memory_mb)
