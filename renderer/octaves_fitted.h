/* SPDX-License-Identifier: MIT
 *
 * Octaves whose factors follow from what the medium is, so that their sum is as near to all orders
 * of scattering as such a sum gets. Octave i is single scattering with sigma_s a^i, asymmetry g c^i
 * and the extinction sigma_t b^i, towards the sun and towards the eye: the sum is reciprocal, and
 * brighter where a medium is thick behind what is seen. With the view's own extinction, which
 * struct neph_octaves has, the best fit to dense parts of thick clouds is off by 18 %, and this one
 * by 13 %.
 *
 *   a = albedo / (1 + e^-f_a),  b = 1 / (1 + e^-f_b),  c = 1 / (1 + e^-f_c),
 *   f = k0 + k1 g + k2 g^2 + k3 s + k4 g s,  s = sqrt(1 - albedo),
 *
 * s because what diffuses in a medium decays with the root of what it absorbs (H. C. van de Hulst,
 * "Multiple Light Scattering", 1980, chapter 14). A look, as all sums of octaves are. The
 * coefficients are fitted to the path tracer on the tuning suite of scenes/studies/light.json
 * (`neph study light --suite tuning --fit renderer/octaves_fitted.inc`; raise the versions of the
 * engines march_octaves_fitted and realtime with them), and judged on its test suite
 * (docs/light.md).
 */
#ifndef NEPH_RENDERER_OCTAVES_FITTED_H
#define NEPH_RENDERER_OCTAVES_FITTED_H

#include "scenes/scene.h"

enum {
    NEPH_OCTAVES_FITTED_COUNT = 8, /* of octaves: as many as others have by default */
    NEPH_OCTAVES_FEATURES = 5,     /* k0 .. k4 */
};

/* What the fit has seen; beyond it g and albedo count as the nearest of these in the f's. */
#define NEPH_OCTAVES_FITTED_G_MAX 0.9
#define NEPH_OCTAVES_FITTED_ALBEDO_MIN 0.85

struct neph_octaves_fit {
    double contribution[NEPH_OCTAVES_FEATURES], attenuation[NEPH_OCTAVES_FEATURES],
        eccentricity[NEPH_OCTAVES_FEATURES];
};

/* What comes with neph. */
extern const struct neph_octaves_fit neph_octaves_fitted;

/* The octaves of a medium: mean cosine of its phase function, albedo of a channel. */
struct neph_octaves neph_octaves_of(const struct neph_octaves_fit *fit, double g, double albedo);

/* The similar medium, in which the part f = g^2 of what is scattered goes on as it came (J. H.
 * Joseph, W. J. Wiscombe, J. A. Weinman, J. Atmos. Sci. 33, 1976; the first two relations of D. R.
 * Wyman, M. S. Patterson, B. C. Wilson, Appl. Opt. 28, 1989): mean cosine of the rest, and its
 * albedo. Optical depths are 1 - f albedo of the medium's. What scatters back has no such part. */
static inline double neph_similar_peak(double g)
{
    return g > 0.0 ? g * g : 0.0;
}

static inline double neph_similar_g(double g)
{
    return g > 0.0 ? g / (1.0 + g) : g;
}

static inline double neph_similar_albedo(double albedo, double g)
{
    const double peak = neph_similar_peak(g);
    return albedo >= 1.0 ? 1.0 : albedo * (1.0 - peak) / (1.0 - albedo * peak);
}

#endif
