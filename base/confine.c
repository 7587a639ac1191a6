/* SPDX-License-Identifier: MIT
 *
 * Confinement of a child process to one folder, by three mechanisms that an ordinary user can use:
 *
 * - Landlock refuses to write, create, rename and remove files. It does not cover changes of modes,
 *   owners, times and attributes.
 * - A mount namespace in which all file systems except the folder, /dev and /proc are read-only
 *   refuses both. Some systems do not let users create one (in containers, or by AppArmor).
 * - Without that namespace a seccomp filter refuses every change of modes, owners, times and
 *   attributes, inside the folder as well: it cannot distinguish paths.
 */
#include "base/confine.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

/* Folders that stay writable: devices (GPUs, shared memory), and the process's own settings. */
static const char *const writable[] = {"/dev", "/proc"};
enum { WRITABLE_COUNT = sizeof(writable) / sizeof(writable[0]) };

/* ---- Landlock -------------------------------------------------------------------------------- */

/* Added in versions 2 and 3 of the interface; headers of Debian 12 lack the latter. */
static const uint64_t refer = LANDLOCK_ACCESS_FS_REFER, truncation = (uint64_t)1 << 14;

static const uint64_t writing = LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR |
                                LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_CHAR |
                                LANDLOCK_ACCESS_FS_MAKE_DIR | LANDLOCK_ACCESS_FS_MAKE_REG |
                                LANDLOCK_ACCESS_FS_MAKE_SOCK | LANDLOCK_ACCESS_FS_MAKE_FIFO |
                                LANDLOCK_ACCESS_FS_MAKE_BLOCK | LANDLOCK_ACCESS_FS_MAKE_SYM;

/* The version of the Landlock interface; 0 or less: not available. */
static long landlock_version(void)
{
    return syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION);
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

static bool refuse_writes(long version)
{
    const struct landlock_ruleset_attr handled = {
        .handled_access_fs = writing | (version >= 2 ? refer : 0) |
                             (version >= 3 ? truncation : 0)};
    const int rules_fd = (int)syscall(SYS_landlock_create_ruleset, &handled, sizeof(handled), 0);
    if (rules_fd < 0)
        return false;
    bool is_done = allow(rules_fd, ".", handled.handled_access_fs);
    for (int i = 0; i < WRITABLE_COUNT && is_done; i++)
        is_done = allow(rules_fd, writable[i], handled.handled_access_fs) || errno == ENOENT;
    is_done = is_done && syscall(SYS_landlock_restrict_self, rules_fd, 0) == 0;
    close(rules_fd);
    return is_done;
}

/* ---- read-only mounts ------------------------------------------------------------------------ */

static bool write_text(const char *path, const char *text)
{
    const int fd = open(path, O_WRONLY | O_CLOEXEC);
    const ssize_t length = (ssize_t)strlen(text);
    const bool is_written = fd >= 0 && write(fd, text, (size_t)length) == length;
    if (fd >= 0)
        close(fd);
    return is_written;
}

/* "ID ID 1": the user (or group) has the same number inside the namespace. */
static void name_map(unsigned id, char text[32])
{
    char digits[12];
    int count = 0;
    do
        digits[count++] = (char)('0' + id % 10);
    while ((id /= 10) > 0);
    char *at = text;
    for (int round = 0; round < 2; round++) {
        for (int i = count - 1; i >= 0; i--)
            *at++ = digits[i];
        *at++ = ' ';
    }
    at[0] = '1';
    at[1] = '\0';
}

static bool enter_user_namespace(void)
{
    char users[32], groups[32];
    name_map(geteuid(), users);
    name_map(getegid(), groups);
    return unshare(CLONE_NEWUSER | CLONE_NEWNS) == 0 &&
           write_text("/proc/self/setgroups", "deny") && write_text("/proc/self/uid_map", users) &&
           write_text("/proc/self/gid_map", groups);
}

/* Some systems let a process enter a user namespace and then refuse the user map, and the process
 * cannot leave again. So a child process tries it first. */
static bool can_enter_user_namespace(void)
{
    const pid_t pid = fork();
    if (pid == 0)
        _exit(enter_user_namespace() ? 0 : 1);
    int wait_status = 1;
    while (pid > 0 && waitpid(pid, &wait_status, 0) < 0 && errno == EINTR)
        continue;
    return pid > 0 && wait_status == 0;
}

/* Without privileges a mount namespace needs a user namespace, in which the user keeps all rights
 * to files. Root uses none: inside it root could not read other users' files. */
static bool enter_namespaces(void)
{
    return unshare(CLONE_NEWNS) == 0 || (can_enter_user_namespace() && enter_user_namespace());
}

static int copy_mount(const char *folder)
{
    return open_tree(AT_FDCWD, folder, OPEN_TREE_CLONE | OPEN_TREE_CLOEXEC | AT_RECURSIVE);
}

static bool put_mount(int fd, const char *folder)
{
    return fd < 0 || move_mount(fd, "", AT_FDCWD, folder, MOVE_MOUNT_F_EMPTY_PATH) == 0;
}

enum view { VIEW_NONE, VIEW_DONE, VIEW_BROKEN };

/* Make all files read-only for this process except those below the working folder and `writable`.
 * VIEW_NONE: this system does not permit it, and file access is unchanged. */
static enum view make_view(void)
{
    struct mount_attr own = {.propagation = MS_PRIVATE}, plain = {.attr_set = MOUNT_ATTR_RDONLY};
    int folder_fd = -1, fds[WRITABLE_COUNT];
    enum view view = VIEW_NONE;
    memset(fds, -1, sizeof(fds));
    bool is_possible = enter_namespaces() &&
                       mount_setattr(AT_FDCWD, "/", AT_RECURSIVE, &own, sizeof(own)) == 0 &&
                       (folder_fd = copy_mount(".")) >= 0;
    for (int i = 0; i < WRITABLE_COUNT && is_possible; i++) {
        fds[i] = copy_mount(writable[i]);
        is_possible = fds[i] >= 0 || errno == ENOENT;
    }
    if (is_possible && mount_setattr(AT_FDCWD, "/", AT_RECURSIVE, &plain, sizeof(plain)) == 0) {
        /* The working folder is inside the read-only mount: enter it again through its writable
         * copy. */
        bool is_done = put_mount(folder_fd, ".") && fchdir(folder_fd) == 0;
        for (int i = 0; i < WRITABLE_COUNT && is_done; i++)
            is_done = put_mount(fds[i], writable[i]);
        view = is_done ? VIEW_DONE : VIEW_BROKEN;
    }
    const int error = errno;
    for (int i = 0; i < WRITABLE_COUNT; i++)
        if (fds[i] >= 0)
            close(fds[i]);
    if (folder_fd >= 0)
        close(folder_fd);
    errno = error;
    return view;
}

/* ---- seccomp --------------------------------------------------------------------------------- */

#if defined(__x86_64__)
#define NATIVE_ARCH AUDIT_ARCH_X86_64
#elif defined(__aarch64__)
#define NATIVE_ARCH AUDIT_ARCH_AARCH64
#elif defined(__riscv) && __riscv_xlen == 64
#define NATIVE_ARCH AUDIT_ARCH_RISCV64
#endif

#ifdef NATIVE_ARCH

/* The same number on all architectures; headers of Debian 12 lack them. */
enum {
    CALL_FCHMODAT2 = 452,
    CALL_SETXATTRAT = 463,
    CALL_REMOVEXATTRAT = 466,
    CALL_FILE_SETATTR = 469,
};

static const uint32_t changes_of_files[] = {
#ifdef SYS_chmod
    SYS_chmod,          SYS_chown,        SYS_lchown,       SYS_utime,          SYS_utimes,
    SYS_futimesat,
#endif
    SYS_fchmod,         SYS_fchmodat,     CALL_FCHMODAT2,   SYS_fchown,         SYS_fchownat,
    SYS_utimensat,      SYS_setxattr,     SYS_lsetxattr,    SYS_fsetxattr,      CALL_SETXATTRAT,
    SYS_removexattr,    SYS_lremovexattr, SYS_fremovexattr, CALL_REMOVEXATTRAT, CALL_FILE_SETATTR,
    SYS_io_uring_setup, /* can change attributes in spite of this filter */
};
enum {
    CHANGE_COUNT = sizeof(changes_of_files) / sizeof(changes_of_files[0]),
    FIRST_FOREIGN_CALL = 0x40000000, /* x32's on x86-64 */
};

/* FS_IOC_SETFLAGS, FS_IOC32_SETFLAGS and FS_IOC_FSSETXATTR of <linux/fs.h>, which cannot be
 * included beside <sys/mount.h> (glibc 2.36). */
static const uint32_t changes_by_ioctl[] = {_IOW('f', 2, long), _IOW('f', 2, int), 0x401c5820};
enum {
    IOCTL_COUNT = sizeof(changes_by_ioctl) / sizeof(changes_by_ioctl[0]),
    STATEMENTS_MAX = 2 * (CHANGE_COUNT + IOCTL_COUNT) + 16,
};

struct filter {
    struct sock_filter statements[STATEMENTS_MAX];
    unsigned short count;
};

/* Load the word of struct seccomp_data at `offset` for the following tests. */
static void load(struct filter *filter, size_t offset)
{
    filter->statements[filter->count++] = (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS,
                                                                       (uint32_t)offset);
}

static void finish_with(struct filter *filter, uint32_t action)
{
    filter->statements[filter->count++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, action);
}

/* Return `action` unless the test of the loaded word is true (`is_passed` 1) or false (0). */
static void finish_unless(struct filter *filter, int is_passed, uint16_t test, uint32_t number,
                          uint32_t action)
{
    filter->statements[filter->count++] = (struct sock_filter)BPF_JUMP(
        BPF_JMP | test | BPF_K, number, (uint8_t)is_passed, (uint8_t)!is_passed);
    finish_with(filter, action);
}

/* Refuse with EPERM the calls above and all calls of other architectures, whose call numbers
 * differ. */
static bool refuse_changes(void)
{
    static const uint32_t refuse = SECCOMP_RET_ERRNO | EPERM, permit = SECCOMP_RET_ALLOW;
    struct filter filter = {.count = 0};
    load(&filter, offsetof(struct seccomp_data, arch));
    finish_unless(&filter, 1, BPF_JEQ, NATIVE_ARCH, refuse);
    load(&filter, offsetof(struct seccomp_data, nr));
    finish_unless(&filter, 0, BPF_JGE, FIRST_FOREIGN_CALL, refuse);
    for (size_t i = 0; i < CHANGE_COUNT; i++)
        finish_unless(&filter, 0, BPF_JEQ, changes_of_files[i], refuse);
    finish_unless(&filter, 1, BPF_JEQ, SYS_ioctl, permit);
    load(&filter, offsetof(struct seccomp_data, args[1]));
    for (size_t i = 0; i < IOCTL_COUNT; i++)
        finish_unless(&filter, 0, BPF_JEQ, changes_by_ioctl[i], refuse);
    finish_with(&filter, permit);
    const struct sock_fprog program = {.len = filter.count, .filter = filter.statements};
    return prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program, 0, 0) == 0;
}

#else

static bool refuse_changes(void)
{
    return false;
}

#endif

/* ---- entry points ---------------------------------------------------------------------------- */

enum neph_confinement neph_confine(const char *folder)
{
    const long version = landlock_version();
    if (chdir(folder) != 0)
        return NEPH_CONFINE_FAILED;
    const enum view view = make_view();
    if (view == VIEW_BROKEN || prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0)
        return NEPH_CONFINE_FAILED;
    if (version > 0 && !refuse_writes(version))
        return NEPH_CONFINE_FAILED;
    if (view == VIEW_DONE)
        return NEPH_CONFINE_TO_FOLDER;
    if (version <= 0)
        return NEPH_CONFINE_NONE;
    return refuse_changes() ? NEPH_CONFINE_NO_CHANGES : NEPH_CONFINE_WRITES;
}

enum neph_confinement neph_confine_probe(const char *folder)
{
    const pid_t pid = fork();
    if (pid == 0)
        _exit((int)neph_confine(folder));
    int wait_status = 0;
    while (pid > 0 && waitpid(pid, &wait_status, 0) < 0 && errno == EINTR)
        continue;
    return pid > 0 && WIFEXITED(wait_status) ? (enum neph_confinement)WEXITSTATUS(wait_status)
                                             : NEPH_CONFINE_FAILED;
}
