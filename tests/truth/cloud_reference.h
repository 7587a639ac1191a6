/* SPDX-License-Identifier: MIT
 *
 * Written by cloud_reference.py (mpmath). Do not edit.
 */
#ifndef NEPH_TESTS_TRUTH_CLOUD_REFERENCE_H
#define NEPH_TESTS_TRUTH_CLOUD_REFERENCE_H

static const double reference_gaussian = 0.042898134063636507;
static const double reference_dense_gaussian = 0.037608519748174883;
static const double reference_shell = 0.058041081154654521;
static const double reference_one_node = 0.040683967182688835;

#endif
