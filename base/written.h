/* SPDX-License-Identifier: MIT
 *
 * What is written into a stream, as a text.
 */
#ifndef NEPH_BASE_WRITTEN_H
#define NEPH_BASE_WRITTEN_H

#include "base/status.h"

#include <stdio.h>

typedef void neph_writer(const void *what, FILE *out);

/* What `write` says of `what`; `*text` is for the caller to free. NEPH_ERR_MEMORY: it did not fit,
 * and none of it is kept. */
enum neph_status neph_written(neph_writer *write, const void *what, char **text,
                              struct neph_diag *diag);

/* Write what neph_written() would give to a file; errors of neph_file_write(), too. */
enum neph_status neph_written_file(const char *path, neph_writer *write, const void *what,
                                   struct neph_diag *diag);

#endif
