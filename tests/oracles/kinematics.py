"""Kinematics of every geometry in plain Python, to compare the core's with.

`inverse(model, point)` and `forward(model, positions)` take a model of `passo.geometry` for its
parameters alone. ValueError where there is no solution.
"""

from __future__ import annotations

from math import acos, atan2, cos, degrees, dist, hypot, pi, radians, sin, sqrt, tau

LEFT_MM = 0.01  # nearly stretched or folded, arms reach nothing


def inverse(model, point):
    """Positions of the actuators, mm or degrees, with the nozzle at `point`, mm."""
    return _INVERSE[model.kind](model, point)


def forward(model, positions):
    """The nozzle's position, mm, for these positions of the actuators."""
    return _FORWARD[model.kind](model, positions)


def _cartesian(_, point):
    return point


def _corexy_inverse(_, point):
    x, y, z = point
    return x + y, x - y, z


def _corexy_forward(_, positions):
    a, b, z = positions
    return (a + b) / 2, (a - b) / 2, z


def _corexz_inverse(_, point):
    x, y, z = point
    return x + z, y, x - z


def _corexz_forward(_, positions):
    a, y, b = positions
    return (a + b) / 2, y, (a - b) / 2


def _coreyz_inverse(_, point):
    x, y, z = point
    return x, y + z, y - z


def _coreyz_forward(_, positions):
    x, a, b = positions
    return x, (a + b) / 2, (a - b) / 2


def _hybrid_xy_inverse(_, point):
    x, y, z = point
    return x - y, y, z


def _hybrid_xy_forward(_, positions):
    a, y, z = positions
    return a + y, y, z


def _hybrid_xz_inverse(_, point):
    x, y, z = point
    return x - z, y, z


def _hybrid_xz_forward(_, positions):
    a, y, z = positions
    return a + z, y, z


def _delta_inverse(m, point):
    """Height of carriage i: z + √(rod_i² - (tower_x - x)² - (tower_y - y)²)."""
    x, y, z = point
    if x * x + y * y > m.limit_radius**2:
        raise ValueError("beyond the limit radius")
    heights = []
    for (tx, ty), rod in zip(m.towers, m.rods, strict=True):
        square = rod**2 - (tx - x) ** 2 - (ty - y) ** 2
        if square < 0:
            raise ValueError("beyond a rod")
        heights.append(z + sqrt(square))
    return tuple(heights)


def _delta_forward(m, positions):
    centres = [(*tower, q) for tower, q in zip(m.towers, positions, strict=True)]
    return trilaterate(centres, m.rods)


def trilaterate(centres, radii):
    """The lower of the two points at `radii` from three centres.

    In a frame with the first centre as origin, the second on its x axis and the third in its plane:
    x = (r1² - r2² + u²) / 2u, y = (r1² - r3² + i² + j² - 2ix) / 2j, z² = r1² - x² - y².
    """
    a, b, c = centres
    ab = [q - p for p, q in zip(a, b, strict=True)]
    ac = [q - p for p, q in zip(a, c, strict=True)]
    u = sum(v * v for v in ab) ** 0.5
    ex = [v / u for v in ab]
    i = sum(p * q for p, q in zip(ex, ac, strict=True))
    across = [q - i * p for p, q in zip(ex, ac, strict=True)]
    j = sum(v * v for v in across) ** 0.5
    ey = [v / j for v in across]
    ez = [ex[k - 2] * ey[k - 1] - ex[k - 1] * ey[k - 2] for k in range(3)]
    r1, r2, r3 = radii
    x = (r1**2 - r2**2 + u**2) / (2 * u)
    y = (r1**2 - r3**2 + i**2 + j**2 - 2 * i * x) / (2 * j)
    square = r1**2 - x**2 - y**2
    if square < 0:
        raise ValueError("the rods do not meet")
    z = square**0.5 * (-1 if ez[2] > 0 else 1)
    return tuple(a[k] + x * ex[k] + y * ey[k] + z * ez[k] for k in range(3))


def _rotary_inverse(m, point):
    return tuple(_rotary_arm(m, point, radians(turn)) for turn in (0, 120, -120))


def _rotary_arm(m, point, turn):
    """The elbow is at arm length from the shoulder and at rod length from the joint; of the two
    crossings of these circles it is the outer one."""
    px, py, pz = point
    x = px * cos(turn) + py * sin(turn)
    y = py * cos(turn) - px * sin(turn) + (m.base_length - m.effector_length) / (2 * sqrt(3))
    z = pz - m.z_offset
    reach = hypot(y, z)
    side = reach**2 + m.arm_length**2 - m.rod_length**2 + x**2
    full = 2 * m.arm_length * reach
    if abs(side) > full or full == 0:
        raise ValueError("the arm and its rod do not reach it")
    angle = atan2(z, y) - acos(side / full) + pi  # from -pi on
    return degrees(angle - 2 * pi if angle > pi else angle)


def _rotary_forward(m, positions):
    """The lower point at rod length from the elbows, moved inward by the effector's size."""
    centres = []
    inward = (m.effector_length - m.base_length) / (2 * sqrt(3))
    for turn, q in zip((0, 120, -120), positions, strict=True):
        y = inward - m.arm_length * cos(radians(q))
        z = m.z_offset - m.arm_length * sin(radians(q))
        centres.append((-y * sin(radians(turn)), y * cos(radians(turn)), z))
    return trilaterate(centres, [m.rod_length] * 3)


def _deltesian_inverse(m, point):
    """The rod is the long side of a right triangle; a carriage is above the nozzle by its upright
    side."""
    x, y, z = point
    heights = []
    for tower, rod in zip(m.towers_x, m.rods, strict=True):
        if abs(x - tower) > rod * cos(radians(m.min_angle)):
            raise ValueError("the rod is too flat")
        heights.append(z + sqrt(rod**2 - (x - tower) ** 2))
    return heights[0], y, heights[1]


def _deltesian_forward(m, positions):
    """The lower common point of two circles, by the angle of the left rod to the line between the
    carriages."""
    a, y, b = positions
    (left, right), (rod1, rod2) = m.towers_x, m.rods
    far = hypot(right - left, b - a)
    lean = atan2(b - a, right - left)
    turn = acos((rod1**2 + far**2 - rod2**2) / (2 * rod1 * far))
    return left + rod1 * cos(lean - turn), y, a + rod1 * sin(lean - turn)


def _direction(y, x, middle_deg):
    """atan2 in radians, within half a turn of `middle_deg`."""
    middle, angle = radians(middle_deg), atan2(y, x)
    while angle <= middle - tau / 2:
        angle += tau
    while angle > middle + tau / 2:
        angle -= tau
    return angle


def _require_reach(part1, part2, d):
    if not abs(part1 - part2) + LEFT_MM <= d <= part1 + part2 - LEFT_MM:
        raise ValueError("the arm does not reach it")


def _scara_inverse(m, point):
    """Law of cosines: cos E = (d² - arm1² - arm2²) / (2 arm1 arm2), and the shoulder is less than
    d's direction by the angle between upper arm and d."""
    x, y = point[0] - m.x_offset, point[1] - m.y_offset
    d = hypot(x, y)
    _require_reach(m.arm1, m.arm2, d)
    elbow = acos((d**2 - m.arm1**2 - m.arm2**2) / (2 * m.arm1 * m.arm2))
    middles = m.spec()["middles"]
    towards, inner = _direction(y, x, middles[0]), 2 * m.arm1 * d
    shoulder = towards - acos((d**2 + m.arm1**2 - m.arm2**2) / inner)
    if not m.external_motor:
        return degrees(shoulder), degrees(elbow), point[2]
    towards, outer = _direction(y, x, middles[1]), 2 * m.arm2 * d
    forearm = towards + acos((d**2 + m.arm2**2 - m.arm1**2) / outer)
    return degrees(shoulder), degrees(forearm), point[2]


def _scara_forward(m, positions):
    shoulder, elbow = radians(positions[0]), radians(positions[1])
    forearm = elbow if m.external_motor else shoulder + elbow
    x = m.arm1 * cos(shoulder) + m.arm2 * cos(forearm) + m.x_offset
    y = m.arm1 * sin(shoulder) + m.arm2 * sin(forearm) + m.y_offset
    return x, y, positions[2]


def _elbow(m, arm, angle):
    shoulder = (m.shoulder1_x, m.shoulder2_x)[arm]
    proximal = (m.proximal1, m.proximal2)[arm]
    return shoulder + proximal * sin(radians(angle)), proximal * cos(radians(angle))


def _dual_inverse(m, point):
    """The outer of the elbow's two places; the joint at the nozzle must stay convex."""
    x, y = point[0] - m.x_offset, point[1] - m.y_offset
    angles = []
    for arm, outside in ((0, -1), (1, 1)):
        dx = x - (m.shoulder1_x, m.shoulder2_x)[arm]
        proximal = (m.proximal1, m.proximal2)[arm]
        distal = (m.distal1, m.distal2)[arm]
        d = hypot(dx, y)
        _require_reach(proximal, distal, d)
        cosine = (d**2 + proximal**2 - distal**2) / (2 * proximal * d)
        towards = _direction(dx, y, m.spec()["middles"][arm])
        angles.append(degrees(towards + outside * acos(cosine)))
    (ax, ay), (bx, by) = _elbow(m, 0, angles[0]), _elbow(m, 1, angles[1])
    if (bx - ax) * (y - ay) - (by - ay) * (x - ax) <= 0:
        raise ValueError("the joint at the nozzle would fold through")
    return angles[0], angles[1], point[2]


def _dual_forward(m, positions):
    """The upper crossing of the two forearms' circles."""
    (ax, ay), (bx, by) = _elbow(m, 0, positions[0]), _elbow(m, 1, positions[1])
    dx, dy = bx - ax, by - ay
    square = dx * dx + dy * dy
    along = (m.distal1**2 - m.distal2**2 + square) / (2 * square)
    rest = m.distal1**2 / square - along**2
    if rest < 0:
        raise ValueError("the forearms do not meet")
    across = sqrt(rest)
    x = ax + along * dx - across * dy + m.x_offset
    y = ay + along * dy + across * dx + m.y_offset
    return x, y, positions[2]


def _polar_inverse(m, point):
    """The angle is from half a turn behind to half a turn ahead."""
    x, y, z = point
    if hypot(x, y) < m.centre:
        raise ValueError("too near the middle")
    return degrees(atan2(y, x)), hypot(x, y), z


def _polar_forward(_, positions):
    angle, reach, z = positions
    return reach * cos(radians(angle)), reach * sin(radians(angle)), z


def _winch_inverse(m, point):
    lengths = tuple(dist(point, anchor) for anchor in m.anchors)
    if min(lengths) < 1:
        raise ValueError("a cable is too short")
    return lengths


def _winch_forward(m, positions):
    """Of the two places for the first three cables, that for which the others fit; of three cables
    the lower one."""
    first = m.anchors[:3]
    below = trilaterate(first, positions[:3])
    upside = trilaterate([(x, y, -z) for x, y, z in first], positions[:3])
    places = [below, (upside[0], upside[1], -upside[2])]

    def misfit(place):
        return sum(abs(a - b) for a, b in zip(_winch_inverse(m, place), positions, strict=True))

    return places[0] if len(m.anchors) == 3 else min(places, key=misfit)


_INVERSE = {
    "cartesian": _cartesian,
    "corexy": _corexy_inverse,
    "corexz": _corexz_inverse,
    "coreyz": _coreyz_inverse,
    "hybrid_corexy": _hybrid_xy_inverse,
    "hybrid_corexz": _hybrid_xz_inverse,
    "delta": _delta_inverse,
    "deltesian": _deltesian_inverse,
    "rotary_delta": _rotary_inverse,
    "scara": _scara_inverse,
    "dual_scara": _dual_inverse,
    "polar": _polar_inverse,
    "winch": _winch_inverse,
    "none": lambda _, point: (),
}
_FORWARD = {
    "cartesian": _cartesian,
    "corexy": _corexy_forward,
    "corexz": _corexz_forward,
    "coreyz": _coreyz_forward,
    "hybrid_corexy": _hybrid_xy_forward,
    "hybrid_corexz": _hybrid_xz_forward,
    "delta": _delta_forward,
    "deltesian": _deltesian_forward,
    "rotary_delta": _rotary_forward,
    "scara": _scara_forward,
    "dual_scara": _dual_forward,
    "polar": _polar_forward,
    "winch": _winch_forward,
    "none": lambda _, positions: (0.0, 0.0, 0.0),
}
