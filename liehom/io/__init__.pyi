from liehom.io.files import (
    dump as dump,
    from_json as from_json,
    load as load,
    load_pair as load_pair,
    load_problem as load_problem,
    loads as loads,
    to_json as to_json,
)
from liehom.io.json_reader import parse_object as parse_object, read_object as read_object
from liehom.io.object_files import Problem as Problem
from liehom.io.other_programs import (
    from_gap as from_gap,
    from_sage as from_sage,
    to_gap as to_gap,
    to_sage as to_sage,
    to_sympy as to_sympy,
)
from liehom.io.page import pair_page as pair_page
from liehom.io.renderings import latex as latex
