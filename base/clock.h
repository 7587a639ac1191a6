/* SPDX-License-Identifier: MIT
 *
 * Clocks for reported times.
 */
#ifndef NEPH_BASE_CLOCK_H
#define NEPH_BASE_CLOCK_H

/* Monotonic wall time [s] since an arbitrary start. */
double neph_wall_s(void);

/* CPU time of this process, all threads [s]. */
double neph_cpu_s(void);

/* The current time, as 2026-01-31T23:59:59Z. */
void neph_utc_now(char text[32]);

#endif
