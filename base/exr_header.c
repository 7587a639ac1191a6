/* SPDX-License-Identifier: MIT */
#include "base/exr_header.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    FIRST_BYTES = 1 << 14,
    HEADER_MAX_BYTES = 1 << 26, /* a preview of 4096x4096 pixels */
    OFFSET_BYTES = 8,           /* per entry of the table of chunk offsets */
};

uint32_t neph_exr_u32(const unsigned char *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

float neph_exr_f32(const unsigned char *at)
{
    const uint32_t bits = neph_exr_u32(at);
    float value;
    memcpy(&value, &bits, sizeof(value));
    return value;
}

static uint64_t read_u64(const unsigned char *at)
{
    return (uint64_t)neph_exr_u32(at) | (uint64_t)neph_exr_u32(at + 4) << 32;
}

double neph_exr_f64(const unsigned char *at)
{
    const uint64_t bits = read_u64(at);
    double value;
    memcpy(&value, &bits, sizeof(value));
    return value;
}

/* The text at header[*at], which moves behind its zero byte; NULL: no zero byte. */
static const char *read_next_text(const char *header, size_t size, size_t *at)
{
    const char *text = header + *at;
    const char *end = memchr(text, '\0', size - *at);
    if (!end)
        return NULL;
    *at += (size_t)(end - text) + 1;
    return text;
}

bool neph_exr_next_attribute(const char *header, size_t size, size_t *at,
                             struct neph_exr_attribute *attribute)
{
    size_t place = *at;
    if (place < size && header[place] == '\0')
        return false;
    *at = size;
    if (place >= size)
        return false;
    *attribute = (struct neph_exr_attribute){.start = header + place};
    attribute->name = read_next_text(header, size, &place);
    attribute->type = attribute->name ? read_next_text(header, size, &place) : NULL;
    if (!attribute->type || size - place < 4)
        return false;
    attribute->value_bytes = neph_exr_u32((const unsigned char *)header + place);
    place += 4;
    if (attribute->value_bytes > size - place)
        return false;
    attribute->value = (const unsigned char *)header + place;
    place += attribute->value_bytes;
    attribute->bytes = (size_t)(header + place - attribute->start);
    *at = place;
    return true;
}

/* Size of the complete attributes at the start of `text`; `*is_whole`: the header ends after them.
 */
static size_t count_attribute_bytes(const char *text, size_t size, bool *is_whole)
{
    struct neph_exr_attribute attribute;
    size_t at = 0, whole = 0;
    while (neph_exr_next_attribute(text, size, &at, &attribute))
        whole = at;
    *is_whole = at < size;
    return whole;
}

/* Size of the complete headers and attributes of a multi-part file; an empty header ends them. */
static size_t count_header_bytes(const char *text, size_t size, bool *is_whole)
{
    size_t whole = 0;
    for (;;) {
        whole += count_attribute_bytes(text + whole, size - whole, is_whole);
        if (!*is_whole)
            return whole;
        whole++;
        *is_whole = whole < size;
        if (!*is_whole || text[whole] == '\0')
            return whole;
    }
}

bool neph_exr_next_header(const char *headers, size_t size, size_t *at, const char **header,
                          size_t *bytes)
{
    bool is_whole;
    if (*at >= size)
        return false;
    *header = headers + *at;
    *bytes = count_attribute_bytes(*header, size - *at, &is_whole);
    *at += *bytes + 1;
    return true;
}

/* Read up to `size` bytes; -1: errno has the reason. */
static ssize_t read_bytes(int fd, size_t offset, char *target, size_t size)
{
    size_t done = 0;
    while (done < size) {
        const ssize_t got = pread(fd, target + done, size - done, (off_t)(offset + done));
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return -1;
        if (got == 0)
            break;
        done += (size_t)got;
    }
    return (ssize_t)done;
}

enum neph_status neph_exr_read_headers(int fd, uint64_t file_bytes, char **headers, size_t *size,
                                       struct neph_diag *diag)
{
    unsigned char prefix[NEPH_EXR_PREFIX_BYTES] = {0};
    if (read_bytes(fd, 0, (char *)prefix, sizeof(prefix)) < 0)
        return NEPH_ERR_IO;
    const bool has_parts = neph_exr_u32(prefix + 4) & NEPH_EXR_FLAG_MULTIPART;
    const uint64_t behind = file_bytes > NEPH_EXR_PREFIX_BYTES ? file_bytes - NEPH_EXR_PREFIX_BYTES
                                                               : 0;
    for (size_t room = FIRST_BYTES;; room *= 8) {
        char *text = malloc(room);
        if (!text)
            return neph_fail_memory(diag);
        const ssize_t got = read_bytes(fd, NEPH_EXR_PREFIX_BYTES, text, room);
        if (got < 0) {
            const int error = errno;
            free(text);
            errno = error;
            return NEPH_ERR_IO;
        }
        bool is_whole;
        const size_t whole = has_parts ? count_header_bytes(text, (size_t)got, &is_whole)
                                       : count_attribute_bytes(text, (size_t)got, &is_whole);
        if (is_whole || room >= behind || room >= HEADER_MAX_BYTES) {
            *headers = text;
            *size = whole;
            return NEPH_OK;
        }
        free(text);
    }
}

static void add_to_offset(char *at, size_t bytes)
{
    const uint64_t offset = read_u64((const unsigned char *)at) + bytes;
    for (int i = 0; i < OFFSET_BYTES; i++)
        at[i] = (char)(offset >> 8 * i & 255);
}

enum neph_status neph_exr_add_attributes(char **file, uint64_t *file_bytes, int64_t chunk_count,
                                         const char *attributes, size_t bytes,
                                         struct neph_diag *diag)
{
    bool is_whole;
    const size_t place = NEPH_EXR_PREFIX_BYTES +
                         count_attribute_bytes(*file + NEPH_EXR_PREFIX_BYTES,
                                               *file_bytes - NEPH_EXR_PREFIX_BYTES, &is_whole);
    char *grown = realloc(*file, *file_bytes + bytes);
    if (!grown)
        return neph_fail_memory(diag);
    *file = grown;
    memmove(grown + place + bytes, grown + place, *file_bytes - place);
    memcpy(grown + place, attributes, bytes);
    *file_bytes += bytes;
    for (int64_t i = 0; i < chunk_count; i++)
        add_to_offset(grown + place + bytes + 1 + OFFSET_BYTES * i, bytes);
    return NEPH_OK;
}
