/* SPDX-License-Identifier: MIT
 *
 * What a light study renders: scenes, each under several suns and with several phase functions,
 * albedos and densities; by suites (scenes/studies/light.json): "tuning", which models are fitted
 * on, and "test" and "test2", which no fit sees. What is said of a model is said of these.
 */
#ifndef NEPH_HARNESS_STUDY_LIGHT_SUITES_H
#define NEPH_HARNESS_STUDY_LIGHT_SUITES_H

#include "base/arena.h"
#include "scenes/relit.h"

enum { NEPH_LIGHT_SWEEP_MAX = 8, NEPH_LIGHT_SWEEPS_MAX = 4 };

/* Every sun with every g, albedo and density. A list of none is the scene's own. */
struct neph_light_sweep {
    int sun_count, g_count, albedo_count, density_count;
    double suns_deg[NEPH_LIGHT_SWEEP_MAX][2]; /* elevation and azimuth, see scenes/relit.h */
    double g[NEPH_LIGHT_SWEEP_MAX], albedo[NEPH_LIGHT_SWEEP_MAX], density[NEPH_LIGHT_SWEEP_MAX];
};

/* A scene under one sweep after the other. */
struct neph_light_entry {
    const char *scene;  /* a name of the catalogue, or a path; borrowed */
    bool may_be_absent; /* its data need not be on this machine */
    int sweep_count;
    struct neph_light_sweep sweeps[NEPH_LIGHT_SWEEPS_MAX];
};

int neph_light_sweep_count(const struct neph_light_sweep *sweep);

/* 0 .. count - 1; the sun changes last. */
struct neph_relight neph_light_sweep_at(const struct neph_light_sweep *sweep, int index);

/* The same over all sweeps of an entry. */
int neph_light_entry_count(const struct neph_light_entry *entry);
struct neph_relight neph_light_entry_at(const struct neph_light_entry *entry, int index);

/* The entries of a suite, in `arena`. Errors as of neph_suite_find(); also NEPH_ERR_INPUT: a list
 * is not one of numbers, or too long, or there are too many sweeps. */
enum neph_status neph_light_suite_find(const char *name, struct neph_arena *arena,
                                       struct neph_light_entry **entries, int *count,
                                       struct neph_diag *diag);

#endif
