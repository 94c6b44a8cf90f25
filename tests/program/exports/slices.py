"""Read an OpenEXR file of slices: input {"file"}, output for each part its name, the version of the spectral layout and its channels."""

import json
import sys

import OpenEXR

request = json.load(sys.stdin)
with OpenEXR.File(request["file"], separate_channels=True) as file:
    parts = [
        {
            "name": part.name(),
            "version": part.header["spectralLayoutVersion"],
            "channels": {name: channel.pixels.tolist() for name, channel in part.channels.items()},
        }
        for part in file.parts
    ]
print(json.dumps(parts))
