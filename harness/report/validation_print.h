/* SPDX-License-Identifier: MIT
 *
 * A validation for people, on stdout.
 */
#ifndef NEPH_HARNESS_REPORT_VALIDATION_PRINT_H
#define NEPH_HARNESS_REPORT_VALIDATION_PRINT_H

#include "harness/report/validation.h"

/* A line for each frame, and what is to be said of it below. */
void neph_validation_print(const struct neph_validation *validation);

#endif
