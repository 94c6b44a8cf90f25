"""Evaluate a `.bsdf` with Mitsuba's `measured`: input {"file", "variant", "pairs": [[wi, wo], ...], "wavelengths": [nm, ...]}.

Output: f times the cosine of wo for each pair, by channel, or by wavelength where there are some (a multiple of four).
"""

import json
import sys

import mitsuba as mi
import numpy as np

request = json.load(sys.stdin)
mi.set_variant(request["variant"])
bsdf = mi.load_dict({"type": "measured", "filename": request["file"]})
context = mi.BSDFContext()
found = []
for wi, wo in request["pairs"]:
    si = mi.SurfaceInteraction3f()
    si.wi = mi.Vector3f(*wi)
    values = []
    for first in range(0, max(len(request["wavelengths"]), 1), 4):
        if request["wavelengths"]:
            si.wavelengths = request["wavelengths"][first : first + 4]
        values += [float(value) for value in np.array(bsdf.eval(context, si, mi.Vector3f(*wo))).ravel()]
    found.append(values)
print(json.dumps(found))
