"""Reflection for mitsuba_glossy.py that Mitsuba lacks, as its BSDF classes; f times the cosine, as Mitsuba wants values.

Phong, kd/π + ks (N+2)/(2π) max(0, R·ω)^N, is that of the reference tool. The metal of glTF 2.0, appendix B, is here: Mitsuba's
conductor has its distribution and shadowing, but not its Fresnel term. Sampling is Mitsuba's, by visible normals.
"""

import math

NAME = "gltf_metal"


def define(tool):
    """Registers the metal with Mitsuba as `NAME`: base colour `red`, `green`, `blue`, and `alpha`, the square of the roughness."""
    mi, dr = tool.mi, tool.dr

    class Metal(mi.BSDF):
        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.colour = [float(props[key]) for key in ("red", "green", "blue")]
            self.alpha = float(props["alpha"])
            self.normals = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, self.alpha, True)
            flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
            self.m_components, self.m_flags = [flags], flags

        def visible(self, cosine):
            """V of the appendix, for one of the two directions; both together are G / (4 cos cos)."""
            squared = self.alpha**2
            return 1 / (cosine + dr.sqrt(squared + (1 - squared) * cosine**2))

        def value(self, wi, wo):
            half = dr.normalize(wi + wo)
            squared = self.alpha**2
            density = squared / (math.pi * ((squared - 1) * half.z**2 + 1) ** 2)
            weight = (1 - dr.abs(dr.dot(wi, half))) ** 5
            colour = mi.Color3f(*self.colour)
            return (colour + (1 - colour) * weight) * (density * self.visible(wi.z) * self.visible(wo.z) * wo.z)

        def density(self, wi, wo):
            half = dr.normalize(wi + wo)
            return self.normals.pdf(wi, half) / (4 * dr.dot(wo, half))

        def sample(self, ctx, si, sample1, sample2, active=True):
            half, _ = self.normals.sample(si.wi, sample2)
            found = dr.zeros(mi.BSDFSample3f)
            found.wo = mi.reflect(si.wi, half)
            pdf = self.density(si.wi, found.wo)
            above = active & (si.wi.z > 0) & (found.wo.z > 0) & (pdf > 0)
            found.pdf, found.eta = dr.select(above, pdf, 0), 1.0
            found.sampled_type = mi.UInt32(+mi.BSDFFlags.GlossyReflection)
            found.sampled_component = mi.UInt32(0)
            return found, dr.select(above, self.value(si.wi, found.wo) / pdf, 0)

        def eval(self, ctx, si, wo, active=True):
            return dr.select(active & (si.wi.z > 0) & (wo.z > 0), self.value(si.wi, wo), 0)

        def pdf(self, ctx, si, wo, active=True):
            return dr.select(active & (si.wi.z > 0) & (wo.z > 0), self.density(si.wi, wo), 0)

        def eval_pdf(self, ctx, si, wo, active=True):
            return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

        def to_string(self):
            return f"Metal[colour={self.colour}, alpha={self.alpha}]"

    mi.register_bsdf(NAME, Metal)


def metal(colour, roughness):
    """The dictionary of a metal."""
    return {"type": NAME, **dict(zip(("red", "green", "blue"), map(float, colour))), "alpha": roughness**2}
