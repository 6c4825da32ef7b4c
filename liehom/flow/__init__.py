"""Trajectories on orbits: actions, Taylor series, steps, the run, the engines.

What it needs of the exact half comes through one file, `door`.
"""
