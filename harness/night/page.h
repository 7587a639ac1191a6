/* SPDX-License-Identifier: MIT
 *
 * The page of a night: the verdict, what changed with the pictures of both nights, its number and
 * its course over the nights, then the numbers of every scene. It opens from disk without a network
 * and grows with the night. Its data are described in scripts/report/README.md.
 */
#ifndef NEPH_HARNESS_NIGHT_PAGE_H
#define NEPH_HARNESS_NIGHT_PAGE_H

#include "harness/night/night.h"

struct neph_night_page;

/* Prepare the page OUTPUT/nightly/report. Its pictures are not to take more than `limit_bytes`
 * together: those of what changed come first, and the page says how many are left out. The store is
 * borrowed. Free with _close. */
enum neph_status neph_night_page_open(const char *output, const char *tier,
                                      struct neph_store *store, size_t limit_bytes,
                                      struct neph_night_page **page, struct neph_diag *diag);
void neph_night_page_close(struct neph_night_page *page);

/* Put the night as it is into the page: neph_night_params.show, with the page as its context. */
enum neph_status neph_night_page_publish(const struct neph_night *night, void *page,
                                         struct neph_diag *diag);

#endif
