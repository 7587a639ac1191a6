/* SPDX-License-Identifier: MIT
 *
 * Who disagrees with whom in a scene, and which engine is the odd one out: all pairs of rendered
 * frames held against each other with their noise taken out (metrics/pair.h), at a level corrected
 * for the number of pairs (Sidak).
 */
#ifndef NEPH_HARNESS_REPORT_ATTRIBUTION_H
#define NEPH_HARNESS_REPORT_ATTRIBUTION_H

#include "base/arena.h"
#include "harness/json.h"
#include "metrics/pair.h"

/* The probability that engines that all agree are told apart: in the pairs without a shortcut, and
 * once more in those with one. */
#define NEPH_ATTRIBUTION_FAMILY_ALPHA 0.01

/* An engine that is compared with the others: a frame, and one of a second seed (NULL: nothing is
 * random). */
struct neph_peer {
    const char *name, *path, *second_path;
    bool is_shortcut; /* it renders the model of another engine; its pairs are a family */
};

struct neph_peer_pair {
    const char *first, *second;
    struct neph_pair found;
};

/* Names are the peers'. */
struct neph_attribution {
    char mask[NEPH_IMAGE_NAME_MAX];
    size_t pixel_count;
    int pair_count;
    struct neph_peer_pair *pairs;
    const char *odd_one_out; /* NULL: nobody is */
    char sentence[400];
};

/* `*attribution`, made in the arena, is NULL when there are fewer than three peers or nothing to
 * compare. The mask is "medium" of the first frame that has a transmittance, else "all". */
enum neph_status neph_attribute(const struct neph_peer *peers, int count, struct neph_arena *arena,
                                const struct neph_attribution **attribution,
                                struct neph_diag *diag);

/* The "attribution" of scripts/report/README.md; JSON null of NULL. */
json_t *neph_attribution_json(const struct neph_attribution *attribution);

/* The rule alone, for tests: `verdicts[i * count + j]` of metrics/pair.h, symmetric. The index of
 * the odd one out, or -1; `*sentence` (at most 400 characters) says why, in words. */
int neph_odd_one_out(const char *const *names, int count, const int *verdicts, char sentence[400]);

#endif
