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

/* ---- schemes of programs --------------------------------------------------------------------- */

namespace
{

struct scheme {
    const char *program, *layer, *depth; /* "": none */
    std::vector<std::string> channels;
    std::vector<std::string> red_green_blue; /* of the file */
    int x, y; /* corner of the data window; the display window is 30x20 */
};

const std::vector<std::string> rgb = {"R", "G", "B"};

/* Blender's multilayer files; the Movie Render Queue; the Recorder; Mantra; Arnold and V-Ray with
 * windows around the object; the integrator aov; the film gbuffer. */
const std::vector<scheme> schemes = {
    {"blender",
     "ViewLayer.Combined",
     "ViewLayer.Depth.Z",
     {"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B",
      "ViewLayer.Combined.A", "ViewLayer.Depth.Z", "ViewLayer.Vector.X", "ViewLayer.Vector.Y",
      "ViewLayer.Vector.Z", "ViewLayer.Vector.W"},
     {"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B"},
     0,
     0},
    {"unreal",
     "",
     "FinalImageMovieRenderQueue_WorldDepth.R",
     {"R", "G", "B", "A", "FinalImageMovieRenderQueue_WorldDepth.R"},
     rgb,
     0,
     0},
    {"unity", "", "", {"R", "G", "B", "A"}, rgb, 0, 0},
    {"houdini", "", "Pz", {"R", "G", "B", "A", "Pz", "N.x", "N.y", "N.z"}, rgb, 0, 0},
    {"arnold",
     "",
     "",
     {"R", "G", "B", "A", "Z", "diffuse.R", "diffuse.G", "diffuse.B", "P.X", "P.Y", "P.Z"},
     rgb,
     5,
     3},
    {"vray",
     "effectsResult",
     "Z",
     {"R", "G", "B", "A", "Z", "effectsResult.R", "effectsResult.G", "effectsResult.B"},
     {"effectsResult.R", "effectsResult.G", "effectsResult.B"},
     7,
     2},
    {"mitsuba", "", "dd.T", {"R", "G", "B", "A", "dd.T", "nn.X", "nn.Y", "nn.Z"}, rgb, 0, 0},
    {"pbrt",
     "",
     "",
     {"R", "G", "B", "Px", "Py", "Pz", "dzdx", "dzdy", "Nx", "Ny", "Nz", "u", "v", "Albedo.R",
      "Albedo.G", "Albedo.B", "Variance.R", "Variance.G", "Variance.B"},
     rgb,
     0,
     0},
};

struct packing {
    TypeDesc type;
    const char *compression;
    int tile;
};

size_t find(const std::vector<std::string> &names, const std::string &name)
{
    for (size_t i = 0; i < names.size(); i++)
        if (names[i] == name)
            return i;
    throw std::runtime_error("no channel " + name);
}

void write_scheme(const std::string &path, const scheme &wanted, const packing &packed)
{
    const auto channels = static_cast<int>(wanted.channels.size());
    ImageSpec spec(width, height, channels, packed.type);
    spec.channelnames = wanted.channels;
    spec.alpha_channel = spec.z_channel = -1;
    spec.x = wanted.x;
    spec.y = wanted.y;
    spec.full_width = 30;
    spec.full_height = 20;
    spec.tile_width = spec.tile_height = packed.tile;
    spec.attribute("compression", packed.compression);
    const auto output = ImageOutput::create(path);
    if (!output || !output->open(path, spec) ||
        !output->write_image(TypeDesc::FLOAT,
                             make_samples({"", packed.type, channels, 0}).data()) ||
        !output->close())
        throw std::runtime_error(path + ": " + (output ? output->geterror() : geterror()));
    write_reading(path);
    const auto input = ImageInput::open(path);
    const auto &names = input->spec().channelnames;
    std::ofstream out(path + ".scheme");
    for (size_t c = 0; c < 3; c++)
        out << "RGB"[c] << ' ' << find(names, wanted.red_green_blue[c]) << '\n';
    const std::string depth = wanted.depth;
    if (!depth.empty() || std::string(wanted.program) == "arnold")
        out << "Z " << find(names, depth.empty() ? "Z" : depth) << '\n';
    if (*wanted.layer)
        out << "layer " << wanted.layer << '\n';
    if (*wanted.depth)
        out << "depth " << wanted.depth << '\n';
}

void write_schemes(const std::string &folder)
{
    static const packing packings[] = {
        {TypeDesc::HALF, "none", 0},  {TypeDesc::HALF, "zip", 0},   {TypeDesc::HALF, "piz", 16},
        {TypeDesc::FLOAT, "none", 0}, {TypeDesc::FLOAT, "zips", 0}, {TypeDesc::FLOAT, "piz", 0},
        {TypeDesc::FLOAT, "rle", 16}, {TypeDesc::HALF, "zip", 16},
    };
    for (const scheme &wanted : schemes)
        for (const packing &packed : packings)
            write_scheme(folder + "/" + wanted.program + "_" + packed.type.c_str() + "_" +
                             packed.compression + "_" + std::to_string(packed.tile) + ".exr",
                         wanted, packed);
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
        write_schemes(argc > 1 ? argv[1] : ".");
    } catch (const std::exception &error) {
        fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
