/* SPDX-License-Identifier: MIT
 *
 * The output of a function that writes to a stream, as a text or a file.
 */
#ifndef NEPH_BASE_WRITTEN_H
#define NEPH_BASE_WRITTEN_H

#include "base/status.h"

#include <stdio.h>

typedef void neph_writer(const void *what, FILE *out);

/* The output of write(what) as a text; the caller frees `*text`. NEPH_ERR_MEMORY: nothing is
 * returned. */
enum neph_status neph_write_to_text(neph_writer *write, const void *what, char **text,
                                    struct neph_diag *diag);

/* Write the text of neph_write_to_text() to a file. Also the errors of neph_file_write(). */
enum neph_status neph_write_to_file(const char *path, neph_writer *write, const void *what,
                                    struct neph_diag *diag);

#endif
