/* SPDX-License-Identifier: MIT
 *
 * Sorting of numbers.
 */
#ifndef NEPH_BASE_SORT_H
#define NEPH_BASE_SORT_H

#include <stddef.h>

/* In ascending order. A NaN leaves the order undefined. */
void neph_sort_doubles(double *values, size_t count);

#endif
