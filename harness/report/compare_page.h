/* SPDX-License-Identifier: MIT
 *
 * The page of `neph compare` and `neph flicker`: the verdict, numbers over time, maps, the worst
 * frames, and all numbers. Its data are described in scripts/report/README.md.
 */
#ifndef NEPH_HARNESS_REPORT_COMPARE_PAGE_H
#define NEPH_HARNESS_REPORT_COMPARE_PAGE_H

#include "harness/report/compare_shown.h"
#include "harness/report/report_folder.h"

/* Where the maps of a comparison go while it runs; the context of neph_compare_page_take(). */
struct neph_compare_maps {
    const char *folder; /* of the page; borrowed */
    enum neph_page_side side;
    struct neph_viewing viewing; /* the exposure counts */
    json_t *list;                /* of the maps of both sides; borrowed */
};

/* Draw a map of a whole sequence, if it is one of those that the page shows. */
neph_map_taker neph_compare_page_take;

/* Write the page and publish it in the folder. `told`: why charts are not drawn; "" when they are.
 * Errors as of reading and comparing frames, and of writing files. */
enum neph_status neph_compare_page_write(const struct neph_compare_page *page,
                                         const struct neph_report_folder *folder, char told[512],
                                         struct neph_diag *diag);

#endif
