/* SPDX-License-Identifier: MIT
 *
 * Attribution of a disagreement: which engines differ in a scene, and whether exactly one differs
 * from all others. All pairs of rendered frames are compared with their noise removed
 * (metrics/pair.h), at a significance level corrected for the number of pairs (Sidak).
 */
#ifndef NEPH_HARNESS_REPORT_ATTRIBUTION_H
#define NEPH_HARNESS_REPORT_ATTRIBUTION_H

#include "base/arena.h"
#include "harness/json.h"
#include "metrics/pair.h"

/* The probability of a false difference when all engines agree. It applies to the pairs without a
 * real-time method, and separately to the pairs with one. */
#define NEPH_ATTRIBUTION_FAMILY_ALPHA 0.01

/* An engine in the comparison: a frame, and a frame with a second seed (NULL: deterministic). */
struct neph_peer {
    const char *name, *path, *second_path;
    bool is_shortcut; /* real-time method; its pairs have a correction of their own */
};

struct neph_peer_pair {
    const char *first, *second;
    struct neph_pair found;
};

/* Names are borrowed from the peers. */
struct neph_attribution {
    char mask[NEPH_IMAGE_NAME_MAX];
    size_t pixel_count;
    int pair_count;
    struct neph_peer_pair *pairs;
    const char *odd_one_out; /* NULL: none */
    char sentence[400];
};

/* Compare all pairs of peers. `*attribution`, allocated in the arena, is NULL for fewer than three
 * peers and for frames without pixels to compare. The mask is "medium" of the first frame with a
 * transmittance, otherwise "all". */
enum neph_status neph_attribute(const struct neph_peer *peers, int count, struct neph_arena *arena,
                                const struct neph_attribution **attribution,
                                struct neph_diag *diag);

/* The "attribution" of scripts/report/README.md; JSON null for NULL. */
json_t *neph_attribution_json(const struct neph_attribution *attribution);

/* The decision rule by itself, for tests. `verdicts[i * count + j]` is a verdict of metrics/pair.h
 * and symmetric. Returns the index of the only engine that differs from all others, or -1;
 * `sentence` (at most 400 characters) gives the reason. */
int neph_odd_one_out(const char *const *names, int count, const int *verdicts, char sentence[400]);

#endif
