/* SPDX-License-Identifier: MIT
 *
 * Where a report lies, and how it is replaced as a whole: what is drawn is kept in a folder of our
 * own beside it, of which each publication gets links.
 */
#ifndef NEPH_HARNESS_REPORT_REPORT_FOLDER_H
#define NEPH_HARNESS_REPORT_REPORT_FOLDER_H

#include "base/scratch.h"
#include "base/status.h"

#include <stdbool.h>

struct neph_report_folder;

/* `folder` as of neph_report_open(); if it is a symbolic link, what it points to is replaced. What
 * killed runs left beside it is removed. Free with _close. */
enum neph_status neph_report_folder_open(const char *folder, struct neph_report_folder **opened,
                                         struct neph_diag *diag);
void neph_report_folder_close(struct neph_report_folder *folder);

/* The folder to draw into: empty at first, and removed at the end. */
const char *neph_report_folder_work(const struct neph_report_folder *folder);

/* A page of its own that lies beside the report, `name`/index.html in a folder that neph owns
 * (base/owned.h): all that is in it becomes part of what is drawn, as it is now. `*is_there`:
 * false, and nothing is done, where there is none. */
enum neph_status neph_report_folder_take(const struct neph_report_folder *folder, const char *name,
                                         bool *is_there, struct neph_diag *diag);

/* A fresh folder with all that was drawn so far, for what is of this publication alone to be added.
 * `*fresh` is the caller's, who ends it with neph_scratch_destroy() in any case. */
enum neph_status neph_report_folder_begin(const struct neph_report_folder *folder,
                                          struct neph_scratch **fresh, struct neph_diag *diag);

/* Exchange it with the report in one step. `fresh` then holds what was there before. */
enum neph_status neph_report_folder_exchange(const struct neph_report_folder *folder,
                                             const struct neph_scratch *fresh,
                                             struct neph_diag *diag);

#endif
