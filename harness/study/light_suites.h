/* SPDX-License-Identifier: MIT
 *
 * The suites of light studies (scenes/studies/light.json): scenes under several suns, with several
 * phase functions, albedos and densities. Models are fitted to "tuning"; "test" and "test2" are
 * used in no fit, and published errors are theirs.
 */
#ifndef NEPH_HARNESS_STUDY_LIGHT_SUITES_H
#define NEPH_HARNESS_STUDY_LIGHT_SUITES_H

#include "base/arena.h"
#include "scenes/relit.h"

enum { NEPH_LIGHT_SWEEP_MAX = 8, NEPH_LIGHT_SWEEPS_MAX = 4 };

/* Every sun with every g, albedo and density. An empty list: the scene's own value. */
struct neph_light_sweep {
    int sun_count, g_count, albedo_count, density_count;
    double suns_deg[NEPH_LIGHT_SWEEP_MAX][2]; /* elevation and azimuth, see scenes/relit.h */
    double g[NEPH_LIGHT_SWEEP_MAX], albedo[NEPH_LIGHT_SWEEP_MAX], density[NEPH_LIGHT_SWEEP_MAX];
};

/* A scene with a list of sweeps. */
struct neph_light_entry {
    const char *scene;  /* name in the catalogue, or path; borrowed */
    bool may_be_absent; /* the scene's data may be missing on this machine */
    int sweep_count;
    struct neph_light_sweep sweeps[NEPH_LIGHT_SWEEPS_MAX];
};

/* Number of combinations of a sweep. */
int neph_light_sweep_count(const struct neph_light_sweep *sweep);

/* `index`: 0 .. count - 1; the sun changes slowest. */
struct neph_relight neph_light_sweep_at(const struct neph_light_sweep *sweep, int index);

/* The same over all sweeps of an entry. */
int neph_light_entry_count(const struct neph_light_entry *entry);
struct neph_relight neph_light_entry_at(const struct neph_light_entry *entry, int index);

/* The entries of a suite, in `arena`. Errors as of neph_suite_find(); NEPH_ERR_INPUT also for a
 * list of other than numbers, a list that is too long, and too many sweeps. */
enum neph_status neph_light_suite_find(const char *name, struct neph_arena *arena,
                                       struct neph_light_entry **entries, int *count,
                                       struct neph_diag *diag);

#endif
