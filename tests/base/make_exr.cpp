/* SPDX-License-Identifier: MIT
 *
 * The program make_exr FOLDER writes OpenEXR files of all kinds for test_exr_library.c with the
 * OpenEXR library. Each NAME.exr of a flat image has a NAME.raw: its samples as 32-bit floats,
 * channel after channel in the order of their names, as the library's own reader returns them. With
 * lossless compression the program fails if they differ from the written samples.
 */
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfDeepScanLineOutputPart.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>
#include <ImfTiledOutputPart.h>
#include <half.h>

namespace
{

enum { CHROMA_WIDTH = 80, CHROMA_HEIGHT = 66 };

using namespace OPENEXR_IMF_NAMESPACE;
using IMATH_NAMESPACE::Box2i;
using IMATH_NAMESPACE::V2i;

struct Channel {
    std::string name;
    PixelType type;
    std::vector<char> samples; /* of that type */
    bool is_linear = false;    /* perceptually; B44 needs this flag */
};

struct Picture {
    Box2i window, display;
    Compression compression;
    LineOrder order;
    std::vector<Channel> channels; /* in the order of their names, as in the file */

    int width() const
    {
        return window.max.x - window.min.x + 1;
    }
    int height() const
    {
        return window.max.y - window.min.y + 1;
    }
    size_t pixels() const
    {
        return static_cast<size_t>(width()) * static_cast<size_t>(height());
    }
};

size_t pixel_type_bytes(PixelType type)
{
    return type == HALF ? 2 : 4;
}

/* A fixed stream of noise, so that some chunks are incompressible. */
uint32_t noise(uint32_t &state)
{
    state = state * 1664525u + 1013904223u;
    return state >> 8;
}

template <typename T> void put(Channel &channel, size_t i, T value)
{
    std::memcpy(channel.samples.data() + i * sizeof(value), &value, sizeof(value));
}

/* A gradient in the left half, noise in the right. */
void fill(Channel &channel, int width, int height, uint32_t &state)
{
    channel.samples.resize(pixel_type_bytes(channel.type) * static_cast<size_t>(width * height));
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const size_t i = static_cast<size_t>(y * width + x);
            const uint32_t random = noise(state);
            const float value = 2 * x < width ? 0.25f + 0.01f * static_cast<float>(x + 2 * y)
                                              : static_cast<float>(random) * 0x1p-20f;
            if (channel.type == HALF)
                put(channel, i, half(value));
            else if (channel.type == FLOAT)
                put(channel, i, value);
            else
                put(channel, i, static_cast<uint32_t>(1000.0f * value));
        }
}

Picture make(int width, int height, Compression compression, const std::vector<PixelType> &types)
{
    static const char *const names[] = {"A", "B", "G", "R", "Z"};
    Picture picture{{V2i(0, 0), V2i(width - 1, height - 1)},
                    {V2i(0, 0), V2i(width - 1, height - 1)},
                    compression,
                    INCREASING_Y,
                    {}};
    uint32_t state = static_cast<uint32_t>(width * 31 + height);
    for (size_t c = 0; c < types.size(); c++) {
        picture.channels.push_back({names[c], types[c], {}, false});
        fill(picture.channels.back(), width, height, state);
    }
    return picture;
}

Header make_header(const Picture &picture)
{
    Header header(picture.display, picture.window, 1.0f, V2i(0, 0), 1.0f, picture.order,
                  picture.compression);
    for (const Channel &channel : picture.channels)
        header.channels().insert(
            channel.name, OPENEXR_IMF_NAMESPACE::Channel(channel.type, 1, 1, channel.is_linear));
    return header;
}

FrameBuffer make_frame_buffer(Picture &picture)
{
    FrameBuffer buffer;
    for (Channel &channel : picture.channels) {
        const size_t size = pixel_type_bytes(channel.type);
        buffer.insert(channel.name,
                      Slice::Make(channel.type, channel.samples.data(), picture.window, size,
                                  size * static_cast<size_t>(picture.width())));
    }
    return buffer;
}

/* The image as the library reads it. */
Picture read_back(const std::string &path, const Picture &written)
{
    Picture read = written;
    for (Channel &channel : read.channels)
        std::memset(channel.samples.data(), 0, channel.samples.size());
    InputFile file(path.c_str());
    file.setFrameBuffer(make_frame_buffer(read));
    file.readPixels(read.window.min.y, read.window.max.y);
    return read;
}

float read_sample(const Channel &channel, size_t i)
{
    const char *at = channel.samples.data() + i * pixel_type_bytes(channel.type);
    if (channel.type == HALF) {
        half value;
        std::memcpy(&value, at, sizeof(value));
        return value;
    }
    if (channel.type == UINT) {
        uint32_t value;
        std::memcpy(&value, at, sizeof(value));
        return static_cast<float>(value);
    }
    float value;
    std::memcpy(&value, at, sizeof(value));
    return value;
}

void write_raw(const std::string &path, const Picture &picture)
{
    std::ofstream out(path, std::ios::binary);
    for (const Channel &channel : picture.channels)
        for (size_t i = 0; i < picture.pixels(); i++) {
            const float value = read_sample(channel, i);
            out.write(reinterpret_cast<const char *>(&value), sizeof(value));
        }
    if (!out.flush())
        throw std::runtime_error("cannot write " + path);
}

/* PXR24 rounds only floats, B44 only halves. */
bool is_lossless(Compression compression, PixelType type)
{
    if (compression == PXR24_COMPRESSION)
        return type != FLOAT;
    if (compression == B44_COMPRESSION || compression == B44A_COMPRESSION)
        return type != HALF;
    return compression <= PIZ_COMPRESSION;
}

void check_lossless(const std::string &path, const Picture &written, const Picture &read)
{
    for (size_t c = 0; c < written.channels.size(); c++)
        if (is_lossless(written.compression, written.channels[c].type) &&
            written.channels[c].samples != read.channels[c].samples)
            throw std::runtime_error(path + " does not hold what was written");
}

void write(const std::string &stem, Picture picture)
{
    const std::string path = stem + ".exr";
    {
        OutputFile file(path.c_str(), make_header(picture));
        file.setFrameBuffer(make_frame_buffer(picture));
        file.writePixels(picture.height());
    }
    const Picture read = read_back(path, picture);
    check_lossless(path, picture, read);
    write_raw(stem + ".raw", read);
}

/* ---- every compression, type, number of channels and size ------------------------------------ */

const struct {
    const char *name;
    Compression compression;
} compressions[] = {
    {"none", NO_COMPRESSION},   {"rle", RLE_COMPRESSION},   {"zips", ZIPS_COMPRESSION},
    {"zip", ZIP_COMPRESSION},   {"piz", PIZ_COMPRESSION},   {"pxr24", PXR24_COMPRESSION},
    {"b44", B44_COMPRESSION},   {"b44a", B44A_COMPRESSION}, {"dwaa", DWAA_COMPRESSION},
    {"dwab", DWAB_COMPRESSION},
};

const struct {
    const char *name;
    PixelType of[5];
} types[] = {
    {"half", {HALF, HALF, HALF, HALF, HALF}},
    {"float", {FLOAT, FLOAT, FLOAT, FLOAT, FLOAT}},
    {"uint", {UINT, UINT, UINT, UINT, UINT}},
    {"mixed", {FLOAT, HALF, UINT, HALF, FLOAT}},
};

const int sizes[][2] = {{1, 1}, {7, 5}, {33, 31}, {64, 40}};

void write_all_sorts(const std::string &folder)
{
    for (const auto &kind : compressions)
        for (const auto &type : types)
            for (size_t count = 1; count <= 5; count++)
                for (const auto &size : sizes) {
                    char name[64];
                    std::snprintf(name, sizeof(name), "/%s_%s_%zu_%dx%d", kind.name, type.name,
                                  count, size[0], size[1]);
                    write(folder + name,
                          make(size[0], size[1], kind.compression, {type.of, type.of + count}));
                }
}

void write_linear(const std::string &folder)
{
    for (const auto &kind : compressions) {
        Picture picture = make(33, 31, kind.compression, {HALF, HALF, HALF});
        for (Channel &channel : picture.channels)
            channel.is_linear = true;
        write(folder + "/" + kind.name + "_linear", picture);
    }
}

/* ---- windows and orders ---------------------------------------------------------------------- */

/* The last chunk first. */
void write_upwards(const std::string &folder)
{
    for (const auto &kind : compressions) {
        Picture picture = make(33, 70, kind.compression, {HALF, HALF, HALF, HALF, FLOAT});
        picture.order = DECREASING_Y;
        write(folder + "/" + kind.name + "_upwards", picture);
    }
}

void write_windows(const std::string &folder)
{
    for (const auto &kind : compressions) {
        Picture picture = make(33, 31, kind.compression, {HALF, HALF, HALF});
        picture.window = Box2i(V2i(-5, 13), V2i(27, 43));
        picture.display = Box2i(V2i(0, 0), V2i(99, 59));
        write(folder + "/" + kind.name + "_window", picture);
    }
}

/* ---- tiles ----------------------------------------------------------------------------------- */

void write_level(TiledOutputFile &file, Picture &picture, int x, int y)
{
    /* Smaller levels have the first samples of the full size: only their number matters. */
    file.setFrameBuffer(make_frame_buffer(picture));
    file.writeTiles(0, file.numXTiles(x) - 1, 0, file.numYTiles(y) - 1, x, y);
}

void write_tiled(const std::string &stem, Picture picture, const TileDescription &tiles)
{
    const std::string path = stem + ".exr";
    {
        Header header = make_header(picture);
        header.setTileDescription(tiles);
        TiledOutputFile file(path.c_str(), header);
        for (int y = 0; y < file.numYLevels(); y++)
            for (int x = 0; x < file.numXLevels(); x++)
                if (tiles.mode == RIPMAP_LEVELS || x == y)
                    write_level(file, picture, x, y);
    }
    const Picture read = read_back(path, picture);
    check_lossless(path, picture, read);
    write_raw(stem + ".raw", read);
}

const struct {
    const char *name;
    LevelMode mode;
    LevelRoundingMode rounding;
} levels[] = {
    {"one", ONE_LEVEL, ROUND_DOWN},
    {"mipmap", MIPMAP_LEVELS, ROUND_DOWN},
    {"mipmap_up", MIPMAP_LEVELS, ROUND_UP},
    {"ripmap", RIPMAP_LEVELS, ROUND_UP},
};

const unsigned tile_sizes[][2] = {{16, 16}, {7, 3}, {64, 128}};

void write_all_tiles(const std::string &folder)
{
    char name[96];
    for (const auto &kind : compressions)
        for (const auto &type : types)
            for (const auto &size : tile_sizes) {
                std::snprintf(name, sizeof(name), "/%s_tiles_%s_%ux%u", kind.name, type.name,
                              size[0], size[1]);
                write_tiled(folder + name, make(33, 31, kind.compression, {type.of, type.of + 5}),
                            TileDescription(size[0], size[1], ONE_LEVEL));
            }
    for (const auto &level : levels) {
        std::snprintf(name, sizeof(name), "/zip_levels_%s", level.name);
        Picture picture = make(33, 31, ZIP_COMPRESSION, {HALF, HALF, HALF});
        picture.window = Box2i(V2i(-5, 13), V2i(27, 43));
        picture.order = RANDOM_Y;
        write_tiled(folder + name, picture, TileDescription(8, 4, level.mode, level.rounding));
    }
}

/* ---- attributes: only .exr ------------------------------------------------------------------- */

void write_header_alone(const std::string &path, const Header &header)
{
    Picture picture = make(7, 5, ZIP_COMPRESSION, {HALF});
    OutputFile file(path.c_str(), header);
    file.setFrameBuffer(make_frame_buffer(picture));
    file.writePixels(picture.height());
}

void write_attributes(const std::string &folder)
{
    using IMATH_NAMESPACE::V2f;
    const Header plain = make_header(make(7, 5, ZIP_COMPRESSION, {HALF}));
    Header aces = plain, rec709 = plain, wide = plain, texts = plain;
    addChromaticities(aces, Chromaticities(V2f(0.7347f, 0.2653f), V2f(0.0f, 1.0f),
                                           V2f(0.0001f, -0.077f), V2f(0.32168f, 0.33767f)));
    addChromaticities(rec709, Chromaticities());
    wide.pixelAspectRatio() = 2.0f;
    for (const char *name : {"crop", "primaries", "pixel_aspect", "encoding", "other"})
        texts.insert(name, StringAttribute("text"));
    write_header_alone(folder + "/aces.exr", aces);
    write_header_alone(folder + "/rec709.exr", rec709);
    write_header_alone(folder + "/wide.exr", wide);
    write_header_alone(folder + "/texts.exr", texts);
}

/* ---- other kinds: only .exr ------------------------------------------------------------------ */

Header make_part_header(const Picture &picture, const char *name, const std::string &type)
{
    Header header = make_header(picture);
    header.setName(name);
    header.setType(type);
    return header;
}

void write_scanline_part(MultiPartOutputFile &file, int number, Picture picture)
{
    OutputPart part(file, number);
    part.setFrameBuffer(make_frame_buffer(picture));
    part.writePixels(picture.height());
}

void write_tiled_part(MultiPartOutputFile &file, int number, Picture picture)
{
    TiledOutputPart part(file, number);
    part.setFrameBuffer(make_frame_buffer(picture));
    part.writeTiles(0, part.numXTiles(0) - 1, 0, part.numYTiles(0) - 1, 0);
}

/* Two parts with colour, a tiled one without. */
void write_parts(const std::string &folder)
{
    const Picture left = make(33, 31, ZIP_COMPRESSION, {HALF, HALF, HALF, HALF}),
                  right = make(33, 31, PIZ_COMPRESSION, {FLOAT, FLOAT, FLOAT, FLOAT, FLOAT}),
                  tiles = make(33, 31, NO_COMPRESSION, {HALF});
    std::vector<Header> headers = {make_part_header(left, "left", SCANLINEIMAGE),
                                   make_part_header(right, "right", SCANLINEIMAGE),
                                   make_part_header(tiles, "0", TILEDIMAGE)};
    headers[2].setTileDescription(TileDescription(16, 16, ONE_LEVEL));
    MultiPartOutputFile file((folder + "/parts.exr").c_str(), headers.data(), 3);
    write_scanline_part(file, 0, left);
    write_scanline_part(file, 1, right);
    write_tiled_part(file, 2, tiles);
    write_raw(folder + "/parts_left.raw", left);
    write_raw(folder + "/parts_right.raw", right);
    write_raw(folder + "/parts_0.raw", tiles);
}

/* One deep sample of 0.5 at each of 2x2 pixels. */
template <typename File> void write_deep_samples(File &file)
{
    std::vector<unsigned> counts(4, 1);
    std::vector<float> samples(4, 0.5f);
    std::vector<float *> pointers;
    for (float &sample : samples)
        pointers.push_back(&sample);
    DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(Slice(UINT, reinterpret_cast<char *>(counts.data()),
                                        sizeof(unsigned), 2 * sizeof(unsigned)));
    buffer.insert("A", DeepSlice(FLOAT, reinterpret_cast<char *>(pointers.data()), sizeof(float *),
                                 2 * sizeof(float *), sizeof(float)));
    file.setFrameBuffer(buffer);
    file.writePixels(2);
}

void write_deep(const std::string &folder)
{
    Header header = make_header(make(2, 2, ZIPS_COMPRESSION, {FLOAT}));
    header.setType(DEEPSCANLINE);
    DeepScanLineOutputFile file((folder + "/deep.exr").c_str(), header);
    write_deep_samples(file);
}

/* One flat part with colour behind a deep part. */
void write_deep_part(const std::string &folder)
{
    const Picture flat = make(2, 2, ZIP_COMPRESSION, {HALF, HALF, HALF, HALF}),
                  deep = make(2, 2, ZIPS_COMPRESSION, {FLOAT});
    std::vector<Header> headers = {make_part_header(deep, "deep", DEEPSCANLINE),
                                   make_part_header(flat, "flat", SCANLINEIMAGE)};
    headers[0].setVersion(1);
    MultiPartOutputFile file((folder + "/deep_part.exr").c_str(), headers.data(), 2);
    DeepScanLineOutputPart part(file, 0);
    write_deep_samples(part);
    write_scanline_part(file, 1, flat);
    write_raw(folder + "/deep_part.raw", flat);
}

/* B, R and G (the order of BY, RY, Y) of the pixels that the library reads. */
void write_chroma_raw(const std::string &stem)
{
    RgbaInputFile file((stem + ".exr").c_str());
    std::vector<Rgba> pixels(CHROMA_WIDTH * CHROMA_HEIGHT);
    file.setFrameBuffer(pixels.data(), 1, CHROMA_WIDTH);
    file.readPixels(0, CHROMA_HEIGHT - 1);
    std::ofstream out(stem + ".raw", std::ios::binary);
    for (half Rgba::*colour : {&Rgba::b, &Rgba::r, &Rgba::g})
        for (const Rgba &pixel : pixels) {
            const float value = pixel.*colour;
            out.write(reinterpret_cast<const char *>(&value), sizeof(value));
        }
    if (!out.flush())
        throw std::runtime_error("cannot write " + stem + ".raw");
}

/* Y at every pixel, RY and BY at every second one, of smooth colours in which OpenEXR's reader
 * limits no saturation. */
void write_luminance_chroma(const std::string &folder)
{
    using IMATH_NAMESPACE::V2f;
    std::vector<Rgba> pixels;
    for (int y = 0; y < CHROMA_HEIGHT; y++)
        for (int x = 0; x < CHROMA_WIDTH; x++)
            pixels.push_back(Rgba(0.5f + 0.2f * std::sin(0.21f * static_cast<float>(x)),
                                  0.5f + 0.1f * std::sin(0.17f * static_cast<float>(x + y)),
                                  0.5f + 0.2f * std::cos(0.13f * static_cast<float>(y))));
    for (const auto &kind : compressions) {
        if (kind.compression >= DWAA_COMPRESSION)
            continue;
        const std::string stem = folder + "/chroma_" + kind.name;
        Header header(CHROMA_WIDTH, CHROMA_HEIGHT);
        header.compression() = kind.compression;
        if (kind.compression == PIZ_COMPRESSION) /* ACES */
            addChromaticities(header,
                              Chromaticities(V2f(0.7347f, 0.2653f), V2f(0.0f, 1.0f),
                                             V2f(0.0001f, -0.077f), V2f(0.32168f, 0.33767f)));
        {
            RgbaOutputFile file((stem + ".exr").c_str(), header, WRITE_YC);
            file.setFrameBuffer(pixels.data(), 1, CHROMA_WIDTH);
            file.writePixels(CHROMA_HEIGHT);
        }
        write_chroma_raw(stem);
    }
}

} // namespace

int main(int argc, char **argv)
{
    if (argc != 2)
        return 64;
    const std::string folder = argv[1];
    try {
        write_all_sorts(folder);
        write_linear(folder);
        write_upwards(folder);
        write_windows(folder);
        write_all_tiles(folder);
        write_attributes(folder);
        write_parts(folder);
        write_deep(folder);
        write_deep_part(folder);
        write_luminance_chroma(folder);
    } catch (const std::exception &error) {
        std::fprintf(stderr, "make_exr: %s\n", error.what());
        return 1;
    }
    return 0;
}
