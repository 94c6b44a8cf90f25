"""Evaluate an XML file with Radiance's own loader: input {"file", "pairs": [[theta_i, phi_i, theta_o, phi_o] in degrees]}, output XYZ of each.

Polar angles are from +z, above 90 degrees for directions below the sheet.
"""

import json
import sys

import pyradiance.bsdf as bsdf

request = json.load(sys.stdin)
loaded = bsdf.load_file(request["file"])
print(json.dumps([[float(value) for value in bsdf.query(loaded, *pair)] for pair in request["pairs"]]))
