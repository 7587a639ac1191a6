/* SPDX-License-Identifier: MIT */
#include "base/confine.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/landlock.h>
#include <stdint.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

/* Since the second and the third version of the interface; headers of Debian 12 lack the latter. */
static const uint64_t refer = LANDLOCK_ACCESS_FS_REFER, truncation = (uint64_t)1 << 14;

static const uint64_t writing = LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR |
                                LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_CHAR |
                                LANDLOCK_ACCESS_FS_MAKE_DIR | LANDLOCK_ACCESS_FS_MAKE_REG |
                                LANDLOCK_ACCESS_FS_MAKE_SOCK | LANDLOCK_ACCESS_FS_MAKE_FIFO |
                                LANDLOCK_ACCESS_FS_MAKE_BLOCK | LANDLOCK_ACCESS_FS_MAKE_SYM;

/* What is no file of anybody's: devices, among them GPUs and shared memory, and what a process says
 * of itself. */
static const char *const nobodys[] = {"/dev", "/proc"};

/* The version of the interface; 0 or less: there is none. */
static long version(void)
{
    return syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION);
}

bool neph_confine_is_there(void)
{
    return version() > 0;
}

static bool allow(int rules_fd, const char *folder, uint64_t access)
{
    const int fd = open(folder, O_PATH | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0)
        return false;
    const struct landlock_path_beneath_attr beneath = {.allowed_access = access, .parent_fd = fd};
    const bool is_allowed = syscall(SYS_landlock_add_rule, rules_fd, LANDLOCK_RULE_PATH_BENEATH,
                                    &beneath, 0) == 0;
    close(fd);
    return is_allowed;
}

bool neph_confine_writes(const char *folder)
{
    const long known = version();
    if (known <= 0)
        return true;
    const struct landlock_ruleset_attr handled = {
        .handled_access_fs = writing | (known >= 2 ? refer : 0) | (known >= 3 ? truncation : 0)};
    const int rules_fd = (int)syscall(SYS_landlock_create_ruleset, &handled, sizeof(handled), 0);
    if (rules_fd < 0)
        return false;
    bool is_done = allow(rules_fd, folder, handled.handled_access_fs);
    for (size_t i = 0; i < sizeof(nobodys) / sizeof(nobodys[0]) && is_done; i++)
        is_done = allow(rules_fd, nobodys[i], handled.handled_access_fs) || errno == ENOENT;
    is_done = is_done && prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
              syscall(SYS_landlock_restrict_self, rules_fd, 0) == 0;
    close(rules_fd);
    return is_done;
}
