"""Render cloths as they hang from round tables: `python drape.py OUT.png FOLDER...`, with result folders of fiberwalk.

Needs the wheels mitsuba, numpy and OpenEXR, and an LLVM that Mitsuba's llvm variants work with; `--variant scalar_rgb` needs none, and
takes a hundred times as long.
"""

import argparse
import math
from pathlib import Path

import mitsuba as mi
import numpy as np

#: Radius of a table, of its rim, half the edge of the cloth, height of the table; all relative to each other.
TABLE, RIM, HALF, HEIGHT = 0.62, 0.06, 1.16, 1.12
FOLDS = 9
#: Distance between two tables.
STEP = 2.3


def drape(u, v, phase):
    """The place of a point of the flat cloth: over the table, round its rim, then down in folds that grow."""
    length, turn = np.hypot(u, v), np.arctan2(v, u)
    over = np.clip(length - TABLE, 0, None)
    bend = np.clip(over / RIM, 0, math.pi / 2)
    down = np.clip(over - RIM * math.pi / 2, 0, None)
    swing = down * (0.20 + 0.21 * np.cos(FOLDS * turn + phase + 0.5 * np.sin(2 * turn)))
    radius = np.minimum(length, TABLE) + RIM * np.sin(bend) + swing
    sway = 0.10 * down * np.sin(FOLDS * turn + phase + 1.1)
    height = HEIGHT - RIM * (1 - np.cos(bend)) - down * 0.93
    return np.stack([radius * np.cos(turn + sway), radius * np.sin(turn + sway), np.maximum(height, 0.004)], -1)


def mesh(phase, bsdf, count=260):
    """The cloth as triangles; u runs along the weft, v along the warp."""
    axis = np.linspace(-HALF, HALF, count)
    u, v = (grid.ravel() for grid in np.meshgrid(axis, axis))
    index = np.arange(count * count).reshape(count, count)
    a, b, c, d = index[:-1, :-1].ravel(), index[:-1, 1:].ravel(), index[1:, 1:].ravel(), index[1:, :-1].ravel()
    faces = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])
    props = mi.Properties()
    props["bsdf"] = bsdf
    cloth = mi.Mesh("cloth", count * count, len(faces), has_vertex_texcoords=True, has_vertex_normals=True, props=props)
    params = mi.traverse(cloth)
    flat = lambda values, kind: kind(np.ascontiguousarray(values).ravel())
    params["vertex_positions"] = flat(drape(u, v, phase).astype(np.float32), mi.Float)
    params["vertex_texcoords"] = flat(np.stack([u, v], -1).astype(np.float32), mi.Float)
    params["faces"] = flat(faces.astype(np.uint32), mi.UInt32)
    params.update()
    cloth.recompute_vertex_normals()
    return cloth


def scene(folders, width, spp):
    """Tables in a row, an evening sun from the left and a dim sky."""
    import fiberwalk

    look = mi.ScalarTransform4f
    span = STEP * len(folders)
    height = int(width * 1.75 / span)
    objects = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 12},
        "sensor": {
            "type": "perspective",
            "fov": math.degrees(2 * math.atan(span / 2 / 9)),
            "fov_axis": "x",
            "to_world": look().look_at(origin=[0, -8.4, 3.1], target=[0, 0, 0.55], up=[0, 0, 1]),
            "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "gaussian"}},
            "sampler": {"type": "independent", "sample_count": spp},
        },
        "sky": {"type": "constant", "radiance": {"type": "rgb", "value": [0.36, 0.38, 0.42]}},
        "sun": {
            "type": "rectangle",
            "to_world": look().look_at(origin=[-7, -4.5, 7], target=[0, 0, 0.5], up=[0, 0, 1]) @ look().scale([4, 4, 1]),
            "emitter": {"type": "area", "radiance": {"type": "rgb", "value": [6.2, 5.9, 5.5]}},
        },
        "floor": {
            "type": "rectangle",
            "to_world": look().scale([60, 60, 1]),
            "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.33, 0.30, 0.27]}},
        },
    }
    for number, folder in enumerate(folders):
        cloth = mi.load_dict(fiberwalk.cloth(Path(folder) / "bsdf.exr"))
        x = STEP * (number - (len(folders) - 1) / 2)
        # Move the vertices themselves: a mesh has no transformation of its own.
        shape = mesh(0.7 + 1.3 * number, cloth)
        params = mi.traverse(shape)
        moved = np.array(params["vertex_positions"]).reshape(-1, 3) + np.array([x, 0, 0])
        params["vertex_positions"] = mi.Float(moved.astype(np.float32).ravel())
        params.update()
        shape.recompute_vertex_normals()
        objects[f"cloth{number}"] = shape
        objects[f"table{number}"] = {
            "type": "cylinder",
            "p0": [x, 0, 0],
            "p1": [x, 0, HEIGHT - 0.012],
            "radius": TABLE * 0.97,
            "bsdf": {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.42, 0.29, 0.19]}}},
        }
        objects[f"top{number}"] = {
            "type": "disk",
            "to_world": look().translate([x, 0, HEIGHT - 0.012]) @ look().scale([TABLE * 0.97, TABLE * 0.97, 1]),
            "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.42, 0.29, 0.19]}},
        }
    return mi.load_dict(objects)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out")
    parser.add_argument("folder", nargs="+")
    parser.add_argument("--variant", default="llvm_ad_rgb")
    parser.add_argument("--width", type=int, default=1200)
    parser.add_argument("--spp", type=int, default=256)
    arguments = parser.parse_args()
    mi.set_variant(arguments.variant)
    image = 0
    picture = scene(arguments.folder, arguments.width, arguments.spp)
    # Several short passes take less memory than a long one.
    passes = max(1, arguments.spp // 32)
    for number in range(passes):
        image = image + np.array(mi.render(picture, spp=arguments.spp // passes, seed=number)) / passes
    mi.util.write_bitmap(arguments.out, mi.Bitmap(image.astype(np.float32)))


main()
