/* SPDX-License-Identifier: MIT
 *
 * HTML pages that open from disk: files of scripts/report/ and a script with the data, because a
 * browser does not let a local page read other files.
 */
#ifndef NEPH_HARNESS_REPORT_PAGE_H
#define NEPH_HARNESS_REPORT_PAGE_H

#include "harness/json.h"
#include "harness/report/report_folder.h"
#include "metrics/display.h"

#include <stdbool.h>

enum { NEPH_PAGE_FILES_MAX = 6, NEPH_PAGE_FOLDERS_MAX = 4 };

/* The parts of a page in addition to the files that all pages share. */
struct neph_page_parts {
    const char *title;
    /* Names in scripts/report/. The first is the text for browsers without scripts: page.html with
     * this text becomes index.html, which loads the other files, style sheets and scripts. */
    const char *files[NEPH_PAGE_FILES_MAX];
    const char *folders[NEPH_PAGE_FOLDERS_MAX]; /* empty folders for generated images */
};

/* Create the page's files and folders in `folder`. For a page with charts `*is_interactive` becomes
 * true when the chart libraries are installed (by npm), which are then copied to the folder
 * "vendor"; for other pages `is_interactive` is NULL. */
enum neph_status neph_page_start(const char *folder, const struct neph_page_parts *parts,
                                 bool *is_interactive, struct neph_diag *diag);

/* Copy FROM/NAME to FOLDER/AS. */
enum neph_status neph_page_copy(const char *from, const char *name, const char *folder,
                                const char *as, struct neph_diag *diag);

/* The total size of the page's files in the folder, in bytes. */
size_t neph_page_size(const char *folder, const struct neph_page_parts *parts);

/* The size of a file in bytes; 0: there is none. */
size_t neph_page_file_size(const char *folder, const char *name);

/* The colours of a map for a legend, evenly spaced over its scale; for difference maps from -scale
 * to +scale. */
json_t *neph_page_colours(const struct neph_display_legend *legend);
json_t *neph_page_difference_colours(void);

/* The colours of values below and above the scale and of NaN: {"below", "above",
 * "not_a_number"}. */
json_t *neph_page_colours_beyond(const struct neph_display_legend *legend);

/* Write data.json, and data.js, which assigns the same document to window.VARIABLE. */
enum neph_status neph_page_write_data(const char *folder, const char *variable,
                                      const json_t *document, struct neph_diag *diag);

/* Replace the report by the current files with this data. */
enum neph_status neph_page_publish(const struct neph_report_folder *folder, const char *variable,
                                   const json_t *document, struct neph_diag *diag);

#endif
