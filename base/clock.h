/* SPDX-License-Identifier: MIT
 *
 * The clocks that the project reports.
 */
#ifndef NEPH_BASE_CLOCK_H
#define NEPH_BASE_CLOCK_H

/* Monotonic wall time [s] since an arbitrary start. */
double neph_wall_s(void);

/* CPU time of this process, all threads [s]. */
double neph_cpu_s(void);

/* Now, as 2026-01-31T23:59:59Z. */
void neph_utc_now(char text[32]);

#endif
