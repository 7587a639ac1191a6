/* SPDX-License-Identifier: MIT
 *
 * Encodes display values through OpenColorIO.
 */
extern "C" {
#include "base/status.h"
}
#include "metrics/display.h"
#include "metrics/ocio.h"

#include <algorithm>
#include <cmath>

namespace ocio = OCIO_NAMESPACE;

namespace
{

constexpr size_t block_pixels = 4096;
constexpr double exposure_max_ev = 64.0;

/* Clamp before encoding: far above white, so it loses nothing, and finite, because infinity
 * times a zero of a general colour matrix is NaN, and the rounding of a value such as 1e30 is
 * visible in other channels. (OpenColorIO 2.1 folds the matrices used here into a scale, which
 * avoids both.) */
constexpr float exposed_max = 256.0f;

/* Linear Rec.709 to CIE XYZ with white D65, exact from the primaries of ITU-R BT.709 and the white
 * (0.3127, 0.3290); the same fractions as in CSS Color Module Level 4, section 17. */
constexpr double xyz_from_rec709[16] = {506752.0 / 1228815.0,
                                        87881.0 / 245763.0,
                                        12673.0 / 70218.0,
                                        0.0,
                                        87098.0 / 409605.0,
                                        175762.0 / 245763.0,
                                        12673.0 / 175545.0,
                                        0.0,
                                        7918.0 / 409605.0,
                                        87881.0 / 737289.0,
                                        1001167.0 / 1053270.0,
                                        0.0,
                                        0.0,
                                        0.0,
                                        0.0,
                                        1.0};

ocio::ConstCPUProcessorRcPtr create_processor(double scale)
{
    const double exposure[16] = {scale, 0, 0, 0, 0, scale, 0, 0, 0, 0, scale, 0, 0, 0, 0, 1};
    ocio::MatrixTransformRcPtr expose = ocio::MatrixTransform::Create();
    expose->setMatrix(exposure);
    ocio::MatrixTransformRcPtr to_xyz = ocio::MatrixTransform::Create();
    to_xyz->setMatrix(xyz_from_rec709);
    ocio::BuiltinTransformRcPtr to_display = ocio::BuiltinTransform::Create();
    to_display->setStyle("DISPLAY - CIE-XYZ-D65_to_sRGB");
    ocio::GroupTransformRcPtr group = ocio::GroupTransform::Create();
    group->appendTransform(expose);
    group->appendTransform(to_xyz);
    group->appendTransform(to_display);
    return ocio::Config::CreateRaw()->getProcessor(group)->getOptimizedCPUProcessor(
        neph_ocio::optimization);
}

bool has_nan(const float *const rgb[3], size_t pixel)
{
    return std::isnan(rgb[0][pixel]) || std::isnan(rgb[1][pixel]) || std::isnan(rgb[2][pixel]);
}

uint8_t round_to_code(float encoded)
{
    return static_cast<uint8_t>(std::lround(255.0f * std::clamp(encoded, 0.0f, 1.0f)));
}

void encode(const float *const rgb[3], size_t pixel_count, double scale, uint8_t *out_rgb)
{
    const ocio::ConstCPUProcessorRcPtr processor = create_processor(scale);
    const float input_max = exposed_max / static_cast<float>(scale);
    const uint8_t *magenta = neph_display_difference_legend()->not_a_number;
    float block[block_pixels * 3];
    for (size_t first = 0; first < pixel_count; first += block_pixels) {
        const size_t count = std::min(block_pixels, pixel_count - first);
        for (size_t i = 0; i < count; i++) {
            const bool is_nan = has_nan(rgb, first + i);
            for (size_t c = 0; c < 3; c++)
                block[3 * i + c] = is_nan ? 0.0f
                                          : std::clamp(rgb[c][first + i], -input_max, input_max);
        }
        ocio::PackedImageDesc image(block, static_cast<long>(count), 1, 3);
        processor->apply(image);
        for (size_t i = 0; i < count; i++)
            for (size_t c = 0; c < 3; c++)
                out_rgb[3 * (first + i) + c] = has_nan(rgb, first + i)
                                                   ? magenta[c]
                                                   : round_to_code(block[3 * i + c]);
    }
}

} // namespace

enum neph_status neph_display_encode(const float *const rgb[3], size_t pixel_count,
                                     double exposure_ev, uint8_t *out_rgb, struct neph_diag *diag)
{
    if (!(std::fabs(exposure_ev) <= exposure_max_ev))
        return neph_fail(diag, NEPH_ERR_INPUT, "an exposure must be within +-%g EV, not %g",
                         exposure_max_ev, exposure_ev);
    try {
        encode(rgb, pixel_count, std::exp2(exposure_ev), out_rgb);
        return NEPH_OK;
    } catch (const std::bad_alloc &) {
        return neph_fail_memory(diag);
    } catch (const std::exception &error) {
        return neph_fail(diag, NEPH_ERR_INTERNAL, "OpenColorIO: %s", error.what());
    } catch (...) {
        return neph_fail(diag, NEPH_ERR_INTERNAL, "OpenColorIO failed without a word");
    }
}
