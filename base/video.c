/* SPDX-License-Identifier: MIT */
#include "base/video.h"

#include "base/child.h"
#include "base/files.h"
#include "base/helper.h"
#include "base/srgb.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

enum { VALUE_BYTES = 64, TEXT_BYTES = 300, FRAMES_MAX = 1 << 20, HD_LINES = 720, CODE_MAX = 65535 };

/* Decoders reach a megabyte of a file in a second or less; this is ten times as long. */
static const double start_s = 60.0, bytes_per_s = 1e5;

static const char largest_allocation[] = "1073741824";

/* What ffprobe says of the first video stream; "" or "unknown": nothing. */
struct facts {
    char codec_name[VALUE_BYTES], width[VALUE_BYTES], height[VALUE_BYTES], pix_fmt[VALUE_BYTES];
    char color_range[VALUE_BYTES], color_space[VALUE_BYTES], color_transfer[VALUE_BYTES];
    char color_primaries[VALUE_BYTES], field_order[VALUE_BYTES], avg_frame_rate[VALUE_BYTES];
    char nb_read_frames[VALUE_BYTES];
};

#define FACT(name)                                                                                 \
    {                                                                                              \
#name, offsetof(struct facts, name)                                                        \
    }
static const struct {
    const char *name;
    size_t at;
} fact_names[] = {
    FACT(codec_name),  FACT(width),          FACT(height),         FACT(pix_fmt),
    FACT(color_range), FACT(color_space),    FACT(color_transfer), FACT(color_primaries),
    FACT(field_order), FACT(avg_frame_rate), FACT(nb_read_frames),
};
#undef FACT
enum { FACTS = sizeof(fact_names) / sizeof(fact_names[0]) };

/* Planes of a frame that ffmpeg decodes. */
enum planes { PLANES_YUV, PLANES_RGB, PLANES_GREY, PLANES_COUNT };

static const struct {
    const char *format; /* of ffmpeg, before the number of bits */
    int count;
} planes[PLANES_COUNT] = {
    [PLANES_YUV] = {"yuv444p", 3}, /* chroma at the size of luma */
    [PLANES_RGB] = {"gbrp", 3},
    [PLANES_GREY] = {"gray", 1},
};

/* What neph makes of it. */
struct stream {
    int width_px, height_px, frame_count, bits;
    double rate_hz; /* 0: not said */
    enum planes planes;
    double red_weight, blue_weight; /* of luma */
    bool is_full_range;
    char text[TEXT_BYTES]; /* NEPH_VIDEO_ATTRIBUTE */
};

struct neph_video {
    struct stream stream;
    int fd; /* decoded frames */
};

bool neph_video_is(const char *path)
{
    unsigned char head[16] = {0};
    int fd;
    if (neph_file_open(path, &fd, NULL, NULL))
        return false;
    const ssize_t got = pread(fd, head, sizeof(head), 0);
    close(fd);
    return got >= 12 &&
           (memcmp(head + 4, "ftyp", 4) == 0 || memcmp(head, "\x1a\x45\xdf\xa3", 4) == 0 ||
            memcmp(head, "YUV4MPEG2 ", 10) == 0);
}

/* ---- what the file is ------------------------------------------------------------------------ */

static bool is_said(const char *value)
{
    return value[0] && strcmp(value, "unknown") != 0 && strcmp(value, "N/A") != 0 &&
           strcmp(value, "unspecified") != 0;
}

static void parse_facts(const char *text, struct facts *facts)
{
    while (*text) {
        const size_t length = strcspn(text, "\n"), name = strcspn(text, "=\n");
        for (size_t i = 0; i < FACTS && name < length; i++)
            if (strlen(fact_names[i].name) == name && memcmp(text, fact_names[i].name, name) == 0)
                snprintf((char *)facts + fact_names[i].at, VALUE_BYTES, "%.*s",
                         (int)(length - name - 1), text + name + 1);
        text += length + (text[length] == '\n');
    }
}

static enum neph_status fail_missing(struct neph_diag *diag)
{
    neph_fail(diag, NEPH_ERR_UNAVAILABLE,
              "the programs ffprobe and ffmpeg, which decode videos, "
              "are missing");
    neph_hint(diag, "sudo apt-get install ffmpeg; or write frames as PNG or EXR");
    return NEPH_ERR_UNAVAILABLE;
}

/* Run a program of ffmpeg; `log` receives its output. */
static enum neph_status run(const char *path, uint64_t file_bytes, const char *const *argv,
                            const struct neph_shared *log, struct neph_diag *diag)
{
    const struct neph_child_params params = {.argv = argv,
                                             .log_path = log->path,
                                             .time_limit_s = start_s +
                                                             (double)file_bytes / bytes_per_s};
    struct neph_child_result result = {0};
    struct neph_diag inner = {.line = 0};
    const enum neph_status status = neph_child_run(&params, &result, &inner);
    if (status == NEPH_ERR_UNAVAILABLE)
        return fail_missing(diag);
    if (status == NEPH_ERR_ENGINE || status == NEPH_ERR_TIMEOUT)
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' is no video that ffmpeg decodes: %s", path,
                         inner.message);
    return status ? neph_fail(diag, status, "%s", inner.message) : NEPH_OK;
}

static enum neph_status probe(const char *path, struct facts *facts, struct neph_diag *diag)
{
    char entries[TEXT_BYTES] = "stream=";
    uint64_t file_bytes = 0;
    struct neph_shared log;
    const void *text = NULL;
    size_t size = 0;
    int fd;
    for (size_t i = 0, used = strlen(entries); i < FACTS && used < sizeof(entries); i++)
        used += (size_t)snprintf(entries + used, sizeof(entries) - used, "%s%s", i ? "," : "",
                                 fact_names[i].name);
    char *url = neph_format("file:%s", path);
    enum neph_status status = url ? neph_file_open(path, &fd, &file_bytes, diag)
                                  : neph_fail_memory(diag);
    if (!status)
        close(fd);
    if (!status)
        status = neph_shared_create("neph-video", &log, diag);
    if (status) {
        free(url);
        return status;
    }
    const char *const argv[] = {"ffprobe",
                                "-v",
                                "quiet",
                                "-max_alloc",
                                largest_allocation,
                                "-protocol_whitelist",
                                "file",
                                "-select_streams",
                                "v:0",
                                "-count_frames",
                                "-show_entries",
                                entries,
                                "-of",
                                "default=noprint_wrappers=1",
                                url,
                                NULL};
    status = run(path, file_bytes, argv, &log, diag);
    if (!status)
        status = neph_shared_map(&log, &text, &size, diag);
    char *copy = status ? NULL : strndup(text ? text : "", size);
    if (!status && copy)
        parse_facts(copy, facts);
    else if (!status)
        status = neph_fail_memory(diag);
    free(copy);
    if (text)
        munmap((void *)text, size);
    neph_shared_destroy(&log);
    free(url);
    return status;
}

/* Values of a property that can be decoded as sRGB. */
struct allowed {
    const char *what;
    const char *values[6];
};

static enum neph_status check_value(const char *path, const char *value,
                                    const struct allowed *allowed, struct neph_diag *diag)
{
    for (int i = 0; allowed->values[i]; i++)
        if (!is_said(value) || strcmp(value, allowed->values[i]) == 0)
            return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT,
              "'%s' is a video with %s %s; SDR in BT.709 or sRGB, "
              "progressive, is read",
              path, allowed->what, value);
    neph_hint(diag, "convert it by ffmpeg, or write frames as EXR");
    return NEPH_ERR_INPUT;
}

static enum neph_status check_colours(const char *path, const struct facts *facts,
                                      struct neph_diag *diag)
{
    static const struct allowed transfers = {"the transfer curve",
                                             {"bt709", "iec61966-2-1", "smpte170m", "bt470bg"}},
                                primaries = {"the primaries", {"bt709"}},
                                fields = {"fields in the order", {"progressive"}};
    enum neph_status status = check_value(path, facts->color_transfer, &transfers, diag);
    if (!status)
        status = check_value(path, facts->color_primaries, &primaries, diag);
    return status ? status : check_value(path, facts->field_order, &fields, diag);
}

/* Planes and bits by ffmpeg's name of a pixel format: "yuv420p10le". */
static enum neph_status choose_planes(const char *path, const char *format, struct stream *stream,
                                      struct neph_diag *diag)
{
    static const struct {
        const char *start;
        enum planes planes;
    } formats[] = {
        {"yuv", PLANES_YUV},   {"nv12", PLANES_YUV},  {"gray", PLANES_GREY}, {"gbrp", PLANES_RGB},
        {"rgb24", PLANES_RGB}, {"bgr24", PLANES_RGB}, {"rgb0", PLANES_RGB},  {"bgr0", PLANES_RGB},
    };
    static const int depths[] = {10, 12, 14, 16};
    const char *p = strncmp(format, "gray", 4) == 0 ? format + 4 : strrchr(format, 'p');
    for (size_t i = 0; i < sizeof(formats) / sizeof(formats[0]); i++) {
        if (strncmp(format, formats[i].start, strlen(formats[i].start)) != 0 ||
            strncmp(format, "yuva", 4) == 0)
            continue;
        const char *digits = p && *p == 'p' ? p + 1 : p;
        const bool has_bits = digits && *digits; /* "f32le" of floats is no number of bits */
        const long bits = has_bits ? strtol(digits, NULL, 10) : 8;
        stream->planes = formats[i].planes;
        stream->bits = 8;
        for (size_t d = 0; d < sizeof(depths) / sizeof(depths[0]); d++)
            if (bits == depths[d])
                stream->bits = depths[d];
        if (stream->bits == bits)
            return NEPH_OK;
    }
    neph_fail(diag, NEPH_ERR_INPUT,
              "'%s' is a video with pixels '%s'; Y'CbCr, RGB and grey of 8, 10, 12, 14 or 16 bits "
              "without alpha are read",
              path, format);
    neph_hint(diag, "convert it by ffmpeg, such as -pix_fmt yuv444p, or write frames as PNG");
    return NEPH_ERR_INPUT;
}

/* The weights of luma: ITU-R BT.709-6 and BT.601-7. */
static enum neph_status choose_matrix(const char *path, const char *stated, struct stream *stream,
                                      const char **name, struct neph_diag *diag)
{
    static const struct {
        const char *stated, *name;
        double red, blue;
    } matrices[] = {
        {"bt709", "BT.709", 0.2126, 0.0722},
        {"smpte170m", "BT.601", 0.299, 0.114},
        {"bt470bg", "BT.601", 0.299, 0.114},
    };
    static const struct allowed known = {"the matrix", {"bt709", "smpte170m", "bt470bg"}};
    const char *wanted = is_said(stated)                 ? stated
                         : stream->height_px >= HD_LINES ? "bt709"
                                                         : "smpte170m";
    *name = "none";
    if (stream->planes != PLANES_YUV)
        return NEPH_OK;
    for (size_t i = 0; i < sizeof(matrices) / sizeof(matrices[0]); i++)
        if (strcmp(wanted, matrices[i].stated) == 0) {
            stream->red_weight = matrices[i].red;
            stream->blue_weight = matrices[i].blue;
            *name = matrices[i].name;
            return NEPH_OK;
        }
    return check_value(path, wanted, &known, diag);
}

static double parse_rate(const char *text)
{
    char *end = NULL;
    const double count = strtod(text, &end), per = *end == '/' ? strtod(end + 1, NULL) : 1.0;
    const double rate_hz = count / per;
    return isfinite(rate_hz) && rate_hz > 0.0 ? rate_hz : 0.0;
}

static enum neph_status find_stream(const char *path, struct stream *stream, struct neph_diag *diag)
{
    struct facts facts = {.width = ""};
    const char *matrix = "";
    *stream = (struct stream){.width_px = 0};
    enum neph_status status = probe(path, &facts, diag);
    if (!status)
        status = check_colours(path, &facts, diag);
    if (status)
        return status;
    const long width = strtol(facts.width, NULL, 10), height = strtol(facts.height, NULL, 10),
               count = strtol(facts.nb_read_frames, NULL, 10);
    if (count < 1 || count > FRAMES_MAX || width < 1 || height < 1 ||
        width > NEPH_IMAGE_SIDE_MAX_PX || height > NEPH_IMAGE_SIDE_MAX_PX)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "'%s' is no video: ffprobe finds %ld frames of %ldx%ld pixels", path,
                         count, width, height);
    stream->width_px = (int)width;
    stream->height_px = (int)height;
    stream->frame_count = (int)count;
    stream->rate_hz = parse_rate(facts.avg_frame_rate);
    status = choose_planes(path, facts.pix_fmt, stream, diag);
    if (!status)
        status = choose_matrix(path, facts.color_space, stream, &matrix, diag);
    stream->is_full_range = strcmp(facts.color_range, "pc") == 0 ||
                            (stream->planes == PLANES_RGB && !is_said(facts.color_range)) ||
                            strncmp(facts.pix_fmt, "yuvj", 4) == 0;
    snprintf(stream->text, sizeof(stream->text), "%.20s, %.30s, %s range%s, matrix %s%s",
             facts.codec_name, facts.pix_fmt, stream->is_full_range ? "full" : "limited",
             is_said(facts.color_range) ? "" : " (not stated)", matrix,
             is_said(facts.color_space) || stream->planes != PLANES_YUV ? "" : " (not stated)");
    return status;
}

enum neph_status neph_video_count(const char *path, int *count, struct neph_diag *diag)
{
    struct stream stream;
    const enum neph_status status = find_stream(path, &stream, diag);
    if (!status)
        *count = stream.frame_count;
    return status;
}

/* ---- frames ---------------------------------------------------------------------------------- */

static size_t count_frame_bytes(const struct stream *stream)
{
    return (size_t)stream->width_px * (size_t)stream->height_px *
           (size_t)planes[stream->planes].count * (stream->bits == 8 ? 1 : 2);
}

/* Create a file without a name that has room for all frames. */
static enum neph_status create_room(const struct stream *stream, int *fd, struct neph_diag *diag)
{
    const char *folder = getenv("TMPDIR");
    const double needed = (double)count_frame_bytes(stream) * stream->frame_count;
    struct statvfs disk;
    folder = folder && folder[0] ? folder : "/tmp";
    if (statvfs(folder, &disk) == 0 && (double)disk.f_bavail * (double)disk.f_frsize < needed) {
        neph_fail(diag, NEPH_ERR_IO, "%d decoded frames of %dx%d pixels need %.1f GB in '%s'",
                  stream->frame_count, stream->width_px, stream->height_px, needed / 1e9, folder);
        neph_hint(diag, "set TMPDIR to a folder with more room, or cut the video");
        return NEPH_ERR_IO;
    }
    char *name = neph_format("%s/neph-video-XXXXXX", folder);
    if (!name)
        return neph_fail_memory(diag);
    *fd = mkostemp(name, O_CLOEXEC);
    if (*fd >= 0)
        unlink(name);
    free(name);
    return *fd >= 0 ? NEPH_OK
                    : neph_fail(diag, NEPH_ERR_IO, "no temporary file in '%s': %s", folder,
                                strerror(errno));
}

static enum neph_status decode(const char *path, const struct neph_video *video,
                               struct neph_diag *diag)
{
    const struct stream *stream = &video->stream;
    const char *range = stream->is_full_range ? "full" : "limited";
    struct neph_shared log;
    struct stat info = {.st_size = 0};
    enum neph_status status = neph_shared_create("neph-video-log", &log, diag);
    if (status)
        return status;
    char *url = neph_format("file:%s", path),
         *out = neph_format("file:/proc/%ld/fd/%d", (long)getpid(), video->fd),
         *filter = neph_format("scale=flags=bicubic+accurate_rnd+full_chroma_inp:in_range=%s:"
                               "out_range=%s",
                               range, range);
    char format[VALUE_BYTES], bits[VALUE_BYTES] = "";
    if (stream->bits > 8)
        snprintf(bits, sizeof(bits), "%dle", stream->bits);
    snprintf(format, sizeof(format), "%s%.16s", planes[stream->planes].format, bits);
    const char *const argv[] = {"ffmpeg",
                                "-nostdin",
                                "-v",
                                "error",
                                "-max_alloc",
                                largest_allocation,
                                "-protocol_whitelist",
                                "file",
                                "-i",
                                url,
                                "-map",
                                "0:v:0",
                                "-vf",
                                filter,
                                "-vsync",
                                "passthrough",
                                "-f",
                                "rawvideo",
                                "-pix_fmt",
                                format,
                                "-y",
                                out,
                                NULL};
    status = url && out && filter
                 ? run(path, count_frame_bytes(stream) * (uint64_t)stream->frame_count, argv, &log,
                       diag)
                 : neph_fail_memory(diag);
    free(url);
    free(out);
    free(filter);
    neph_shared_destroy(&log);
    if (status)
        return status;
    const size_t expected = count_frame_bytes(stream) * (size_t)stream->frame_count;
    if (fstat(video->fd, &info) != 0 || (size_t)info.st_size != expected)
        return neph_fail(
            diag, NEPH_ERR_INPUT, "'%s' is truncated or damaged: ffmpeg decodes %.1f of %d frames",
            path, (double)info.st_size / (double)count_frame_bytes(stream), stream->frame_count);
    return NEPH_OK;
}

enum neph_status neph_video_open(const char *path, struct neph_video **video,
                                 struct neph_diag *diag)
{
    struct neph_video *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    made->fd = -1;
    enum neph_status status = find_stream(path, &made->stream, diag);
    if (!status)
        status = create_room(&made->stream, &made->fd, diag);
    if (!status)
        status = decode(path, made, diag);
    if (status)
        neph_video_close(made);
    else
        *video = made;
    return status;
}

void neph_video_close(struct neph_video *video)
{
    if (!video)
        return;
    if (video->fd >= 0)
        close(video->fd);
    free(video);
}

int neph_video_frame_count(const struct neph_video *video)
{
    return video->stream.frame_count;
}

static enum neph_status read_codes(const struct neph_video *video, int frame, uint8_t *codes,
                                   struct neph_diag *diag)
{
    const size_t bytes = count_frame_bytes(&video->stream);
    size_t done = 0;
    while (done < bytes) {
        const ssize_t got = pread(video->fd, codes + done, bytes - done,
                                  (off_t)((size_t)frame * bytes + done));
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return neph_fail(diag, NEPH_ERR_IO, "cannot read decoded frames: %s", strerror(errno));
        done += (size_t)got;
    }
    return NEPH_OK;
}

/* A sample as a number from 0 (black) to 1, or of chroma from -0.5 to 0.5. */
static double read_sample(const struct stream *stream, const uint8_t *codes, size_t index,
                          bool is_chroma)
{
    const int code = stream->bits == 8 ? codes[index]
                                       : codes[2 * index] | codes[2 * index + 1] << 8;
    const double most = (double)((1 << stream->bits) - 1), unit = (double)(1 << (stream->bits - 8));
    const double centre = is_chroma ? 128.0 * unit : 0.0;
    if (stream->is_full_range)
        return (code - centre) / most;
    return is_chroma ? (code - centre) / (224.0 * unit) : (code - 16.0 * unit) / (219.0 * unit);
}

/* R'G'B' of a pixel: ITU-R BT.601-7, 2.5.1, solved for R, G and B. */
static void decode_pixel(const struct stream *stream, const uint8_t *codes, size_t i, double rgb[3])
{
    const size_t count = (size_t)stream->width_px * (size_t)stream->height_px;
    const bool is_yuv = stream->planes == PLANES_YUV;
    double v[3];
    for (int p = 0; p < planes[stream->planes].count; p++)
        v[p] = read_sample(stream, codes, (size_t)p * count + i, is_yuv && p > 0);
    if (stream->planes == PLANES_GREY) {
        rgb[0] = rgb[1] = rgb[2] = v[0];
    } else if (stream->planes == PLANES_RGB) { /* planes are green, blue, red */
        rgb[0] = v[2];
        rgb[1] = v[0];
        rgb[2] = v[1];
    } else {
        const double red = stream->red_weight, blue = stream->blue_weight;
        rgb[0] = v[0] + 2.0 * (1.0 - red) * v[2];
        rgb[2] = v[0] + 2.0 * (1.0 - blue) * v[1];
        rgb[1] = (v[0] - red * rgb[0] - blue * rgb[2]) / (1.0 - red - blue);
    }
}

static enum neph_status fill(const struct stream *stream, const uint8_t *codes,
                             struct neph_image *image, struct neph_diag *diag)
{
    float *channels[3], *linear = malloc((CODE_MAX + 1) * sizeof(*linear));
    const enum neph_status status = linear ? neph_image_add_rgb(image, NULL, channels, diag)
                                           : neph_fail_memory(diag);
    for (int code = 0; code <= CODE_MAX && !status; code++)
        linear[code] = (float)neph_srgb_to_linear((double)code / CODE_MAX);
    for (size_t i = 0; i < neph_image_pixel_count(image) && !status; i++) {
        double rgb[3];
        decode_pixel(stream, codes, i, rgb);
        for (int c = 0; c < 3; c++)
            channels[c][i] = linear[(int)(fmin(fmax(rgb[c], 0.0), 1.0) * CODE_MAX + 0.5)];
    }
    free(linear);
    return status;
}

enum neph_status neph_video_read(struct neph_video *video, int frame, struct neph_image **image,
                                 struct neph_diag *diag)
{
    const struct stream *stream = &video->stream;
    struct neph_image *made = NULL;
    uint8_t *codes = malloc(count_frame_bytes(stream));
    enum neph_status status = codes ? read_codes(video, frame, codes, diag)
                                    : neph_fail_memory(diag);
    if (!status)
        status = neph_image_create(stream->width_px, stream->height_px, &made, diag);
    if (!status)
        status = fill(stream, codes, made, diag);
    if (!status)
        status = neph_image_set_attribute(made, "encoding", diag, "sRGB");
    if (!status)
        status = neph_image_set_attribute(made, NEPH_VIDEO_ATTRIBUTE, diag, "%s", stream->text);
    if (!status && stream->rate_hz > 0.0)
        status = neph_image_set_attribute(made, "frames_per_second", diag, "%.15g",
                                          stream->rate_hz);
    free(codes);
    if (status)
        neph_image_destroy(made);
    else
        *image = made;
    return status;
}
