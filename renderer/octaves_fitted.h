/* SPDX-License-Identifier: MIT
 *
 * Octaves with factors fitted to the medium, so that their sum is as close as possible to multiple
 * scattering of all orders. Octave i is single scattering with sigma_s a^i, asymmetry g c^i and the
 * extinction sigma_t b^i, both towards the sun and towards the eye. The sum is therefore
 * reciprocal, and brighter in front of thick parts of a medium. On dense parts of thick clouds the
 * best fit has an error of 13 %; with the unscaled extinction along the view ray, as in struct
 * neph_octaves, 18 %.
 *
 *   a = albedo / (1 + e^-f_a),  b = 1 / (1 + e^-f_b),  c = 1 / (1 + e^-f_c),
 *   f = k0 + k1 g + k2 g^2 + k3 s + k4 g s,  s = sqrt(1 - albedo).
 *
 * s, because the diffusion length depends on the square root of the absorption (H. C. van de Hulst,
 * "Multiple Light Scattering", 1980, chapter 14). A non-physical model, as are all sums of octaves.
 * The coefficients are fitted to the path tracer on the tuning suite of scenes/studies/light.json
 * (`neph study light --suite tuning --fit renderer/octaves_fitted.inc`; increase the versions of
 * the engines march_octaves_fitted and realtime with them), and evaluated on its test suite
 * (docs/light.md).
 */
#ifndef NEPH_RENDERER_OCTAVES_FITTED_H
#define NEPH_RENDERER_OCTAVES_FITTED_H

#include "scenes/scene.h"

enum {
    NEPH_OCTAVES_FITTED_COUNT = 8, /* octaves, the default number of the other octave models */
    NEPH_OCTAVES_FEATURES = 5,     /* k0 .. k4 */
};

/* Range of the fit; values of g and albedo outside it are clamped in the formulas of f. */
#define NEPH_OCTAVES_FITTED_G_MAX 0.9
#define NEPH_OCTAVES_FITTED_ALBEDO_MIN 0.85

struct neph_octaves_fit {
    double contribution[NEPH_OCTAVES_FEATURES], attenuation[NEPH_OCTAVES_FEATURES],
        eccentricity[NEPH_OCTAVES_FEATURES];
};

/* The coefficients of this version of neph. */
extern const struct neph_octaves_fit neph_octaves_fitted;

/* The octaves of a medium: `g` is the mean cosine of its phase function, `albedo` of one channel.
 */
struct neph_octaves neph_octaves_compute(const struct neph_octaves_fit *fit, double g,
                                         double albedo);

/* The similar medium: the fraction f = g^2 of the scattered light counts as unscattered (J. H.
 * Joseph, W. J. Wiscombe, J. A. Weinman, J. Atmos. Sci. 33, 1976; the first two relations of D. R.
 * Wyman, M. S. Patterson, B. C. Wilson, Appl. Opt. 28, 1989). These return f, the mean cosine of
 * the remaining scattering, and its albedo. Optical depths scale by 1 - f albedo. For backward
 * scattering, g <= 0, f is 0. */
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
