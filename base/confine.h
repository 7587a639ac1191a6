/* SPDX-License-Identifier: MIT
 *
 * Confine a process and its descendants to one folder. They can read all files that the user can
 * read. They can change files (contents, names, modes, owners, times and attributes) only in the
 * folder. Linux offers this to ordinary users by Landlock (since 5.13), by a user namespace with
 * read-only mounts (since 5.12) and by seccomp; a system may have some of them switched off.
 */
#ifndef NEPH_BASE_CONFINE_H
#define NEPH_BASE_CONFINE_H

/* The confinement reached. Outside the folder, /dev and /proc the process ... */
enum neph_confinement {
    NEPH_CONFINE_TO_FOLDER,  /* changes nothing */
    NEPH_CONFINE_NO_CHANGES, /* changes nothing; even inside the folder, calls that change modes,
                                owners, times and attributes fail with EPERM */
    NEPH_CONFINE_WRITES,     /* cannot write, create, rename or remove; can change modes */
    NEPH_CONFINE_NONE,       /* is not confined */
    NEPH_CONFINE_FAILED,     /* errno has the reason: the process must not continue */
};

/* Confine this process to `folder`, which becomes its working folder. Open files stay usable. Safe
 * between fork() and execve() in a process with one thread. */
enum neph_confinement neph_confine(const char *folder);

/* The confinement that neph_confine() reaches on this system for an existing folder, found out in a
 * child process. */
enum neph_confinement neph_confine_probe(const char *folder);

#endif
