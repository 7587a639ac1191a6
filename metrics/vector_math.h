/* SPDX-License-Identifier: MIT */
#ifndef NEPH_METRICS_VECTOR_MATH_H
#define NEPH_METRICS_VECTOR_MATH_H
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) &&                             \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define NEPH_VECTOR __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define NEPH_VECTOR
#endif
#endif
