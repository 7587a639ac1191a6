/* SPDX-License-Identifier: MIT
 *
 * A person's acceptance of a nightly run as the baseline, by `neph baseline accept` or on a page of
 * `neph serve`.
 */
#ifndef NEPH_HARNESS_NIGHT_ACCEPT_H
#define NEPH_HARNESS_NIGHT_ACCEPT_H

#include "harness/run/history.h"

enum { NEPH_ACCEPTANCE_WHO_BYTES = 256 };

struct neph_acceptance {
    const char *const *series; /* names */
    int count;                 /* 0: all series */
    int64_t night;             /* 0: the last finished run */
    const char *who;           /* NULL: the user and the machine */
    const char *why;           /* not blank */
};

struct neph_accepted {
    int64_t night;
    char who[NEPH_ACCEPTANCE_WHO_BYTES];
};

/* Accepts all series of `asked`; none when one of them cannot be accepted. (A disk that becomes
 * full in between leaves the acceptances before that.) NEPH_ERR_NOT_FOUND: there is no such run, or
 * it and the accepted runs have not measured a series. NEPH_ERR_USAGE: no reason. */
enum neph_status neph_accept(struct neph_database *index, const char *store_folder,
                             const struct neph_acceptance *asked, struct neph_accepted *accepted,
                             struct neph_diag *diag);

/* Prints on stdout that the run is the baseline of a series; "*": of all. */
void neph_accepted_print(const struct neph_accepted *accepted, const char *series);

#endif
