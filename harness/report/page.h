/* SPDX-License-Identifier: MIT
 *
 * Pages that open from disk: files of scripts/report/, and data in a script beside them, as a
 * browser lets no page read a file.
 */
#ifndef NEPH_HARNESS_REPORT_PAGE_H
#define NEPH_HARNESS_REPORT_PAGE_H

#include "harness/json.h"
#include "harness/report/report_folder.h"
#include "metrics/display.h"

#include <stdbool.h>

enum { NEPH_PAGE_FILES_MAX = 6, NEPH_PAGE_FOLDERS_MAX = 4 };

/* A page beside the files that all pages share. */
struct neph_page_parts {
    const char *title;
    /* Names in scripts/report/. The first is the text for readers without scripts: page.html with
     * this text becomes index.html, which loads the other files, style sheets and scripts. */
    const char *files[NEPH_PAGE_FILES_MAX];
    const char *folders[NEPH_PAGE_FOLDERS_MAX]; /* empty ones, for what is drawn */
};

/* Make the page's files and folders in `folder`. `is_interactive`, of a page with charts, else
 * NULL: whether what makes charts interactive is installed (it comes with npm), and was copied to
 * its folder "vendor". */
enum neph_status neph_page_start(const char *folder, const struct neph_page_parts *parts,
                                 bool *is_interactive, struct neph_diag *diag);

/* Copy FROM/NAME to FOLDER/AS. */
enum neph_status neph_page_copy(const char *from, const char *name, const char *folder,
                                const char *as, struct neph_diag *diag);

/* The bytes of these files there. */
size_t neph_page_size(const char *folder, const struct neph_page_parts *parts);

/* The bytes of a file; 0: there is none. */
size_t neph_page_file_size(const char *folder, const char *name);

/* The stops of a map's colours, evenly spaced over its scale, for legends; of difference maps from
 * -scale to +scale. */
json_t *neph_page_colours(const struct neph_display_legend *legend);
json_t *neph_page_difference_colours(void);

/* The colours of values beyond the scale and of those that are no number: {"below", "above",
 * "not_a_number"}. */
json_t *neph_page_colours_beyond(const struct neph_display_legend *legend);

/* Write data.json, and data.js, which sets window.VARIABLE to the same. */
enum neph_status neph_page_write_data(const char *folder, const char *variable,
                                      const json_t *document, struct neph_diag *diag);

/* Replace the report by what was drawn so far, with that data. */
enum neph_status neph_page_publish(const struct neph_report_folder *folder, const char *variable,
                                   const json_t *document, struct neph_diag *diag);

#endif
