"""Print what an OpenEXR file holds as JSON: parts, channels, shapes, the attribute `fiberwalk`, pixels."""

import json
import sys

import OpenEXR


def keys_in_order(pairs):
    """Refuse keys that are repeated or not in their order."""
    keys = [key for key, _ in pairs]
    if keys != sorted(set(keys)):
        raise SystemExit(f"the keys of the attribute are not sorted: {keys}")
    return dict(pairs)


def describe(part):
    channels = {name: channel.pixels for name, channel in part.channels.items()}
    return {
        "name": part.name(),
        "columns": part.width(),
        "rows": part.height(),
        "attribute": json.loads(part.header["fiberwalk"], object_pairs_hook=keys_in_order),
        "channels": {
            name: {
                "type": str(pixels.dtype),
                "shape": list(pixels.shape),
                "pixels": pixels.tolist(),
            }
            for name, pixels in channels.items()
        },
    }


def main(path):
    # Without this the module joins R, G and B into one channel.
    with OpenEXR.File(path, separate_channels=True) as file:
        json.dump([describe(part) for part in file.parts], sys.stdout)


main(sys.argv[1])
