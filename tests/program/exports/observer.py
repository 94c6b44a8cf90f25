"""X, Y, Z of a unit of light of D65 at wavelengths, as Mitsuba has them: input {"wavelengths"}."""

import json
import sys

import mitsuba as mi

request = json.load(sys.stdin)
mi.set_variant("scalar_rgb")
print(json.dumps([[float(v) * mi.cie_d65(nm) for v in mi.cie1931_xyz(nm)] for nm in request["wavelengths"]]))
