// SPDX-License-Identifier: MIT
//
// The Henyey-Greenstein phase function: float32 version of scenes/phase_henyey_greenstein.c.

// Value (L. G. Henyey and J. L. Greenstein, 1941):
//
//   p = (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2))
//
// The denominator cancels near the peak and is computed as
//
//   1 + g^2 - 2 g cos = (1 - |g|)^2 + 2 |g| (1 - |cos|)
//   1 - a.b = |a - b|^2 / 2                                  for unit vectors
//
// A dot product of float32 vectors is accurate to 6e-8 only, which at g = 0.99 would be 0.2 % of
// the peak. The difference a - b keeps all its digits.
float henyey_greenstein_per_sr(float g, vec3 view, vec3 sun)
{
    vec3 off_peak = g >= 0.0 ? view - sun : view + sun;
    float a = abs(g);
    float base = (1.0 - a) * (1.0 - a) + a * dot(off_peak, off_peak);
    return (1.0 - a) * (1.0 + a) / (4.0 * PI * base * sqrt(base));
}

// Sampling: 1 - cos from the inverse of the cumulative distribution,
//
//   cos = (1 + g^2 - s^2) / 2g,    s = (1 - g^2) / (1 - g + 2 g u)
//
// as a product without cancellation, for any g in [0, 1).
float henyey_greenstein_versine(float g, float u)
{
    float low = 1.0 - g;
    float divisor = low + 2.0 * g * u;
    float s = low * (1.0 + g) / divisor;
    return low * (1.0 - u) * (s + low) / divisor;
}
