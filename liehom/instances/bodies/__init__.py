"""Rigid bodies under torques and forces: attitude, pose, and the heavy top, each as an action of a Lie group on R^N.

The state of a body is a point of R^N, so that every step, engine and gradient of the library works on it; methods of
the body read attitude, quaternion, momentum and energy from states. See docs/bodies.md. Users start from
`liehom.AttitudeBody`, `liehom.SE3Body` and `liehom.HeavyTop`; `rigid_body` is based on `AttitudeBody`.
"""

from liehom.instances.bodies.attitude_body import AttitudeBody as AttitudeBody
from liehom.instances.bodies.body import BodyState as BodyState
from liehom.instances.bodies.heavy_top import HeavyTop as HeavyTop
from liehom.instances.bodies.se3_body import PoseState as PoseState
from liehom.instances.bodies.se3_body import SE3Body as SE3Body
