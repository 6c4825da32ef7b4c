"""Lie algebras, representations, isotropy and full pairs, decided exactly; nothing here imports `liehom.flow`.

No trajectory over floats, no Taylor series and no engine: whoever decides pairs loads no integrator.
"""
