/* SPDX-License-Identifier: MIT
 *
 * The command that installs a package on this system, by its distribution.
 */
#ifndef NEPH_HARNESS_PACKAGES_H
#define NEPH_HARNESS_PACKAGES_H

#include <stddef.h>

/* Names of packages by distribution, and by those that are like it. */
struct neph_packages {
    const char *debian, *fedora, *arch;
};

/* "apt-get install blender python3-numpy" on Debian and Ubuntu, dnf on Fedora, pacman on Arch, by
 * /etc/os-release; elsewhere the names that Debian has. */
void neph_install_line(const struct neph_packages *packages, char *line, size_t size);

/* The same, with the text of an os-release file (freedesktop.org, os-release(5)). */
void neph_install_line_on(const char *os_release, const struct neph_packages *packages, char *line,
                          size_t size);

#endif
