# SPDX-License-Identifier: BSD-3-Clause
"""Maps as the CSV files of a mission's folder."""
import struct

from .layout import STEPS
from .message import robot_name


def _fixed(value, decimals):
    text = f"{value:.{decimals}f}"
    return text[1:] if text.startswith("-") and not text.strip("-0.") else text


def _place(cell, size):
    return ",".join(_fixed(index * size, 3) for index in cell)


def _float32(steps):
    return struct.unpack("f", struct.pack("f", steps / STEPS))[0]


def map_csv(cells, cell_size_m):
    """global_map.csv of a fused map's cells, byte for byte as Shoal writes it."""
    lines = ["x_m,y_m,z_m,label,robot,seen_s,certainty"]
    for cell in sorted(cells):
        label, robot, seen_us, steps = cells[cell]
        lines.append(f"{_place(cell, cell_size_m)},{label},{robot_name(robot)},{_fixed(seen_us * 1e-6, 3)},"
                     f"{_fixed(_float32(steps), 4)}")
    return "\n".join(lines) + "\n"


def robot_csv(cells, cell_size_m):
    """map.csv of a robot's own cells; certainties are those that travelled, in steps of 1/63."""
    lines = ["x_m,y_m,z_m,topic,seen_s,certainty"]
    for cell in sorted(cells):
        topic, seen_us, steps = cells[cell]
        lines.append(f"{_place(cell, cell_size_m)},{topic},{_fixed(seen_us * 1e-6, 3)},{_fixed(_float32(steps), 4)}")
    return "\n".join(lines) + "\n"
