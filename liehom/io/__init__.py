"""Files and formats: algebras, pairs, representations and certificates in JSON, solutions as .npz, other tools.

`load`, `loads`, `from_json`, `to_json` and `dump` read and write JSON (`files`, with the formats in `object_files`);
`json_reader` reads JSON strictly and converts numbers. A `Problem` is what a representation file states for an
integration. `other_programs` has GAP, Sage and sympy, `renderings` LaTeX and HTML, `page` a page about a pair.

Input that is malformed raises `FormatError`, or a more specific `InputError`, that names the key or the index. Values
are parsed by the grammar of `liehom.exact.scalars` and never executed. docs/formats.md describes the formats.
"""

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
