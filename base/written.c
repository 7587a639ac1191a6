/* SPDX-License-Identifier: MIT */
#include "base/written.h"

#include "base/files.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum neph_status neph_write_to_text(neph_writer *write, const void *what, char **text,
                                    struct neph_diag *diag)
{
    char *made = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&made, &size);
    if (!out)
        return neph_fail_memory(diag);
    write(what, out);
    const bool cut = ferror(out) != 0, closed = fclose(out) == 0;
    if (cut || !closed) {
        free(made);
        return neph_fail_memory(diag);
    }
    *text = made;
    return NEPH_OK;
}

enum neph_status neph_write_to_file(const char *path, neph_writer *write, const void *what,
                                    struct neph_diag *diag)
{
    char *text = NULL;
    enum neph_status status = neph_write_to_text(write, what, &text, diag);
    if (!status)
        status = neph_file_write(path, text, strlen(text), diag);
    free(text);
    return status;
}
