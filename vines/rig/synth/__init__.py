"""A synthetic rig: physics and an integrator of its own, so that it shares no equation with what it tests."""
