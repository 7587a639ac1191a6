/* SPDX-License-Identifier: MIT
 *
 * The folder of a report and its atomic replacement: generated files are kept in a private folder
 * beside the report, and each publication consists of hard links to these files.
 */
#ifndef NEPH_HARNESS_REPORT_REPORT_FOLDER_H
#define NEPH_HARNESS_REPORT_REPORT_FOLDER_H

#include "base/scratch.h"
#include "base/status.h"

#include <stdbool.h>

struct neph_report_folder;

/* `folder` as for neph_report_open(). The target of a symbolic link is replaced, not the link.
 * Removes temporary folders of killed runs. Free with neph_report_folder_close(). */
enum neph_status neph_report_folder_open(const char *folder, struct neph_report_folder **opened,
                                         struct neph_diag *diag);
void neph_report_folder_close(struct neph_report_folder *folder);

/* The folder for generated files: empty at first, removed by neph_report_folder_close(). */
const char *neph_report_folder_work(const struct neph_report_folder *folder);

/* Include a page that lies beside the report, `name`/index.html in a folder that neph owns
 * (base/owned.h): link its current files into the generated files. `*is_there` becomes false, and
 * nothing is done, when there is no such page. */
enum neph_status neph_report_folder_take(const struct neph_report_folder *folder, const char *name,
                                         bool *is_there, struct neph_diag *diag);

/* Create a new folder with all files generated so far; the caller adds the files of this
 * publication. The caller owns `*fresh` and always frees it with neph_scratch_destroy(). */
enum neph_status neph_report_folder_begin(const struct neph_report_folder *folder,
                                          struct neph_scratch **fresh, struct neph_diag *diag);

/* Exchange the new folder with the report in one step. `fresh` then contains the previous
 * report. */
enum neph_status neph_report_folder_exchange(const struct neph_report_folder *folder,
                                             const struct neph_scratch *fresh,
                                             struct neph_diag *diag);

#endif
