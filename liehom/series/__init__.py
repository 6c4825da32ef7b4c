"""Truncated Taylor series and series in Lie algebras."""

from liehom.series.jet import Jet as Jet
