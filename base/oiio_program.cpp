/* SPDX-License-Identifier: MIT
 *
 * The program neph-image, the only code that uses OpenImageIO (base/oiio_stream.h). It loads the
 * libraries once and forks a process for each file, which limits its memory and its time, and can
 * neither open network connections nor start processes.
 */
#include "base/oiio_stream.h"

#include <algorithm>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iterator>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <malloc.h>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <sysexits.h>
#include <unistd.h>

#include <OpenImageIO/imageio.h>

namespace
{

using OIIO::ImageInput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

constexpr uint64_t base_memory_bytes = uint64_t{1} << 30; /* libraries, stacks, codecs */
constexpr int rows_at_once = 64;
constexpr size_t profile_max_bytes = size_t{1} << 24;

/* A fault of the file, in words for the user; after a tab the way out. */
struct bad_file : std::runtime_error {
    using std::runtime_error::runtime_error;
};

using request = neph_oiio_request;

/* ---- limits ---------------------------------------------------------------------------------- */

void limit_resource(int resource, uint64_t most)
{
    rlimit limit = {};
    if (getrlimit(resource, &limit) != 0)
        throw std::runtime_error("getrlimit");
    limit.rlim_cur = limit.rlim_max == RLIM_INFINITY ? most
                                                     : std::min<rlim_t>(most, limit.rlim_max);
    if (setrlimit(resource, &limit) != 0)
        throw std::runtime_error("setrlimit");
}

/* Refuse to make sockets, to start programs, and to fork; threads are allowed. The C library uses
 * clone() where there is no clone3(), whose flags a filter cannot see. */
void forbid_network_and_processes()
{
    static const uint32_t forbidden[] = {SYS_socket, SYS_execve, SYS_execveat,
#ifdef SYS_fork
                                         SYS_fork, SYS_vfork
#endif
    };
    std::vector<sock_filter> rules = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_clone3, 0, 1),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | ENOSYS),
    };
    for (const uint32_t call : forbidden) {
        rules.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 1));
        rules.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EACCES));
    }
    const sock_filter threads_only[] = {
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_clone, 0, 3),
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, args[0])),
        BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, CLONE_THREAD, 1, 0),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EACCES),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    };
    rules.insert(rules.end(), std::begin(threads_only), std::end(threads_only));
    sock_fprog program = {static_cast<unsigned short>(rules.size()), rules.data()};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
        prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0)
        throw std::runtime_error("seccomp");
}

void limit_process(const request &asked)
{
    limit_resource(RLIMIT_CORE, 0);
    limit_resource(RLIMIT_CPU, asked.cpu_limit_s);
    limit_resource(RLIMIT_AS, base_memory_bytes + asked.memory_limit_bytes);
    limit_resource(RLIMIT_FSIZE, asked.memory_limit_bytes + profile_max_bytes);
    alarm(asked.wall_limit_s);
    forbid_network_and_processes();
    OIIO::attribute("threads", 1); /* makes OpenImageIO's threads, which a fork would not copy */
    OIIO::attribute("exr_threads", 1);
}

/* ---- the file -------------------------------------------------------------------------------- */

/* The last line of a message is the latest error. */
std::string complaint(const std::string &said)
{
    const size_t newline = said.rfind('\n');
    return said.empty() ? "truncated or damaged"
                        : "truncated or damaged: " +
                              said.substr(newline == std::string::npos ? 0 : newline + 1, 300);
}

std::unique_ptr<ImageInput> open_image(const char *path)
{
    ImageSpec hints;
    hints.attribute("oiio:UnassociatedAlpha", 1); /* alpha is not multiplied into colours */
    hints.attribute("oiio:RawColor", 0);
    auto input = ImageInput::open(path, &hints);
    if (!input)
        throw bad_file(complaint(OIIO::geterror()));
    return input;
}

std::unique_ptr<ImageInput> open_file(const request &asked)
{
    auto input = open_image(asked.path);
    if (asked.part > 0 && !input->seek_subimage(asked.part, 0))
        throw bad_file("there is no image of number " + std::to_string(asked.part) +
                       "\tcount the images of the file from 0");
    if (asked.part >= 0)
        return input;
    if (input->seek_subimage(1, 0))
        throw bad_file("it has several images\tchoose one by its number from 0: --part N");
    input->geterror(); /* of the search; clears it */
    if (strcmp(input->format_name(), "webp") == 0 || !input->seek_subimage(0, 0))
        return open_image(asked.path); /* the search ends WebP's reader */
    return input;
}

void check_spec(const request &asked, const ImageSpec &spec)
{
    const auto is_side = [&](int64_t side) { return side >= 1 && side <= asked.side_max_px; };
    const std::string sides = std::to_string(spec.width) + "x" + std::to_string(spec.height);
    if (!is_side(spec.width) || !is_side(spec.height) || !is_side(spec.full_width) ||
        !is_side(spec.full_height))
        throw bad_file("a size of " + sides + " pixels; allowed are 1 to " +
                       std::to_string(asked.side_max_px) + " per side");
    if (spec.depth > 1 || spec.deep)
        throw bad_file("a volume or a deep image\twrite a flat image");
    if (spec.nchannels < 1 || spec.nchannels > NEPH_OIIO_CHANNELS_MAX)
        throw bad_file(std::to_string(spec.nchannels) + " channels; allowed are 1 to " +
                       std::to_string(NEPH_OIIO_CHANNELS_MAX));
    const double bytes = 4.0 * spec.nchannels * spec.width * spec.height;
    if (bytes > static_cast<double>(asked.memory_limit_bytes)) {
        char text[120];
        snprintf(text, sizeof(text), "%s pixels of %d channels need %.1f GB; the limit is %.1f GB",
                 sides.c_str(), spec.nchannels, bytes / 1e9,
                 static_cast<double>(asked.memory_limit_bytes) / 1e9);
        throw bad_file(text);
    }
}

void copy_text(char to[NEPH_OIIO_NAME_BYTES], const std::string &text)
{
    if (text.size() >= NEPH_OIIO_NAME_BYTES)
        throw bad_file("the name '" + text.substr(0, 80) + "...' is longer than 255 bytes");
    memcpy(to, text.c_str(), text.size() + 1);
}

/* Bits of integers, 0 for floats. Files may use fewer bits than their type has. */
int count_bits(const ImageSpec &spec)
{
    if (spec.format.is_floating_point())
        return 0;
    return spec.get_int_attribute("oiio:BitsPerSample", static_cast<int>(8 * spec.format.size()));
}

std::vector<char> find_profile(const ImageSpec &spec)
{
    const auto *found = spec.find_attribute("ICCProfile");
    if (!found || found->type().basetype != TypeDesc::UINT8)
        return {};
    const auto *bytes = static_cast<const char *>(found->data());
    const size_t size = found->type().size();
    if (size > profile_max_bytes)
        throw bad_file("its colour profile is larger than 16 MiB");
    return {bytes, bytes + size};
}

neph_oiio_head make_head(const ImageInput &input, const ImageSpec &spec, size_t profile_bytes)
{
    neph_oiio_head head = {};
    float aspect = spec.get_float_attribute("PixelAspectRatio", 0.0f);
    head.magic = NEPH_OIIO_MAGIC;
    head.data_min_px[0] = spec.x - spec.full_x;
    head.data_min_px[1] = spec.y - spec.full_y;
    head.data_px[0] = spec.width;
    head.data_px[1] = spec.height;
    head.display_px[0] = spec.full_width;
    head.display_px[1] = spec.full_height;
    head.channel_count = spec.nchannels;
    head.integer_bits = count_bits(spec);
    head.profile_bytes = static_cast<uint32_t>(profile_bytes);
    head.pixel_aspect = static_cast<double>(aspect);
    head.frames_per_second = static_cast<double>(spec.get_float_attribute("FramesPerSecond", 0.0f));
    copy_text(head.format, input.format_name());
    copy_text(head.colour_space, spec.get_string_attribute("oiio:ColorSpace"));
    return head;
}

/* ---- the stream ------------------------------------------------------------------------------ */

/* Memory of neph. */
class writer
{
  public:
    explicit writer(int opened) : fd(opened)
    {
    }

    void put(const void *bytes, size_t size, size_t at) const
    {
        const auto *from = static_cast<const char *>(bytes);
        while (size > 0) {
            const ssize_t done = pwrite(fd, from, size, static_cast<off_t>(at));
            if (done < 0 && errno != EINTR)
                throw std::bad_alloc();
            if (done < 0)
                continue;
            from += done;
            at += static_cast<size_t>(done);
            size -= static_cast<size_t>(done);
        }
    }

  private:
    const int fd;
};

/* Copy the pixels in strips of rows, as the file has them: scanlines or rows of tiles. */
void copy_pixels(ImageInput &input, const ImageSpec &spec, int part, const writer &out,
                 size_t start)
{
    const auto channels = static_cast<size_t>(spec.nchannels);
    const auto width = static_cast<size_t>(spec.width);
    /* OpenImageIO 2.4 keeps no error of several rows of integers by Deflate. */
    const bool is_silent = spec.get_string_attribute("compression") == "zip" &&
                           !spec.format.is_floating_point();
    const int strip = spec.tile_width > 0 ? std::max(spec.tile_height, 1)
                      : is_silent         ? 1
                                          : rows_at_once;
    std::vector<float> pixels(width * channels * static_cast<size_t>(strip));
    std::vector<float> row(width);
    for (int y = 0; y < spec.height; y += strip) {
        const int first = spec.y + y, end = std::min(first + strip, spec.y + spec.height);
        const bool done = spec.tile_width > 0
                              ? input.read_tiles(part, 0, spec.x, spec.x + spec.width, first, end,
                                                 0, 1, 0, spec.nchannels, TypeDesc::FLOAT,
                                                 pixels.data())
                              : input.read_scanlines(part, 0, first, end, 0, 0, spec.nchannels,
                                                     TypeDesc::FLOAT, pixels.data());
        if (!done || input.has_error())
            throw bad_file(complaint(input.geterror()));
        for (size_t c = 0; c < channels; c++)
            for (int r = first; r < end; r++) {
                const float *from = pixels.data() +
                                    static_cast<size_t>(r - first) * width * channels + c;
                for (size_t x = 0; x < width; x++)
                    row[x] = from[x * channels];
                const size_t place = (c * static_cast<size_t>(spec.height) +
                                      static_cast<size_t>(r - spec.y)) *
                                     width;
                out.put(row.data(), width * sizeof(float), start + place * sizeof(float));
            }
    }
}

void read_image(const request &asked, const writer &out)
{
    const auto input = open_file(asked);
    const ImageSpec spec = input->spec();
    check_spec(asked, spec);
    const std::vector<char> profile = find_profile(spec);
    const neph_oiio_head head = make_head(*input, spec, profile.size());
    size_t at = sizeof(head);
    out.put(&head, sizeof(head), 0);
    for (int c = 0; c < spec.nchannels; c++) {
        char name[NEPH_OIIO_NAME_BYTES] = {};
        copy_text(name, spec.channel_name(c));
        out.put(name, sizeof(name), at);
        at += sizeof(name);
    }
    out.put(profile.data(), profile.size(), at);
    copy_pixels(*input, spec, std::max(asked.part, 0), out, at + profile.size());
    if (!input->close())
        throw bad_file(complaint(input->geterror()));
}

int run(const request &asked, const writer &out)
{
    try {
        limit_process(asked);
    } catch (const std::exception &error) {
        fprintf(stderr, "it does not start: %s\n", error.what());
        return EX_OSERR;
    }
    try {
        read_image(asked, out);
        return EX_OK;
    } catch (const std::bad_alloc &) {
        fprintf(stderr, "damaged, or it needs far more memory than the limit of %.0f MiB\n",
                static_cast<double>(asked.memory_limit_bytes) / 0x1p20);
    } catch (const bad_file &error) {
        fprintf(stderr, "%s\n", error.what());
    } catch (const std::exception &error) {
        fprintf(stderr, "OpenImageIO says: %s\n", error.what());
    } catch (...) {
        fprintf(stderr, "OpenImageIO failed without a message\n");
    }
    return EX_DATAERR;
}

/* ---- requests -------------------------------------------------------------------------------- */

/* A process that reads a file. */
struct job {
    pid_t pid;
    int pid_fd, answer_fd;
};

[[noreturn]] void stop(const char *what)
{
    fprintf(stderr, "%s: %s\n", what, strerror(errno));
    _exit(EX_OSERR);
}

int open_of_neph(const request &asked, int fd)
{
    char path[64];
    snprintf(path, sizeof(path), "/proc/%d/fd/%d", asked.process, fd);
    const int opened = open(path, O_WRONLY | O_CLOEXEC);
    if (opened < 0)
        stop("a file of neph cannot be opened");
    return opened;
}

/* Ends with this program (PR_SET_PDEATHSIG), and has only its own files open. */
[[noreturn]] void become_job(const request &asked, pid_t parent)
{
    constexpr int stream_fd = STDERR_FILENO + 1;
    if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != parent)
        _exit(EX_OSERR);
    const int log = open_of_neph(asked, asked.log_fd), null = open("/dev/null", O_RDONLY);
    dup2(log, STDERR_FILENO);
    const int stream = open_of_neph(asked, asked.stream_fd);
    if (null < 0 || dup2(null, STDIN_FILENO) < 0 || dup2(stream, stream_fd) < 0 ||
        close_range(stream_fd + 1, UINT_MAX, 0) != 0)
        stop("its files");
    _exit(run(asked, writer(stream_fd)));
}

job start_job(const request &asked)
{
    job made = {0, -1, open_of_neph(asked, asked.answer_fd)};
    const pid_t self = getpid();
    made.pid = fork();
    if (made.pid == 0)
        become_job(asked, self);
    if (made.pid < 0)
        stop("fork");
    made.pid_fd = static_cast<int>(syscall(SYS_pidfd_open, made.pid, 0));
    if (made.pid_fd < 0)
        stop("pidfd_open");
    return made;
}

void finish_job(const job &ended)
{
    int end = 0;
    rusage usage = {};
    if (wait4(ended.pid, &end, 0, &usage) != ended.pid)
        stop("wait4");
    neph_oiio_answer answer = {};
    answer.exit_code = WIFEXITED(end) ? WEXITSTATUS(end) : 0;
    answer.signal = WIFSIGNALED(end) ? WTERMSIG(end) : 0;
    answer.cpu_s = static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec);
    const ssize_t written = write(ended.answer_fd, &answer, sizeof(answer));
    static_cast<void>(written); /* neph may no longer wait for it */
    close(ended.answer_fd);
    close(ended.pid_fd);
}

/* False at the end of the pipe: neph has ended. */
bool read_request(request &asked)
{
    auto *to = reinterpret_cast<char *>(&asked);
    for (size_t have = 0; have < sizeof(asked);) {
        const ssize_t got = read(STDIN_FILENO, to + have, sizeof(asked) - have);
        if (got == 0)
            return false;
        if (got < 0 && errno != EINTR)
            stop("a request cannot be read");
        have += got > 0 ? static_cast<size_t>(got) : 0;
    }
    if (asked.magic != NEPH_OIIO_MAGIC || !memchr(asked.path, '\0', sizeof(asked.path))) {
        fprintf(stderr, "it is of another version of neph\n");
        _exit(EX_USAGE);
    }
    return true;
}

/* Read requests, and answer those whose process has ended, until neph ends. */
void serve()
{
    std::vector<job> jobs;
    request asked = {};
    for (;;) {
        std::vector<pollfd> fds = {{STDIN_FILENO, POLLIN, 0}};
        for (const job &running : jobs)
            fds.push_back({running.pid_fd, POLLIN, 0});
        if (poll(fds.data(), fds.size(), -1) < 0)
            continue;
        for (size_t i = jobs.size(); i-- > 0;)
            if (fds[i + 1].revents != 0) {
                finish_job(jobs[i]);
                jobs.erase(jobs.begin() + static_cast<std::ptrdiff_t>(i));
            }
        if (fds[0].revents != 0) {
            if (!read_request(asked))
                return;
            jobs.push_back(start_job(asked));
        }
    }
}

} // namespace

/* Threads that libraries have started by now are not in the forked processes. Those of log4cplus on
 * Debian 12 wait and hold no lock; OpenImageIO must not start its own, which hold locks. The
 * libraries' destructors are not run: they take a tenth of a second. */
int main(int argc, char **argv)
{
    if (argc != 2 || strcmp(argv[1], "serve") != 0) {
        fprintf(stderr,
                "neph-image is a part of neph, which runs it; base/oiio_stream.h explains\n");
        return EX_USAGE;
    }
    mallopt(M_ARENA_MAX, 1);
    signal(SIGPIPE, SIG_IGN);
    OIIO::get_string_attribute("format_list"); /* finds the formats, once for all files */
    serve();
    _exit(EX_OK);
}
