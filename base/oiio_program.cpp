/* SPDX-License-Identifier: MIT
 *
 * The program neph-image, the only code that uses OpenImageIO (base/oiio_stream.h). It limits its
 * memory and its time, and opens no network connection. No exception leaves it.
 */
#include "base/oiio_stream.h"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <malloc.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
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

struct request {
    const char *stream, *path;
    int part; /* -1: the only one */
    uint64_t memory_limit_bytes, cpu_limit_s;
    int side_max;
};

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

/* Refuse to make sockets. */
void forbid_network()
{
    sock_filter rules[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_socket, 0, 1),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EACCES),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    };
    sock_fprog program = {sizeof(rules) / sizeof(rules[0]), rules};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
        prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0)
        throw std::runtime_error("seccomp");
}

void limit_process(const request &asked)
{
    mallopt(M_ARENA_MAX, 1);
    limit_resource(RLIMIT_CORE, 0);
    limit_resource(RLIMIT_CPU, asked.cpu_limit_s);
    limit_resource(RLIMIT_AS, base_memory_bytes + asked.memory_limit_bytes);
    limit_resource(RLIMIT_FSIZE, asked.memory_limit_bytes + profile_max_bytes);
    forbid_network();
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", 1);
}

/* ---- the file -------------------------------------------------------------------------------- */

std::string complaint(const std::string &said)
{
    const size_t end = said.find('\n');
    return said.empty() ? "truncated or damaged"
                        : "truncated or damaged: " + said.substr(0, std::min<size_t>(end, 300));
}

std::unique_ptr<ImageInput> open_file(const request &asked)
{
    ImageSpec hints;
    hints.attribute("oiio:UnassociatedAlpha", 1); /* alpha is not multiplied into colours */
    hints.attribute("oiio:RawColor", 0);
    auto input = ImageInput::open(asked.path, &hints);
    if (!input)
        throw bad_file(complaint(OIIO::geterror()));
    const int part = std::max(asked.part, 0);
    if (part > 0 && !input->seek_subimage(part, 0))
        throw bad_file("there is no image of number " + std::to_string(part) +
                       "\tcount the images of the file from 0");
    if (asked.part < 0 && input->seek_subimage(1, 0))
        throw bad_file("it has several images\tchoose one by its number from 0: --part N");
    if (!input->seek_subimage(part, 0))
        throw bad_file(complaint(input->geterror()));
    return input;
}

void check_spec(const request &asked, const ImageSpec &spec)
{
    const auto is_side = [&](int64_t side) { return side >= 1 && side <= asked.side_max; };
    const std::string sides = std::to_string(spec.width) + "x" + std::to_string(spec.height);
    if (!is_side(spec.width) || !is_side(spec.height) || !is_side(spec.full_width) ||
        !is_side(spec.full_height))
        throw bad_file("a size of " + sides + " pixels; allowed are 1 to " +
                       std::to_string(asked.side_max) + " per side");
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

class writer
{
  public:
    explicit writer(const char *path) : fd(open(path, O_WRONLY | O_CLOEXEC))
    {
        if (fd < 0)
            throw std::runtime_error("the memory of neph cannot be opened");
    }
    ~writer()
    {
        close(fd);
    }
    writer(const writer &) = delete;
    writer &operator=(const writer &) = delete;

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
    int fd;
};

/* Copy the pixels in strips of rows, as the file has them: scanlines or rows of tiles. */
void copy_pixels(ImageInput &input, const ImageSpec &spec, int part, const writer &out,
                 size_t start)
{
    const auto channels = static_cast<size_t>(spec.nchannels);
    const auto width = static_cast<size_t>(spec.width);
    const int strip = spec.tile_width > 0 ? std::max(spec.tile_height, 1) : rows_at_once;
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
        if (!done)
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

void read_image(const request &asked)
{
    const auto input = open_file(asked);
    const ImageSpec spec = input->spec();
    check_spec(asked, spec);
    const std::vector<char> profile = find_profile(spec);
    const neph_oiio_head head = make_head(*input, spec, profile.size());
    const writer out(asked.stream);
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

int run(const request &asked)
{
    try {
        limit_process(asked);
    } catch (const std::exception &error) {
        fprintf(stderr, "it does not start: %s\n", error.what());
        return EX_OSERR;
    }
    try {
        read_image(asked);
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

} // namespace

int main(int argc, char **argv)
{
    if (argc != 8 || strcmp(argv[1], "read") != 0) {
        fprintf(stderr,
                "neph-image is a part of neph, which runs it; base/oiio_stream.h explains\n");
        return EX_USAGE;
    }
    return run({argv[2], argv[3],
                strcmp(argv[4], "only") == 0 ? -1 : static_cast<int>(strtol(argv[4], nullptr, 10)),
                strtoull(argv[5], nullptr, 10), strtoull(argv[6], nullptr, 10),
                static_cast<int>(strtol(argv[7], nullptr, 10))});
}
