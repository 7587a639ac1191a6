/* SPDX-License-Identifier: MIT
 *
 * A validation as data.json: the form is written down in scripts/report/README.md.
 */
#ifndef NEPH_HARNESS_REPORT_VALIDATION_JSON_H
#define NEPH_HARNESS_REPORT_VALIDATION_JSON_H

#include "harness/report/validation.h"

/* NULL when memory is short or a text is not UTF-8. */
json_t *neph_validation_json(const struct neph_validation *validation);

#endif
