"""Heat: sensors, control, tuning and calibration."""
