/* SPDX-License-Identifier: MIT
 *
 * The water cloud of the International Polarized Radiative Transfer group (C. Emde et al.,
 * "IPRT polarized radiative transfer model intercomparison project - Phase A", JQSRT 164, 2015): a
 * layer of optical depth 5 at 800 nm, black below, its radiance in given directions against the
 * radiance I of a code. The files are a user's own: `watercloud.mie.dat` with the phase function,
 * and results in any number of `a5_*.dat`
 * or `iprt_case_A5*.dat`.
 *
 * Ours are scalar, without polarisation. By doubling, without noise; and by the oracle, with its
 * standard error.
 */
#ifndef NEPH_HARNESS_PHYSICS_IPRT_H
#define NEPH_HARNESS_PHYSICS_IPRT_H

#include "base/status.h"

#include <stdbool.h>

#define NEPH_IPRT_VARIABLE "NEPH_IPRT_DATA" /* names the folder */

/* By how much the doubling may differ, in parts of the radiance: beyond 5 degrees from the sun, and
 * within. */
#define NEPH_IPRT_FAR 0.01
#define NEPH_IPRT_NEAR 0.02
#define NEPH_IPRT_NEAR_DEG 5.0
#define NEPH_IPRT_SIGMAS 4.5 /* of the mean of oracle over doubling */

struct neph_iprt_params {
    const char *folder; /* NULL: none */
    int paths;          /* of the oracle, in each direction; 0: the default */
    bool quiet;
};

/* A direction; radiances are relative to the irradiance of the sun [1/sr]. */
struct neph_iprt_view {
    const char *file;            /* its name */
    double is_below;             /* 1: light that leaves the cloud below; 0: above */
    double sun_deg;              /* zenith angle */
    double view_deg;             /* angle of the light to the vertical, 0..90 */
    double azimuth_deg;          /* 0: in the sun's direction */
    double from_sun_deg;         /* between the line of sight and the sun */
    double theirs, theirs_error; /* NAN: not given */
    double doubling;
    double oracle, oracle_error;
    bool agrees;
};

struct neph_iprt {
    int view_count, failed;
    struct neph_iprt_view *views;
    char (*files)[64]; /* names, of the views */
    int file_count, paths;
    double oracle_over_doubling, oracle_error; /* mean over the directions, by their scatter */
    bool oracle_agrees;
    char missing[512]; /* why nothing was compared; "": it was */
};

/* Without a folder, or without directions in it, `missing` says so, and that is no error. The phase
 * function's file must be there. NEPH_ERR_INPUT: a file is damaged; the message has its line.
 * NEPH_ERR_INTERRUPTED. Free with neph_iprt_finish(). */
enum neph_status neph_iprt_run(const struct neph_iprt_params *params, struct neph_iprt *suite,
                               struct neph_diag *diag);

void neph_iprt_finish(struct neph_iprt *suite);

#endif
