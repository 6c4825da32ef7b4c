"""Algebras, representations and pairs by name.

`names` is the grammar, `algebras` and `pairs` construct what a name denotes; docs/catalogue.md lists the names.
"""

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
