/* SPDX-License-Identifier: MIT
 *
 * The page of `neph compare --page` and `neph flicker --page`: its folder, and the maps that are
 * drawn while frames are measured.
 */
#ifndef NEPH_HARNESS_CLI_COMPARE_PAGE_H
#define NEPH_HARNESS_CLI_COMPARE_PAGE_H

#include "harness/compare/verdict.h"
#include "harness/report/compare_page.h"

/* Start from {0}. */
struct neph_cli_page {
    struct neph_report_folder *folder; /* owned; NULL: no page */
    const char *place;                 /* borrowed */
    json_t *maps;                      /* owned */
    struct neph_compare_maps takers[NEPH_PAGE_SIDES];
};

/* Open the folder before the measurement starts; with `place` NULL nothing happens. Errors of
 * neph_report_folder_open(). */
enum neph_status neph_cli_page_begin(const char *place, struct neph_cli_page *page,
                                     struct neph_diag *diag);

/* Make a comparison of a sequence draw its maps for the page. The page must outlive the
 * comparison. */
void neph_cli_page_add_comparison(struct neph_cli_page *page, enum neph_page_side side,
                                  struct neph_comparison *comparison);

/* Write the page of the results, and print its place on stderr. `beside`: results of the other
 * test, or NULL. */
enum neph_status neph_cli_page_write(struct neph_cli_page *page, const char *verb,
                                     const struct neph_verdict_form *form,
                                     const struct neph_compared *compared,
                                     const struct neph_compared *beside, struct neph_diag *diag);

void neph_cli_page_end(struct neph_cli_page *page);

#endif
