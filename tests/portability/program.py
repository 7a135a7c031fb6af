"""A program with lines, arcs, retractions and dwells, the same every time."""

from __future__ import annotations

from math import cos, sin


def program() -> str:
    """About 1500 moves within 60 mm of (20, 20)."""
    lines = ["G28", "G90", "M83", "G1 Z5 F900", "G1 X20 Y20 F6000"]
    for i in range(1200):
        a = i * 0.37
        x, y = 20 + 25 * cos(a) * cos(i * 0.011), 20 + 25 * sin(a * 1.03)
        feed = f" F{1200 + i % 7 * 600}" if i % 50 == 0 else ""
        lines.append(f"G1 X{x:.3f} Y{y:.3f} E{0.02 + 0.001 * (i % 9):.4f}{feed}")
        if i % 100 == 60:
            lines += ["G1 E-0.8 F2100", f"G1 Z{5 + i / 1000:.3f} F900", "G4 P20", "G1 E0.8 F2100"]
        if i % 150 == 80:
            lines += ["G1 X20 Y20 F4800", "G2 X24 Y20 I2 J0 E0.1", "G3 X20 Y20 I-2 J0 E0.1 F1800"]
    return "\n".join(lines) + "\n"
