/* SPDX-License-Identifier: MIT
 *
 * Paths as values of fixed size, with nothing to free.
 */
#ifndef NEPH_BASE_PATH_H
#define NEPH_BASE_PATH_H

/* Longer than the system's limit: a path that is truncated here is still refused by the system
 * (ENAMETOOLONG). */
enum { NEPH_PATH_SIZE = 4352 };
struct neph_path {
    char text[NEPH_PATH_SIZE];
};

/* Like neph_path_join() and neph_format() (files.h). */
struct neph_path neph_path_in(const char *folder, const char *name);
struct neph_path neph_path_format(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
