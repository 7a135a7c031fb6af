"""The step generator that chips with one alarm share, driven at random against a plain account of
what it was told."""

import subprocess
from pathlib import Path

import pytest

HERE = Path(__file__).parent / "stepgen"
FIRMWARE = Path(__file__).parents[2] / "firmware"


@pytest.fixture(scope="module")
def trial(tmp_path_factory: pytest.TempPathFactory) -> Path:
    program = tmp_path_factory.mktemp("stepgen") / "trial"
    common = FIRMWARE / "hal" / "common"
    subprocess.run(
        [
            *("cc", "-std=gnu11", "-O1", "-g", "-Wall", "-Wextra", "-Werror"),
            *("-fsanitize=address,undefined", "-fno-sanitize-recover=all"),
            *(f"-I{folder}" for folder in (HERE, FIRMWARE / "hal", common)),
            *(str(HERE / "trial.c"), str(common / "stepgen.c"), "-o", str(program)),
        ],
        check=True,
    )
    return program


@pytest.mark.parametrize("seed", range(8))
def test_all_steps_come_in_order_and_in_time(trial: Path, seed: int) -> None:
    done = subprocess.run([trial, str(seed)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    steps, latest = map(int, done.stdout.split())
    assert steps > 50_000
    # Some moves ask for more than the pulses of six motors leave time for, and catch up later.
    assert latest < 20_000
