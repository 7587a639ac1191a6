/* SPDX-License-Identifier: MIT
 *
 * The two clocks that the project reports.
 */
#ifndef NEPH_BASE_CLOCK_H
#define NEPH_BASE_CLOCK_H

/* Monotonic wall time [s] since an arbitrary start. */
double neph_wall_s(void);

/* CPU time of this process, all threads [s]. */
double neph_cpu_s(void);

#endif
