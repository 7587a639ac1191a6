/* SPDX-License-Identifier: MIT */
#include "harness/compare/frame_size.h"

#include "base/exr_header.h"
#include "base/files.h"
#include "base/interrupt.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static uint32_t big_endian_32(const unsigned char *b)
{
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | (uint32_t)b[3];
}

/* The first chunk of a PNG is IHDR. */
static bool read_png(const unsigned char head[24], int *width_px, int *height_px)
{
    static const unsigned char magic[4] = {0x89, 'P', 'N', 'G'};
    if (memcmp(head, magic, 4) != 0 || memcmp(head + 12, "IHDR", 4) != 0)
        return false;
    *width_px = (int)big_endian_32(head + 16);
    *height_px = (int)big_endian_32(head + 20);
    return true;
}

static bool find_window(const char *header, size_t size, const char *name, int32_t window[4])
{
    struct neph_exr_attribute attribute;
    size_t at = 0;
    while (neph_exr_next_attribute(header, size, &at, &attribute)) {
        if (strcmp(attribute.name, name) != 0 || attribute.value_bytes != 16)
            continue;
        for (int i = 0; i < 4; i++)
            window[i] = (int32_t)neph_exr_u32(attribute.value + 4 * i);
        return true;
    }
    return false;
}

static bool read_exr(int fd, uint64_t file_bytes, int *width_px, int *height_px)
{
    char *headers = NULL;
    const char *header;
    size_t size = 0, at = 0, bytes;
    int32_t data[4], display[4];
    if (neph_exr_read_headers(fd, file_bytes, &headers, &size, NULL))
        return false;
    const bool is_whole = neph_exr_next_header(headers, size, &at, &header, &bytes) && at >= size &&
                          find_window(header, bytes, "dataWindow", data) &&
                          find_window(header, bytes, "displayWindow", display) &&
                          memcmp(data, display, sizeof(data)) == 0;
    if (is_whole) {
        *width_px = (int)((uint32_t)data[2] - (uint32_t)data[0] + 1u);
        *height_px = (int)((uint32_t)data[3] - (uint32_t)data[1] + 1u);
    }
    free(headers);
    return is_whole;
}

bool neph_frame_size(const char *path, int *width_px, int *height_px)
{
    static const unsigned char exr_magic[4] = {0x76, 0x2f, 0x31, 0x01};
    unsigned char head[24] = {0};
    uint64_t file_bytes = 0;
    bool is_known = false;
    int fd;
    if (neph_file_open(path, &fd, &file_bytes, NULL))
        return false;
    if (pread(fd, head, sizeof(head), 0) == (ssize_t)sizeof(head))
        is_known = memcmp(head, exr_magic, 4) == 0 ? read_exr(fd, file_bytes, width_px, height_px)
                                                   : read_png(head, width_px, height_px);
    close(fd);
    return is_known;
}

enum neph_status neph_frame_sizes_check(const struct neph_sequence *const *sequences, int count,
                                        struct neph_diag *diag)
{
    const char *first = NULL;
    int width_px = 0, height_px = 0;
    for (int s = 0; s < count; s++)
        for (int i = 0; i < sequences[s]->count; i++) {
            const char *path = sequences[s]->paths[i];
            int w, h;
            if (neph_interrupted())
                return neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted");
            if (!neph_frame_size(path, &w, &h))
                continue;
            if (first && (w != width_px || h != height_px)) {
                neph_fail(diag, NEPH_ERR_INPUT,
                          "the size changes: it is %dx%d pixels in '%s' and %dx%d in '%s'",
                          width_px, height_px, first, w, h, path);
                neph_hint(diag, "render all frames at one size");
                return NEPH_ERR_INPUT;
            }
            first = path;
            width_px = w;
            height_px = h;
        }
    return NEPH_OK;
}
