/* SPDX-License-Identifier: MIT
 *
 * Known mistakes that a frame is recognized by: each predicts the factors by which extinction and
 * albedo differ between the frame and the scene.
 */
#ifndef NEPH_HARNESS_FIT_MISTAKES_H
#define NEPH_HARNESS_FIT_MISTAKES_H

#include "harness/fit/problem.h"

/* A mistake explains a frame if factors within this tolerance of its own do as well as the best:
 * with the scene's asymmetry and falloff, within the same tolerance; if none does, with any. */
#define NEPH_FIT_TOLERANCE 0.03

struct neph_fit_mistake {
    const char *name, *detail; /* detail: a variant, or "" */
    double extinction, albedo; /* the factors; of a variant by albedo, for the first medium's red */
    bool is_opacity_twice;     /* scattered light is multiplied by 1 - transmittance */
    double found[2];           /* what explains the frame best within the tolerance */
    double squares;            /* sum of the squared residuals of that */
};

enum { NEPH_FIT_FOUND_MAX = 8 };

struct neph_fit_verdict {
    bool agrees;                               /* the scene's own medium explains the frame */
    bool factors_agree;                        /* its extinction and albedo do */
    bool is_asymmetry_other, is_falloff_other; /* from the scene's; false: not determined */
    int count;     /* of mistakes that explain it, if extinction or albedo do not agree */
    bool is_alone; /* they do with the scene's asymmetry and falloff */
    struct neph_fit_mistake list[NEPH_FIT_FOUND_MAX];
    const char *falloff; /* the mistake that explains the falloff's factor; NULL: none */
};

/* Compare a solved fit with the scene and with all mistakes. */
enum neph_status neph_fit_judge(struct neph_fit *fit, struct neph_fit_verdict *verdict,
                                struct neph_diag *diag);

/* Mistake `index` of the table for a medium of this albedo. False: there are fewer. */
bool neph_fit_mistake_at(int index, double albedo, struct neph_fit_mistake *mistake);

#endif
