"""Files and formats: algebras, pairs, representations and certificates in JSON, solutions as .npz, other tools.

`load`, `loads`, `from_json`, `to_json` and `dump` read and write JSON (`files`, with one module for each format);
`json_reader` and `number_lists` read JSON strictly and convert numbers. `problem_file` is the `Problem` that a
representation file states for an integration. `gap_format`, `sage_format`, `sympy_format` and `latex_format` write, and
partly read, the formats of other programs; `latex_parts` writes the parts of formulas.

Input that is malformed raises `FormatError`, or a more specific `InputError`, that names the key or the index. Values
are parsed by the grammar of `liehom.scalars` and never executed. docs/formats.md describes the formats.
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
