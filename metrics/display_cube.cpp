/* SPDX-License-Identifier: MIT
 *
 * Bakes a view of an OpenColorIO config.
 */
extern "C" {
#include "base/files.h"
#include "base/status.h"
}
#include "metrics/display_cube.h"
#include "metrics/ocio.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace ocio = OCIO_NAMESPACE;

namespace
{

constexpr int side = NEPH_DISPLAY_CUBE_SIDE;
constexpr size_t node_count = static_cast<size_t>(side) * side * side;
constexpr double knee = 1.0 / 512.0, top = 64.0; /* 15 stops of logarithm above the knee */
constexpr int probe_count = 20000;

double cube_axis_value(double place)
{
    return knee * (std::exp2(place * std::log2(1.0 + top / knee)) - 1.0);
}

double axis_position(double value)
{
    const double place = std::log2(1.0 + std::max(value, 0.0) / knee) / std::log2(1.0 + top / knee);
    return std::min(place, 1.0);
}

/* The names in a config, for the message about an unknown name. */
std::string list_config_names(const ocio::ConstConfigRcPtr &config, const char *display)
{
    std::string names;
    const int count = display ? config->getNumViews(display) : config->getNumDisplays();
    for (int i = 0; i < count; i++)
        names += std::string(i ? ", " : "") +
                 (display ? config->getView(display, i) : config->getDisplay(i));
    return names;
}

bool has_view(const ocio::ConstConfigRcPtr &config, const char *display, const char *view)
{
    for (int i = 0; i < config->getNumViews(display); i++)
        if (std::strcmp(config->getView(display, i), view) == 0)
            return true;
    return false;
}

bool has_display(const ocio::ConstConfigRcPtr &config, const char *display)
{
    for (int i = 0; i < config->getNumDisplays(); i++)
        if (std::strcmp(config->getDisplay(i), display) == 0)
            return true;
    return false;
}

enum neph_status check_names(const ocio::ConstConfigRcPtr &config, const char *space,
                             const char *display, const char *view, struct neph_diag *diag)
{
    if (!config->getColorSpace(space))
        return neph_fail(diag, NEPH_ERR_INPUT, "the OpenColorIO config has no color space '%s'",
                         space);
    if (!has_display(config, display))
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "the OpenColorIO config has no display '%s'; it has %s", display,
                         list_config_names(config, nullptr).c_str());
    if (!has_view(config, display, view))
        return neph_fail(diag, NEPH_ERR_INPUT, "display '%s' has no view '%s'; it has %s", display,
                         view, list_config_names(config, display).c_str());
    return NEPH_OK;
}

bool has_nan_channel(const float rgb[3])
{
    return std::isnan(rgb[0]) || std::isnan(rgb[1]) || std::isnan(rgb[2]);
}

/* Convert colours to codes; returns the number of colours with a NaN. */
int apply(const ocio::ConstCPUProcessorRcPtr &processor, std::vector<float> &rgb)
{
    int not_numbers = 0;
    ocio::PackedImageDesc image(rgb.data(), static_cast<long>(rgb.size() / 3), 1, 3);
    processor->apply(image);
    for (size_t i = 0; i < rgb.size(); i += 3)
        not_numbers += has_nan_channel(&rgb[i]);
    for (float &value : rgb)
        value = std::isinf(value) && value > 0.0f ? 255.0f
                : std::isfinite(value)            ? 255.0f * value
                                                  : 0.0f; // NaN, or the logarithm of 0
    return not_numbers;
}

double clamp_code(double code)
{
    return std::clamp(code, 0.0, 255.0);
}

void fill(const ocio::ConstCPUProcessorRcPtr &processor, struct neph_display_cube *cube)
{
    std::vector<float> rgb(3 * node_count);
    for (size_t i = 0; i < node_count; i++) {
        const size_t steps[3] = {i % side, i / side % side, i / side / side};
        for (size_t c = 0; c < 3; c++)
            rgb[3 * i + c] = static_cast<float>(
                cube_axis_value(static_cast<double>(steps[c]) / (side - 1)));
    }
    cube->not_numbers += apply(processor, rgb);
    for (size_t i = 0; i < node_count; i++)
        for (size_t c = 0; c < 3; c++)
            cube->nodes[c][i] = rgb[3 * i + c];
}

/* Trilinear lookup, as users of the table do it. */
void look_up(const struct neph_display_cube *cube, const float rgb[3], double out[3])
{
    int low[3];
    double share[3];
    for (int c = 0; c < 3; c++) {
        const double place = axis_position(static_cast<double>(rgb[c])) * (side - 1);
        low[c] = std::min(static_cast<int>(place), side - 2);
        share[c] = place - low[c];
        out[c] = 0.0;
    }
    for (int corner = 0; corner < 8; corner++) {
        double weight = 1.0;
        size_t node = 0;
        for (int c = 2; c >= 0; c--) {
            const int up = corner >> c & 1;
            weight *= up ? share[c] : 1.0 - share[c];
            node = node * side + static_cast<size_t>(low[c] + up);
        }
        for (int c = 0; c < 3; c++)
            out[c] += weight * static_cast<double>(cube->nodes[c][node]);
    }
}

/* Random test colours: any brightness on the axis, each channel within a factor of 2 of it. */
std::vector<float> make_test_colours()
{
    std::vector<float> rgb(3 * static_cast<size_t>(probe_count));
    uint64_t state = 1;
    for (size_t i = 0; i < rgb.size(); i += 3) {
        double draws[4];
        for (double &draw : draws) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            draw = static_cast<double>(state >> 11) / 9007199254740992.0;
        }
        for (size_t c = 0; c < 3; c++)
            rgb[i + c] = static_cast<float>(cube_axis_value(draws[3]) *
                                            std::exp2(2.0 * draws[c] - 1.0));
    }
    return rgb;
}

void measure(const ocio::ConstCPUProcessorRcPtr &processor, struct neph_display_cube *cube)
{
    const std::vector<float> linear = make_test_colours();
    std::vector<float> truth = linear;
    double sum = 0.0;
    apply(processor, truth);
    cube->error_max = 0.0;
    for (size_t i = 0; i < linear.size(); i += 3) {
        double out[3];
        look_up(cube, &linear[i], out);
        for (size_t c = 0; c < 3; c++) {
            const double error = std::fabs(clamp_code(out[c]) -
                                           clamp_code(static_cast<double>(truth[i + c])));
            sum += error;
            cube->error_max = std::max(cube->error_max, error);
        }
    }
    cube->error_mean = sum / static_cast<double>(linear.size());
}

enum neph_status bake(const struct neph_display_choice *choice, struct neph_display_cube *cube,
                      struct neph_diag *diag)
{
    const ocio::ConstConfigRcPtr config = ocio::Config::CreateFromFile(choice->config);
    const bool by_aces = !choice->space && config->hasRole(ocio::ROLE_INTERCHANGE_SCENE);
    const char *space = choice->space ? choice->space
                        : by_aces     ? ocio::ROLE_INTERCHANGE_SCENE
                                      : ocio::ROLE_SCENE_LINEAR;
    const char *display = choice->display ? choice->display : config->getDefaultDisplay();
    const char *view = choice->view ? choice->view : config->getDefaultView(display);
    enum neph_status status = check_names(config, space, display, view, diag);
    if (status)
        return status;
    ocio::DisplayViewTransformRcPtr transform = ocio::DisplayViewTransform::Create();
    transform->setSrc(space);
    transform->setDisplay(display);
    transform->setView(view);
    const ocio::GroupTransformRcPtr group = ocio::GroupTransform::Create();
    if (by_aces)
        group->appendTransform(neph_ocio::make_aces_matrix(ocio::TRANSFORM_DIR_INVERSE));
    group->appendTransform(transform);
    status = neph_ocio::check_transform(config, config->getCurrentContext(), group, diag);
    if (status)
        return status;
    const ocio::ConstProcessorRcPtr whole = config->getProcessor(group);
    const ocio::ConstCPUProcessorRcPtr processor = whole->getOptimizedCPUProcessor(
        neph_ocio::optimization);
    cube->not_numbers = neph_ocio::count_nan_entries(whole);
    std::snprintf(cube->name, sizeof(cube->name), "%.60s on %.60s", view, display);
    cube->knee = knee;
    cube->top = top;
    cube->nodes[0] = static_cast<float *>(std::malloc(3 * node_count * sizeof(float)));
    if (!cube->nodes[0])
        return neph_fail_memory(diag);
    cube->nodes[1] = cube->nodes[0] + node_count;
    cube->nodes[2] = cube->nodes[1] + node_count;
    fill(processor, cube);
    measure(processor, cube);
    return NEPH_OK;
}

} // namespace

enum neph_status neph_display_cube_bake(const struct neph_display_choice *choice,
                                        struct neph_display_cube *cube, struct neph_diag *diag)
{
    struct neph_display_cube made = {};
    if (!neph_path_exists(choice->config))
        return neph_fail(diag, NEPH_ERR_NOT_FOUND, "there is no OpenColorIO config '%s'",
                         choice->config);
    const enum neph_status status = neph_ocio::run(choice->config, diag,
                                                   [&] { return bake(choice, &made, diag); });
    if (status)
        neph_display_cube_finish(&made);
    else
        *cube = made;
    return status;
}

void neph_display_cube_finish(struct neph_display_cube *cube)
{
    std::free(cube->nodes[0]);
    *cube = {};
}
