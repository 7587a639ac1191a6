/* SPDX-License-Identifier: MIT
 *
 * Pages that open from disk: files of scripts/report/, and data in a script beside them, as a
 * browser lets no page read a file.
 */
#ifndef NEPH_HARNESS_REPORT_PAGE_H
#define NEPH_HARNESS_REPORT_PAGE_H

#include "harness/json.h"
#include "harness/report/report_folder.h"

#include <stdbool.h>

struct neph_page_file {
    const char *from, *to; /* in scripts/report/; in the page's folder */
};

/* What makes charts interactive; comes with npm, and pages do without. Ends with a NULL. */
extern const struct neph_page_file neph_page_vendored[];

/* Whether all of that is installed. */
bool neph_page_vendor_is_installed(void);

/* Copy a list that ends with a NULL. */
enum neph_status neph_page_copy(const char *folder, const struct neph_page_file *files,
                                struct neph_diag *diag);

/* Write data.json, and data.js, which sets window.VARIABLE to the same. */
enum neph_status neph_page_write_data(const char *folder, const char *variable,
                                      const json_t *document, struct neph_diag *diag);

/* Replace the report by what was drawn so far, with that data. */
enum neph_status neph_page_publish(const struct neph_report_folder *folder, const char *variable,
                                   const json_t *document, struct neph_diag *diag);

#endif
