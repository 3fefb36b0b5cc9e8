"""Runs that are not good end with their exit code and one line that names the reason, whatever paces them."""

import pytest

from tests.tools.bad_runs import BAD_RUNS, MODES, address_taken, run_in, two_checks, wrong

pytestmark = pytest.mark.endurance  # in process they are in test_verdict.py, test_nonsense.py, test_endings.py


@pytest.mark.timeout(400)
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("name", BAD_RUNS)
def test_a_bad_run_says_why_in_every_mode(name: str, mode: str):
    assert wrong(BAD_RUNS[name], run_in(BAD_RUNS[name], mode)) == []


@pytest.mark.timeout(700)
@pytest.mark.parametrize("mode", MODES)
def test_two_checks_at_once_are_judged_by_their_own_runs(mode: str):
    bad, good = two_checks(mode)
    assert (bad.returncode, good.returncode) == (1, 0)


@pytest.mark.timeout(700)
@pytest.mark.parametrize("mode", MODES[1:])
def test_a_run_whose_address_is_taken_shows_no_earlier_one(mode: str):
    done, earlier = address_taken(mode)
    assert done.returncode != 0
    assert earlier not in done.stdout
