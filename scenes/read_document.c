/* SPDX-License-Identifier: MIT
 *
 * Reads a whole file by its table of keys, and reports all of its errors.
 */
#include "scenes/errors.h"
#include "scenes/fields.h"

#include <stdlib.h>

enum neph_status neph_read_document(struct neph_document *document, struct neph_arena *arena,
                                    const struct neph_field *fields, neph_document_check *check,
                                    void *target, struct neph_diag *diag)
{
    struct neph_errors *errors = calloc(1, sizeof(*errors));
    if (!errors)
        return neph_fail_memory(diag);
    errors->file = document->file;
    struct neph_reader reader = {
        .document = document, .arena = arena, .diag = &errors->now, .errors = errors};
    enum neph_status status = neph_read_fields(&reader, neph_document_root(document), fields,
                                               target);
    status = neph_keep_error(&reader, NEPH_OK, status);
    status = neph_keep_error(&reader, status, check(&reader, status, target));
    if (status)
        status = neph_errors_report(errors, diag);
    free(errors);
    return status;
}
