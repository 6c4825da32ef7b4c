"""Root systems and real forms: Dynkin, Vogan and Satake diagrams, involutions, and the algebras built from them.

The combinatorics of Cartan matrices, Chevalley bases, compact and real forms, and their names. The identification of
algebras and the highest weight modules build on this wing; see docs/theory/structure.md.
"""

from liehom.algebra.roots.chevalley import chevalley as chevalley
from liehom.algebra.roots.compact_form import compact_form as compact_form
from liehom.algebra.roots.compact_form import real_form_of as real_form_of
from liehom.algebra.roots.dynkin import cartan_matrix as cartan_matrix
from liehom.algebra.roots.dynkin import dynkin_diagram as dynkin_diagram
from liehom.algebra.roots.real_form import RealForm as RealForm
from liehom.algebra.roots.real_form import complex_form as complex_form
from liehom.algebra.roots.real_form import real_forms as real_forms
from liehom.algebra.roots.real_form import real_forms_with as real_forms_with
from liehom.algebra.roots.real_form import simple_real_forms as simple_real_forms
from liehom.algebra.roots.real_form_involutions import involutions as involutions
from liehom.algebra.roots.real_form_names import canonical_real_form as canonical_real_form
from liehom.algebra.roots.root_automorphism import RootAutomorphism as RootAutomorphism
from liehom.algebra.roots.root_system import RootSystem as RootSystem
from liehom.algebra.roots.root_system import root_system as root_system
from liehom.algebra.roots.satake import SatakeDiagram as SatakeDiagram
from liehom.algebra.roots.vogan import VoganDiagram as VoganDiagram
