"""The checker extracted from the proofs agrees with the checker of the library; docs/formal/check.sh builds it."""

import copy
import json
import shutil
import subprocess
from pathlib import Path

import pytest

import liehom as lh
from tests.formal import agreement

pytestmark = pytest.mark.skipif(agreement.program() is None, reason="docs/formal/check.sh has not built liehom-check")


def assert_agreement(cases: list[agreement.Case]) -> None:
    seen, different = agreement.compared(cases)
    assert not different, different[0]
    assert seen.total() == len(cases)


def test_catalogue_of_small_dimensions() -> None:
    assert_agreement(list(agreement.catalogue(4)))


def test_mutants_of_small_pairs() -> None:
    cases = list(agreement.mutants(400, 1, limit=5))
    assert {"accepted: full / accepted: full", "rejected / rejected"} <= set(agreement.compared(cases)[0])
    assert_agreement(cases)


def test_wrong_claims_are_rejected() -> None:
    """The outcome depends on the numbers: a form that is not invariant, a covector that does not vanish on h."""
    full = {"format": "liehom-certificate", "version": 1, "kind": "full", "eta": ["1", "0", "0"],
            "elements": [["0", "0", "1"]], "form": [[0, 0, "1"], [1, 1, "1"]]}  # fmt: skip
    sphere = {"dimension": 3, "structure_constants": [[0, 1, 2, "1"], [1, 2, 0, "1"], [0, 2, 1, "-1"]],
              "subalgebra": [["0", "0", "1"]]}  # fmt: skip
    wrong_form, wrong_pair = copy.deepcopy(full), copy.deepcopy(sphere)
    wrong_form["form"][0][2] = "2"
    wrong_pair["structure_constants"][2][3] = "1"
    cases = [("right", sphere, full), ("form", sphere, wrong_form), ("pair", wrong_pair, full)]
    outcomes = [outcome.split(":")[0] for outcome in agreement.of_program(cases)]
    assert outcomes == ["accepted", "rejected", "rejected"]


def test_tables_that_break_the_jacobi_identity_are_rejected() -> None:
    """[e0, e2] = e0, [e1, e2] = e2: h = <e0, e1> is closed and acts on g/h, and [e0, [e1, e2]] = e0 is not 0."""
    trivial = {"format": "liehom-certificate", "version": 1, "kind": "trivial"}
    table = {"dimension": 3, "structure_constants": [[0, 2, 0, "1"], [1, 2, 2, "1"]],
             "subalgebra": [["1", "0", "0"], ["0", "1", "0"]]}  # fmt: skip
    cases = [("Jacobi", table, trivial), ("Lie", {**table, "structure_constants": [[1, 2, 2, "1"]]}, trivial)]
    outcomes = [outcome.split(":")[0] for outcome in agreement.of_program(cases)]
    assert outcomes == ["rejected", "accepted"]


@pytest.mark.skipif(shutil.which("coqc") is None, reason="Coq is not installed")
def test_coq_itself_computes_the_check(tmp_path: Path) -> None:
    pair = lh.pair("so(3)/so(2)")
    (tmp_path / "pair.json").write_text(json.dumps(lh.to_json(pair)))
    (tmp_path / "certificate.json").write_text(json.dumps(lh.decide_fullness(pair).certificate.to_json()))
    program = agreement.program()
    command = [program, "--coq", "pair.json", "certificate.json"]
    source = subprocess.run(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True, check=True).stdout
    assert "Theorem verdict (R : rcfType) : pair_is_valid R pair /\\ pair_is_full R pair." in source
    (tmp_path / "verdict.v").write_text(source)
    theories = ["-w", "none", "-R", program.parent / "theories", "Liehom"]
    done = subprocess.run(["coqc", *theories, "verdict.v"], cwd=tmp_path, stdout=subprocess.PIPE, text=True, check=True)
    assert done.stdout.strip() == "Closed under the global context"


@pytest.mark.slow
def test_whole_catalogue_and_twenty_thousand_mutants() -> None:
    assert_agreement(list(agreement.catalogue()))
    assert_agreement(list(agreement.mutants(20000, 0)))
