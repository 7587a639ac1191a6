/* SPDX-License-Identifier: MIT
 *
 * The HTML page of a nightly run: the verdict; each change with the images of the baseline and of
 * this run, the number and its course over the runs; then the numbers of every scene. The page
 * opens from disk without a network and is updated after each step. scripts/report/README.md
 * describes its data.
 */
#ifndef NEPH_HARNESS_NIGHT_PAGE_H
#define NEPH_HARNESS_NIGHT_PAGE_H

#include "harness/night/night.h"

struct neph_night_page;

/* Prepare the page OUTPUT/nightly/report. Its images take at most `limit_bytes` together: images of
 * changes come first, and the page says how many images are left out. Output, tier and store are
 * borrowed. Free with neph_night_page_close(). */
enum neph_status neph_night_page_open(const char *output, const char *tier,
                                      struct neph_store *store, size_t limit_bytes,
                                      struct neph_night_page **page, struct neph_diag *diag);
void neph_night_page_close(struct neph_night_page *page);

/* Write the current state of the run into the page. A value for neph_night_params.show, with the
 * page as its context. */
enum neph_status neph_night_page_publish(const struct neph_night *night, void *page,
                                         struct neph_diag *diag);

#endif
