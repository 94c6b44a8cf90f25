"""A BSDF for Mitsuba 3 that reads `bsdf.exr` of fiberwalk: reflection and transmission of both sides, in colour.

    import mitsuba as mi
    mi.set_variant("llvm_ad_rgb")          # or another RGB or monochrome variant, scalar ones included
    import fiberwalk                       # registers the plugin; needs the wheels mitsuba, numpy and OpenEXR
    scene = {"type": "scene", "sheet": {"type": "rectangle", "bsdf": fiberwalk.cloth("voile/bsdf.exr")}, ...}

`cloth` wraps the plugin into a `mask`, which lets the light that touches no fiber straight through: a share of it that is the same for
all directions, its mean over the hemisphere. The plugin then scatters the rest, as the table has it for the light that touches a fiber.
Without a mask, `{"type": "fiberwalk", "filename": ...}` scatters what the table has, and the straight light is lost.

f is linear between the middles of cells, in the coordinates of the concentric square, on both sides. That keeps the light of every
incident cell. Sampling follows the same function: an incident cell around wi, an exit cell by its light, a place under its tent.

dp/du is the weft (x), dp/dv the warp (y), the shading normal the front. The table must have a disc basis (`--incident N --exit M`, the
default) and both sides (`--sides front,back`).
"""

import json
import math

import drjit as dr
import mitsuba as mi
import numpy as np
import OpenEXR

SIDES = ("front", "back")
COMPONENTS = ("reflection", "transmission")


class Table:
    """The numbers of a `bsdf.exr`: f by side, incident cell, component and exit cell, in linear red, green and blue."""

    def __init__(self, path):
        with OpenEXR.File(str(path), separate_channels=True) as file:
            parts = {part.name(): part for part in file.parts}
            about = json.loads(next(iter(parts.values())).header["fiberwalk"])
            missing = [side for side in SIDES if f"{side}.direct" not in parts]
            if missing:
                raise ValueError(f"{path}: the {missing[0]} was not lit: measure with --sides front,back")
            self.incident, self.exit = about["incident"], about["exit"]
            for key, basis in (("incident", self.incident), ("exit", self.exit)):
                if not isinstance(basis, int):
                    raise ValueError(f"{path}: --{key} {basis} is no disc basis: measure with --incident 8 --exit 16")
            self.f = np.stack([np.stack([rgb(parts[f"{side}.{name}"]) for name in COMPONENTS], 1) for side in SIDES])
            first = lambda part: next(c.pixels for name, c in sorted(part.channels.items()) if not name.startswith("stderr."))
            self.direct = np.stack([first(parts[f"{side}.direct"])[0] for side in SIDES])
        self.openness = float(self.direct.mean())


def rgb(part):
    """f of a part in linear sRGB, [incident cell, exit cell, 3]; what lies outside of the gamut is cut."""
    channels = {name: c.pixels.astype(np.float64) for name, c in part.channels.items() if not name.startswith("stderr.")}
    if "Y" in channels:
        return np.repeat(channels["Y"][..., None], 3, -1)
    if "R" in channels:
        return np.stack([channels[name] for name in "RGB"], -1)
    pairs = sorted((float(name[2:-2].replace(",", ".")), pixels) for name, pixels in channels.items())
    nodes = np.array([nm for nm, _ in pairs])
    total = 0.0
    white = 0.0
    # Sum what the CIE 1931 observer sees under D65, linear between wavelengths and constant beyond them.
    for nm in range(380, 781, 5):
        seen = np.array(mi.xyz_to_srgb(mi.Color3f(*(observer(nm))))).ravel()
        place = np.interp(nm, nodes, np.arange(len(nodes)))
        low, high = math.floor(place), math.ceil(place)
        value = pairs[low][1] + (place - low) * (pairs[high][1] - pairs[low][1])
        total = total + value[..., None] * seen
        white = white + seen
    return np.maximum(total / white, 0.0)


def observer(nm):
    """X, Y, Z of a unit of reflectance at a wavelength under D65, up to a scale."""
    light = np.array(mi.cie_d65(mi.Float(nm))).ravel()[0]
    return [float(value * light) for value in np.array(mi.cie1931_xyz(mi.Float(nm))).ravel()]


def to_square(disc):
    """The point of the square [-1, 1]² of a point of the unit disc (Shirley and Chiu 1997)."""
    swap = abs(disc.y) > abs(disc.x)
    larger = dr.select(swap, disc.y, disc.x)
    smaller = dr.select(swap, disc.x, disc.y)
    radius = dr.select(larger < 0, -dr.norm(disc), dr.norm(disc))
    along = radius * dr.atan(smaller / dr.select(larger == 0, 1.0, larger)) * (4 / dr.pi)
    return mi.Point2f(dr.select(swap, along, radius), dr.select(swap, radius, along))


def to_disc(square):
    """The inverse of `to_square`."""
    swap = abs(square.y) > abs(square.x)
    larger = dr.select(swap, square.y, square.x)
    smaller = dr.select(swap, square.x, square.y)
    angle = smaller / dr.select(larger == 0, 1.0, larger) * (dr.pi / 4)
    along, across = larger * dr.cos(angle), larger * dr.sin(angle)
    return mi.Point2f(dr.select(swap, across, along), dr.select(swap, along, across))


def around(square, n):
    """The two cells along each axis whose middles are around a point of the square, as (low, high, share of high)."""
    result = []
    for t in (square.x, square.y):
        place = (t + 1) * (n / 2) - 0.5
        low = dr.clip(dr.floor(place), 0, n - 1)
        share = dr.clip(place - low, 0, 1)
        low = mi.UInt32(low)
        result.append((low, dr.minimum(low + 1, n - 1), share))
    return result


def corners(square, n):
    """The four cells around a point of the square, with shares that add up to 1."""
    (x0, x1, a), (y0, y1, b) = around(square, n)
    cells = [(x0, y0, (1 - a) * (1 - b)), (x1, y0, a * (1 - b)), (x0, y1, (1 - a) * b), (x1, y1, a * b)]
    return [(y * n + x, share) for x, y, share in cells]


def tent(cell, u, n):
    """A place along an axis, in cells, under the tent of a cell; beyond the middles of the outer cells the tent is flat."""
    if n == 1:
        return u
    left = dr.sqrt(2 * dr.minimum(u, 0.5)) - 0.5
    right = 1.5 - dr.sqrt(2 * dr.minimum(1 - u, 0.5))
    left = dr.select(cell == 0, u, left)
    right = dr.select(cell == n - 1, u, right)
    return cell + dr.select(u < 0.5, left, right)


class Numbers:
    """A flat array of numbers, read at indices: of a scalar variant one by one."""

    def __init__(self, values):
        values = np.ascontiguousarray(values, dtype=np.float32).ravel()
        self.values = mi.Float(values) if dr.is_jit_v(mi.Float) else values

    def at(self, index, active=True):
        if dr.is_jit_v(mi.Float):
            return dr.gather(mi.Float, self.values, index, active)
        return float(self.values[int(index)])

    def last_below(self, first, count, value):
        """The first of `count` numbers from `first` on that is above a value."""
        if dr.is_jit_v(mi.Float):
            return dr.binary_search(0, count - 1, lambda index: self.at(first + index) <= value)
        return min(int(np.searchsorted(self.values[first : first + count], value, side="right")), count - 1)


class Fiberwalk(mi.BSDF):
    """See the module. Properties: `filename`, and `masked` where a mask lets the straight light through."""

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        if mi.is_spectral or mi.is_polarized:
            raise ValueError("fiberwalk.py has red, green and blue only: take an RGB or a monochrome variant")
        table = Table(props["filename"])
        f = table.f
        if props.get("masked", False):
            # Of the light that touches a fiber; where none does, nothing is scattered.
            touches = 1 - table.direct
            f = f / np.where(touches > 0, touches, 1.0)[:, :, None, None, None]
        self.n_in, self.n_out = table.incident, table.exit
        self.exits = self.n_out**2
        sides, cells = f.shape[:2]
        # Densities by projected solid angle, of both components together, of the light that an incident cell scatters.
        density = f.mean(-1).reshape(sides, cells, 2 * self.exits).astype(np.float64)
        light = density.sum(-1, keepdims=True) * (math.pi / self.exits)
        density = np.where(light > 0, density / np.where(light > 0, light, 1.0), 1 / (2 * math.pi))
        self.f = [Numbers(f[..., k]) for k in range(3)]
        self.density = Numbers(density)
        self.sums = Numbers(np.cumsum(density, -1) * (math.pi / self.exits))
        reflection = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide | mi.BSDFFlags.Anisotropic
        transmission = mi.BSDFFlags.GlossyTransmission | mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide | mi.BSDFFlags.Anisotropic
        self.m_components = [reflection, transmission]
        self.m_flags = reflection | transmission

    def row(self, si):
        """First number of the side that is lit."""
        return dr.select(mi.Frame3f.cos_theta(si.wi) > 0, mi.UInt32(0), mi.UInt32(self.n_in**2)) * (2 * self.exits)

    def enabled(self, ctx, wi, wo, active):
        """Whether light goes from wi to wo at all, and to which component."""
        cos_i, cos_o = mi.Frame3f.cos_theta(wi), mi.Frame3f.cos_theta(wo)
        reflected, transmitted = cos_i * cos_o > 0, cos_i * cos_o < 0
        reflects = ctx.is_enabled(mi.BSDFFlags.GlossyReflection, 0)
        transmits = ctx.is_enabled(mi.BSDFFlags.GlossyTransmission, 1)
        return active & ((reflected & reflects) | (transmitted & transmits)), reflected

    def lookup(self, numbers, si, wo, reflected, active):
        """Numbers at wi and wo, linear between the middles of cells on both sides."""
        first = self.row(si) + dr.select(reflected, mi.UInt32(0), mi.UInt32(self.exits))
        exits = corners(to_square(mi.Point2f(wo.x, wo.y)), self.n_out)
        result = [0.0] * len(numbers)
        for cell, share in corners(to_square(mi.Point2f(si.wi.x, si.wi.y)), self.n_in):
            for exit, part in exits:
                index = first + cell * (2 * self.exits) + exit
                for k, array in enumerate(numbers):
                    result[k] = result[k] + share * part * array.at(index, active)
        return result

    def eval_pdf(self, ctx, si, wo, active=True):
        active, reflected = self.enabled(ctx, si.wi, wo, mi.Bool(active))
        cosine = dr.select(active, abs(mi.Frame3f.cos_theta(wo)), 0.0)
        red, green, blue, density = self.lookup([*self.f, self.density], si, wo, reflected, active)
        if mi.is_monochromatic:
            value = mi.Spectrum(cosine * (0.2126 * red + 0.7152 * green + 0.0722 * blue))
        else:
            value = mi.Color3f(red, green, blue) * cosine
        return value, density * cosine

    def eval(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[0]

    def pdf(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[1]

    def sample(self, ctx, si, sample1, sample2, active=True):
        active = mi.Bool(active) & (mi.Frame3f.cos_theta(si.wi) != 0)
        # Take one of the incident cells around wi, and use what is left of the number once more.
        (x0, x1, a), (y0, y1, b) = around(to_square(mi.Point2f(si.wi.x, si.wi.y)), self.n_in)
        high = sample1 < a
        u = dr.select(high, sample1 / dr.select(a > 0, a, 1.0), (sample1 - a) / dr.select(a < 1, 1 - a, 1.0))
        x = dr.select(high, x1, x0)
        high = u < b
        u = dr.select(high, u / dr.select(b > 0, b, 1.0), (u - b) / dr.select(b < 1, 1 - b, 1.0))
        cell = dr.select(high, y1, y0) * self.n_in + x
        # Take an exit cell of either component by its light, and a place under its tent.
        found = self.sums.last_below(self.row(si) + cell * (2 * self.exits), 2 * self.exits, u)
        reflected = found < self.exits
        exit = dr.select(reflected, found, found - self.exits)
        row = exit // self.n_out
        column = exit - row * self.n_out
        place = mi.Point2f(tent(column, sample2.x, self.n_out), tent(row, sample2.y, self.n_out))
        disc = to_disc(place * (2 / self.n_out) - 1)
        z = dr.sqrt(dr.maximum(1 - dr.squared_norm(disc), 0.0))
        wo = mi.Vector3f(disc.x, disc.y, dr.select(reflected == (mi.Frame3f.cos_theta(si.wi) > 0), z, -z))
        value, pdf = self.eval_pdf(ctx, si, wo, active)
        active &= pdf > 0
        bs = mi.BSDFSample3f()
        bs.wo = wo
        bs.pdf = dr.select(active, pdf, 0.0)
        bs.eta = 1.0
        bs.sampled_component = dr.select(reflected, mi.UInt32(0), mi.UInt32(1))
        bs.sampled_type = dr.select(
            reflected, mi.UInt32(+mi.BSDFFlags.GlossyReflection), mi.UInt32(+mi.BSDFFlags.GlossyTransmission)
        )
        return bs, dr.select(active, value / dr.select(pdf > 0, pdf, 1.0), 0.0)

    def to_string(self):
        return f"Fiberwalk[{self.n_in}x{self.n_in} incident, {self.n_out}x{self.n_out} exit cells]"


mi.register_bsdf("fiberwalk", Fiberwalk)


def cloth(path):
    """The plugin inside of a mask that lets the light which touches no fiber straight through."""
    openness = Table(path).openness
    if openness == 0:
        return {"type": "fiberwalk", "filename": str(path)}
    return {"type": "mask", "opacity": 1 - openness, "bsdf": {"type": "fiberwalk", "filename": str(path), "masked": True}}
