/* SPDX-License-Identifier: MIT
 *
 * Paths as values, with nothing to free.
 */
#ifndef NEPH_BASE_PATH_H
#define NEPH_BASE_PATH_H

/* A path that is too long for it is too long for the system as well, which then refuses the
 * shortened one in the same way (ENAMETOOLONG). */
enum { NEPH_PATH_SIZE = 4352 };
struct neph_path {
    char text[NEPH_PATH_SIZE];
};

/* As neph_path_join(), and as neph_format() (files.h). */
struct neph_path neph_path_in(const char *folder, const char *name);
struct neph_path neph_path_format(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
