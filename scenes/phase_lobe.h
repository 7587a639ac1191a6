/* SPDX-License-Identifier: MIT
 *
 * One lobe of B. T. Draine, "Scattering by Interstellar Dust Grains. I. Optical and Ultraviolet",
 * ApJ 598, 2003, equation 5: Henyey-Greenstein's times (1 + alpha cos^2), normalised. With alpha 0
 * it is L. G. Henyey and J. L. Greenstein's, "Diffuse Radiation in the Galaxy", ApJ 93, 1941, and
 * with alpha 1 that of W. M. Cornette and J. G. Shanks, "Physically reasonable analytic expression
 * for the single-scattering phase function", Appl. Opt. 31, 1992. Private to scenes/.
 */
#ifndef NEPH_SCENES_PHASE_LOBE_H
#define NEPH_SCENES_PHASE_LOBE_H

struct neph_lobe {
    double g, alpha; /* -0.999..0.999; >= 0 */
};

double neph_lobe_per_sr(struct neph_lobe lobe, double cosine);
/* The light scattered within versine v of straight ahead, 0..1. */
double neph_lobe_within(struct neph_lobe lobe, double v);
double neph_lobe_mean_cosine(struct neph_lobe lobe);
double neph_lobe_moment(struct neph_lobe lobe, int degree); /* >= 0 */

/* Two lobes; the share of the first one's light is in 0..1. */
struct neph_lobe_pair {
    struct neph_lobe first, second;
    double first_share;
};

double neph_lobe_pair_per_sr(const struct neph_lobe_pair *pair, double cosine);
double neph_lobe_pair_within(const struct neph_lobe_pair *pair, double v);
double neph_lobe_pair_moment(const struct neph_lobe_pair *pair, int degree); /* >= 0 */

#endif
