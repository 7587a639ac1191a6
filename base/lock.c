/* SPDX-License-Identifier: MIT */
#include "base/lock.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* Whether a descriptor is a regular file that has not been unlinked. */
static bool is_linked(int fd)
{
    struct stat info;
    return fstat(fd, &info) == 0 && S_ISREG(info.st_mode) && info.st_nlink > 0;
}

int neph_lock_create(const char *path)
{
    const int fd = open(path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0)
        return -1;
    /* Between open and flock the file looks abandoned: a sweep may have locked or removed it. */
    const bool locked = flock(fd, LOCK_EX | LOCK_NB) == 0;
    if ((locked && is_linked(fd)) || (!locked && errno != EWOULDBLOCK))
        return fd;
    close(fd); /* the sweep that has the lock removes the file */
    errno = EEXIST;
    return -1;
}

int neph_lock_take_over(const char *path)
{
    /* Not O_RDONLY: NFS grants exclusive locks only for files open for writing. */
    const int fd = open(path, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0)
        return -1;
    if (is_linked(fd) && flock(fd, LOCK_EX | LOCK_NB) == 0 && is_linked(fd))
        return fd;
    close(fd);
    return -1;
}

enum neph_status neph_lock_wait(const char *path, int *fd, struct neph_diag *diag)
{
    const int opened = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    int failed = opened < 0 ? -1 : flock(opened, LOCK_EX);
    while (failed && opened >= 0 && errno == EINTR)
        failed = flock(opened, LOCK_EX);
    if (!failed) {
        *fd = opened;
        return NEPH_OK;
    }
    const enum neph_status status = neph_fail(diag, NEPH_ERR_IO, "cannot lock '%s': %s", path,
                                              strerror(errno));
    if (opened >= 0)
        close(opened);
    return status;
}
