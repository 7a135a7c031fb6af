"""A cluster gives the same rows as one process; workers that differ compute nothing."""

import os
import signal
import warnings
from pathlib import Path

import pytest
from tests.study.test_run import run, study

from passo.errors import MachineError
from passo.study import dask_work
from passo.study.case import Order
from passo.study.dask_engine import DaskEngine, refusals
from passo.study.dask_work import Identity, identity, run_shard
from passo.study.engine import Inline
from passo.study.plan import plan_study
from passo.study.run import run_study
from passo.study.study_file import Options
from passo.study.work import Shard

# The threads of a cluster that ends may leave sockets to the garbage collector.
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::DeprecationWarning")


@pytest.fixture(scope="module")
def cluster():
    from distributed import LocalCluster

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as made:
            yield made


@pytest.fixture
def engine(cluster):
    return DaskEngine.at(cluster.scheduler_address, timeout_s=60)


def test_cluster_gives_the_same_bytes(tmp_path, engine):
    assert engine.workers == 2
    expected = run(tmp_path, "inline", Inline())[1]
    assert run(tmp_path, "cluster", engine)[1] == expected


def test_killed_worker_costs_no_row(tmp_path, cluster, engine):
    struck = []

    def strike(progress, rows):
        if rows and not struck:
            struck.append(cluster.workers[0].pid)
            os.kill(struck[0], signal.SIGKILL)

    assert run(tmp_path, "struck", engine, watch=strike)[1] == run(tmp_path, "one", Inline())[1]
    assert len(struck) == 1


def test_shard_whose_workers_are_gone_is_sent_again(tmp_path, engine):
    plan = plan_study(study(tmp_path), tmp_path)
    works = [case.work for case in plan.cases if case.work is not None]
    (shard, *_) = plan.shards(works, engine)
    there, engine._threads = engine._threads, {"tcp://127.0.0.1:1": 1}
    engine.submit(shard)
    engine._threads = there
    done = []
    while engine.busy:
        done += engine.completed()
    engine.close()
    assert [len(each.results) for each in done] == [len(shard.works)]


def test_file_that_workers_lack_is_sent(tmp_path, cluster):
    plan = plan_study(study(tmp_path), tmp_path)
    expected = run_study(plan, Inline(), tmp_path / "inline")
    sent = []

    def read(file):
        sent.append(file.sha256)
        return (tmp_path / Path(file.path).name).read_bytes()

    for i, case in enumerate(plan.cases):
        if case.work is not None:
            far = case.work.file._replace(path=f"/elsewhere/{Path(case.work.file.path).name}")
            object.__setattr__(plan.cases[i], "work", case.work._replace(file=far))
    from distributed import Client

    client = Client(cluster.scheduler_address, set_as_default=False)
    rows = run_study(plan, DaskEngine(client, 60, read=read), tmp_path / "far")
    assert rows == expected
    assert len(sent) == len(set(sent)) == 8  # each once; the empty file needs no worker


def test_cluster_of_another_version_is_refused(cluster):
    from distributed import Client

    client = Client(cluster.scheduler_address, set_as_default=False)
    with client, pytest.raises(MachineError) as raised:
        DaskEngine(client, 60, own=Identity("9.9.9", "f00"))
    assert raised.value.problems[0].code == "study.cluster"
    assert "not 9.9.9" in str(raised.value)


def test_workers_that_differ_are_refused():
    own = Identity("1.0.0", "abc")
    found = {
        "a": own,
        "b": Identity("1.0.1", "abc"),
        "c": Identity("1.0.0", "abd"),
        "d": ModuleNotFoundError("passo"),
    }
    assert refusals(found, own) == {
        "b": "it has Passo 1.0.1, not 1.0.0",
        "c": "its self-test gives abd, not abc",
        "d": "it cannot run Passo (ModuleNotFoundError('passo'))",
    }


def test_cluster_that_does_not_answer_is_an_error(monkeypatch):
    monkeypatch.setattr("passo.study.dask_engine._CONNECT_S", 0.1)
    with pytest.raises(MachineError) as raised:
        DaskEngine.at("tcp://127.0.0.1:1", timeout_s=60)
    assert raised.value.problems[0].code == "study.cluster"


def test_self_test_is_the_stream_of_a_print():
    assert identity() == identity()
    assert len(identity().self_test) == 16


def test_late_case_ends_the_shard_of_a_worker(tmp_path, monkeypatch):
    plan = plan_study(study(tmp_path), tmp_path)
    works = tuple(case.work for case in plan.cases if case.work is not None)[:3]
    shard = Shard(works, plan.machines.pickled, Order("estimate", Options()))
    answers = iter([[{"status": "ok"}], None])
    monkeypatch.setattr(dask_work, "_within", lambda single, timeout_s: next(answers))
    outcome = run_shard(shard, {}, 1.0)
    assert (outcome.results, outcome.late) == ([{"status": "ok"}], True)
