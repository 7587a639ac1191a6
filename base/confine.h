/* SPDX-License-Identifier: MIT
 *
 * Confine a process, and all that it starts, to one folder: it reads all that the user may read,
 * and changes files (their contents, names, modes, owners, times and attributes) in the folder
 * only. Linux lets an ordinary user do that by Landlock (since 5.13), by a user namespace with
 * read-only mounts (since 5.12) and by seccomp; a system may have some of them switched off.
 */
#ifndef NEPH_BASE_CONFINE_H
#define NEPH_BASE_CONFINE_H

/* What was reached. Outside the folder, /dev and /proc the process ... */
enum neph_confinement {
    NEPH_CONFINE_TO_FOLDER,  /* changes nothing */
    NEPH_CONFINE_NO_CHANGES, /* changes nothing; in the folder, too, calls that change modes,
                                owners, times and attributes fail with EPERM */
    NEPH_CONFINE_WRITES,     /* writes, makes, renames and removes nothing; changes modes */
    NEPH_CONFINE_NONE,       /* does as it likes */
    NEPH_CONFINE_FAILED,     /* errno says why: the process must not go on */
};

/* Confine this process to `folder`, which becomes its working folder. Files that are open stay as
 * they are. Safe between fork() and execve() in a process with one thread. */
enum neph_confinement neph_confine(const char *folder);

/* What neph_confine() reaches on this system for a folder that is there, tried in a process of its
 * own. */
enum neph_confinement neph_confine_probe(const char *folder);

#endif
