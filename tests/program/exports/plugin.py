"""Hold the plugin of assets/mitsuba against a `bsdf.exr`: input {"file", "variant", "tasks"}, output by task.

eval: largest difference of eval from the table in the middles of cells, relative to the largest f, and how many cells were looked at.
scalar: values, densities and samples of a few pairs of directions, to be held against those of another variant.
chi2: p-values of Mitsuba's test for several wi, and that of samples for one wi against the density for another.
furnace: mean pixel, with its standard error, of a picture of a lossless cloth under an even sky of radiance 1; and without its mask; weights of samples.
"""

import json
import sys

import mitsuba as mi
import numpy as np

request = json.load(sys.stdin)
mi.set_variant(request["variant"])

import drjit as dr
import fiberwalk

table = fiberwalk.Table(request["file"])
bsdf = mi.load_dict({"type": "fiberwalk", "filename": request["file"]})
context = mi.BSDFContext()


def middle(cell, n, z):
    """The direction in the middle of a cell of a disc basis, above or below the sheet, computed in double precision."""
    a, b = (2 * (cell % n) + 1) / n - 1, (2 * (cell // n) + 1) / n - 1
    if abs(a) >= abs(b):
        angle = np.pi / 4 * b / a if a else 0.0
        x, y = a * np.cos(angle), a * np.sin(angle)
    else:
        angle = np.pi / 4 * a / b
        x, y = b * np.sin(angle), b * np.cos(angle)
    return [float(v) for v in (x, y, z * np.sqrt(1 - x * x - y * y))]


def interaction(wi):
    si = mi.SurfaceInteraction3f() if not dr.is_jit_v(mi.Float) else dr.zeros(mi.SurfaceInteraction3f)
    si.wi = mi.Vector3f(*wi)
    return si


def cells(count):
    """Pairs of cells of every side and component."""
    random = np.random.default_rng(3)
    for _ in range(count):
        yield random.integers(2), random.integers(table.incident**2), random.integers(2), random.integers(table.exit**2)


def directions(side, i, component, o):
    front = 1 if side == 0 else -1
    return middle(i, table.incident, front), middle(o, table.exit, front if component == 0 else -front)


def check_eval():
    most, bright = 0.0, 0
    for side, i, component, o in cells(600):
        wi, wo = directions(side, i, component, o)
        value = np.array(bsdf.eval(context, interaction(wi), mi.Vector3f(*wo))).ravel() / abs(wo[2])
        expected = table.f[side, i, component, o]
        most = max(most, float(abs(value - expected).max()))
        bright += int(expected.max() > 0)
    return {"most": most / float(table.f.max()), "bright": bright}


def check_scalar():
    found = []
    for side, i, component, o in cells(100):
        wi, wo = directions(side, i, component, o)
        # Off the middles, where all the shares count.
        wi = np.array(wi) + [0.03, -0.02, 0]
        wi /= np.linalg.norm(wi)
        si = interaction(wi.tolist())
        value, pdf = bsdf.eval_pdf(context, si, mi.Vector3f(*wo))
        sample, weight = bsdf.sample(context, si, mi.Float(0.37), mi.Point2f(0.61, 0.23))
        numbers = [value, pdf, sample.wo, sample.pdf, weight]
        found.append([float(v) for number in numbers for v in np.array(number).ravel()])
    return found


def check_chi2():
    from mitsuba.chi2 import BSDFAdapter, ChiSquareTest, SphericalDomain

    extra = f'<string name="filename" value="{request["file"]}"/>'
    adapt = lambda wi: BSDFAdapter("fiberwalk", extra, wi=dr.normalize(mi.ScalarVector3f(*wi)))
    wanted = [[0, 0, 1], [0.5, 0.2, 0.8], [-0.9, 0.3, 0.2], [0.1, -0.6, -0.7], [-0.4, -0.8, -0.15]]
    result = []

    def p_value(sample, density):
        test = ChiSquareTest(SphericalDomain(), sample, density, sample_dim=3, sample_count=400000, res=41, ires=16)
        test.run(significance_level=0.01, test_count=1)
        return float(np.array(test.p_value).ravel()[0])

    for wi in wanted:
        sample, density = adapt(wi)
        result.append(p_value(sample, density))
    other, _ = adapt([0.5, 0.2, 0.8])
    _, density = adapt([0.5, 0.3, 0.8])
    return {"p": result, "bent": p_value(other, density)}


def furnace(cloth):
    look = mi.ScalarTransform4f().look_at(origin=[1.5, -2.5, 1.2], target=[0, 0, 0], up=[0, 0, 1])
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": 30, "rr_depth": 1000},
            "sensor": {
                "type": "perspective",
                "fov": 14,
                "to_world": look,
                "film": {"type": "hdrfilm", "width": 24, "height": 24, "rfilter": {"type": "box"}},
            },
            "sky": {"type": "constant", "radiance": 1.0},
            "flat": {"type": "rectangle", "bsdf": cloth},
        }
    )
    pixels = np.array(mi.render(scene, spp=256, seed=4))
    return [float(pixels.mean()), float(pixels[..., 0].std() / pixels[..., 0].size ** 0.5)]


def weights():
    """Smallest and largest weight of samples of the light that touches a fiber, from both sides."""
    count = 200000
    scattered = mi.load_dict({"type": "fiberwalk", "filename": request["file"], "masked": True})
    random = mi.PCG32(size=count)
    two = lambda: mi.Point2f(random.next_float32(), random.next_float32())
    si = dr.zeros(mi.SurfaceInteraction3f, count)
    si.wi = mi.warp.square_to_uniform_sphere(two())
    found = np.array(scattered.sample(context, si, random.next_float32(), two())[1])
    return [float(found.min()), float(found.max())]


def check_furnace():
    lost = {"type": "fiberwalk", "filename": request["file"]}
    return {
        "masked": furnace(fiberwalk.cloth(request["file"])),
        "plain": furnace(lost),
        "openness": table.openness,
        "weights": weights(),
    }


tasks = {"eval": check_eval, "scalar": check_scalar, "chi2": check_chi2, "furnace": check_furnace}
print(json.dumps({task: tasks[task]() for task in request["tasks"]}))
