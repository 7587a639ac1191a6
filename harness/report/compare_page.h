/* SPDX-License-Identifier: MIT
 *
 * The page of `neph compare` and `neph flicker`: the verdict, numbers over time, maps, the frames
 * with the largest errors, and all numbers. scripts/report/README.md describes its data.
 */
#ifndef NEPH_HARNESS_REPORT_COMPARE_PAGE_H
#define NEPH_HARNESS_REPORT_COMPARE_PAGE_H

#include "harness/report/compare_shown.h"
#include "harness/report/report_folder.h"

/* The output of a comparison's maps; the context of neph_compare_page_take(). */
struct neph_compare_maps {
    const char *folder; /* of the page; borrowed */
    enum neph_page_side side;
    struct neph_viewing viewing; /* only its exposure is used */
    json_t *list;                /* maps of both sides; borrowed */
};

/* Draw a map of a whole sequence if the page shows it. */
neph_map_taker neph_compare_page_take;

/* Write the page and publish it in the folder. `told` gets the reason when charts are not drawn,
 * else "". Errors: as for reading and comparing frames, and for writing files. */
enum neph_status neph_compare_page_write(const struct neph_compare_page *page,
                                         const struct neph_report_folder *folder, char told[512],
                                         struct neph_diag *diag);

#endif
