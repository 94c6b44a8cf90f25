"""Load curves with Mitsuba's own reader and shoot rays down on them.

Usage: trace_curves.py SHAPE FILE X,Y... : prints the number of pieces, then the height that each ray from above meets, or `-`.
"""

import sys

import mitsuba as mi

mi.set_variant("scalar_rgb")
shape, file, *places = sys.argv[1:]
scene = mi.load_dict({"type": "scene", "curves": {"type": shape, "filename": file}})
print(scene.shapes()[0].primitive_count())
for place in places:
    x, y = map(float, place.split(","))
    hit = scene.ray_intersect(mi.Ray3f([x, y, 1], [0, 0, -1]))
    print(1 - hit.t if hit.is_valid() else "-")
