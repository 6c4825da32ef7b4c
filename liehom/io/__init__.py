"""Files: algebras, pairs, representations and certificates in JSON, read strictly; solutions as arrays.

json_text            a text to a JSON object: no duplicate keys, no NaN, unknown keys named
values               lists of JSON values to numbers of a field, quickly
algebra_file         {"dimension", "structure_constants", ...} to a LieAlgebra
pair_file            {"dimension", "structure_constants", "subalgebra", ...} to a Pair
problem              `Problem`: the field, the start and the options of an integration
gap_format           `to_gap`, `from_gap`: the structure constant tables of GAP
sage_format          `to_sage`, `from_sage`: the dictionaries of brackets of Sage
latex_text           `latex` of brackets, matrices, subalgebras, numbers
sympy_format         `to_sympy`
representation_file  {"matrices", "point", "generator", ...} to a Representation and a Problem
solution_file        a solution as an .npz archive: t, y and the report
files                `load`, `load_pair`, `load_problem`, `loads`, `from_json`, `to_json`, `dump`

Whatever is refused raises `FormatError` or a more specific child of `InputError` that names the key or the
index; values are parsed by the whitelist grammar of `liehom.scalars`, never executed.
"""

from liehom.io.files import dump as dump
from liehom.io.files import from_json as from_json
from liehom.io.files import load as load
from liehom.io.files import load_pair as load_pair
from liehom.io.files import load_problem as load_problem
from liehom.io.files import loads as loads
from liehom.io.files import to_json as to_json
from liehom.io.gap_format import from_gap as from_gap
from liehom.io.gap_format import to_gap as to_gap
from liehom.io.json_reader import parse_object as parse_object
from liehom.io.json_reader import read_object as read_object
from liehom.io.latex_format import latex as latex
from liehom.io.problem_file import Problem as Problem
from liehom.io.sage_format import from_sage as from_sage
from liehom.io.sage_format import to_sage as to_sage
from liehom.io.solution_file import save_solution as save_solution
from liehom.io.sympy_format import to_sympy as to_sympy

__all__ = [
    "load",
    "load_pair",
    "load_problem",
    "loads",
    "from_json",
    "to_json",
    "dump",
    "parse_object",
    "read_object",
    "Problem",
    "save_solution",
    "to_gap",
    "from_gap",
    "to_sage",
    "from_sage",
    "latex",
    "to_sympy",
]
