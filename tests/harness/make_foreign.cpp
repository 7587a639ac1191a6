// SPDX-License-Identifier: MIT
//
// Writes files of all formats that OpenImageIO writes here, and what it reads of each:
//
//     make_foreign FOLDER
//
// For each file FOLDER/NAME there is FOLDER/NAME.samples: width, height and channel count as
// int32_t, then the channels one after the other as floats, integers divided by their largest
// value.
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <OpenImageIO/imageio.h>

using namespace OIIO;

namespace
{

constexpr int width = 19, height = 13;

struct kind {
    const char *extension;
    TypeDesc type;
    int channels;
    int tile; // side; 0: scanlines
};

/* Numbers from 1/16 on: steps of 1/32, which halfs have exactly. */
std::vector<float> make_samples(const kind &wanted)
{
    std::vector<float> samples;
    for (int i = 0; i < width * height * wanted.channels; i++)
        samples.push_back(static_cast<float>(2 + i * 7 % 29) / 32.0f);
    for (int i = 3; wanted.channels == 4 && i < width * height * 4; i += 4)
        samples[static_cast<size_t>(i)] = 1.0f; // opaque
    return samples;
}

void write_file(const std::string &path, const kind &wanted)
{
    ImageSpec spec(width, height, wanted.channels, wanted.type);
    spec.tile_width = spec.tile_height = wanted.tile;
    spec.attribute("compression", "zip");
    if (wanted.type != TypeDesc::UINT8 && !wanted.type.is_floating_point())
        spec.attribute("oiio:ColorSpace", "sRGB");
    const auto output = ImageOutput::create(path);
    if (!output || !output->open(path, spec) ||
        !output->write_image(TypeDesc::FLOAT, make_samples(wanted).data()) || !output->close())
        throw std::runtime_error(path + ": " + (output ? output->geterror() : geterror()));
}

void write_reading(const std::string &path)
{
    const auto input = ImageInput::open(path);
    if (!input)
        throw std::runtime_error(path + ": " + geterror());
    const ImageSpec &spec = input->spec();
    const int32_t head[3] = {spec.width, spec.height, spec.nchannels};
    const auto count = static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height);
    std::vector<float> samples(count * static_cast<size_t>(spec.nchannels));
    if (!input->read_image(0, 0, 0, spec.nchannels, TypeDesc::FLOAT, samples.data()))
        throw std::runtime_error(path + ": " + input->geterror());
    std::ofstream out(path + ".samples", std::ios::binary);
    out.write(reinterpret_cast<const char *>(head), sizeof(head));
    for (size_t c = 0; c < static_cast<size_t>(spec.nchannels); c++)
        for (size_t i = 0; i < count; i++)
            out.write(reinterpret_cast<const char *>(
                          &samples[i * static_cast<size_t>(spec.nchannels) + c]),
                      sizeof(float));
}

} // namespace

int main(int argc, char **argv)
{
    std::vector<kind> kinds;
    for (const int channels : {1, 3, 4}) {
        for (const auto type : {TypeDesc::UINT8, TypeDesc::UINT16, TypeDesc::HALF, TypeDesc::FLOAT})
            for (const int tile : {0, 16})
                kinds.push_back({"tif", type, channels, tile});
        for (const auto type : {TypeDesc::HALF, TypeDesc::FLOAT})
            for (const int tile : {0, 16})
                kinds.push_back({"exr", type, channels, tile});
        for (const auto type : {TypeDesc::UINT8, TypeDesc::UINT16})
            kinds.push_back({"png", type, channels, 0});
    }
    for (const int channels : {1, 3}) {
        kinds.push_back({"ppm", TypeDesc::UINT8, channels, 0});
        kinds.push_back({"jpg", TypeDesc::UINT8, channels, 0});
    }
    kinds.push_back({"hdr", TypeDesc::FLOAT, 3, 0});
    kinds.push_back({"webp", TypeDesc::UINT8, 3, 0});
    kinds.push_back({"webp", TypeDesc::UINT8, 4, 0});
    try {
        for (const kind &wanted : kinds) {
            const std::string path = std::string(argc > 1 ? argv[1] : ".") + "/" +
                                     wanted.type.c_str() + "_" + std::to_string(wanted.channels) +
                                     "_" + std::to_string(wanted.tile) + "." + wanted.extension;
            write_file(path, wanted);
            write_reading(path);
        }
    } catch (const std::exception &error) {
        fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
