"""Measures the resonances of an axis with an accelerometer, and finds the input shaper that fits.
No part of it knows the printer; `passo.motion.resonance_test` moves the head."""
