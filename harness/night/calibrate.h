/* SPDX-License-Identifier: MIT
 *
 * How fast this machine is tonight: the time of a fixed piece of work on all processors, with
 * arithmetic and memory in about the shares that a march has. Durations are compared as multiples
 * of it.
 */
#ifndef NEPH_HARNESS_NIGHT_CALIBRATE_H
#define NEPH_HARNESS_NIGHT_CALIBRATE_H

#include "base/status.h"

/* The median of five, each about a tenth of a second. NEPH_ERR_MEMORY, NEPH_ERR_INTERRUPTED. */
enum neph_status neph_calibrate(double *seconds, struct neph_diag *diag);

#endif
