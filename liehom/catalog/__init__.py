"""Named algebras, representations and pairs: names that parse, print and build what they say.

In reading order: `names` (the grammar), `linear` (names to matrices), `algebras` (algebras and
representations), `subalgebras` and `special` (what stands under the bar), `pairs`, `claims` (what tests expect).
"""

from liehom.catalog.algebras import algebra as algebra
from liehom.catalog.algebras import representation as representation
from liehom.catalog.claims import CLAIMS as CLAIMS
from liehom.catalog.claims import Claim as Claim
from liehom.catalog.names import parse as parse
from liehom.catalog.pairs import pair as pair
from liehom.catalog.pairs import pair_names as pair_names
