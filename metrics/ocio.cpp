/* SPDX-License-Identifier: MIT */
extern "C" {
#include "base/chromaticities.h"
}
#include "metrics/ocio.h"

#include <algorithm>
#include <cmath>

namespace ocio = OCIO_NAMESPACE;

namespace
{

/* SMPTE ST 2065-1:2021: x and y of red, green, blue and white. */
constexpr double aces_chromaticities[8] = {0.7347, 0.2653, 0.0,     1.0,
                                           0.0001, -0.077, 0.32168, 0.33767};

bool has_nan_channel(const float rgb[3])
{
    return std::isnan(rgb[0]) || std::isnan(rgb[1]) || std::isnan(rgb[2]);
}

int count_table_nan(const ocio::Lut3DTransform &table)
{
    const unsigned long size = table.getGridSize();
    int torn = 0;
    for (unsigned long i = 0; i < size * size * size; i++) {
        float rgb[3];
        table.getValue(i / size / size, i / size % size, i % size, rgb[0], rgb[1], rgb[2]);
        torn += has_nan_channel(rgb);
    }
    return torn;
}

int count_table_nan(const ocio::Lut1DTransform &table)
{
    int torn = 0;
    for (unsigned long i = 0; i < table.getLength(); i++) {
        float rgb[3];
        table.getValue(i, rgb[0], rgb[1], rgb[2]);
        torn += has_nan_channel(rgb);
    }
    return torn;
}

} // namespace

int neph_ocio::count_nan_entries(const ocio::ConstProcessorRcPtr &processor)
{
    const ocio::GroupTransformRcPtr group = processor->createGroupTransform();
    int torn = 0;
    for (int i = 0; i < group->getNumTransforms(); i++) {
        const ocio::TransformRcPtr one = group->getTransform(i);
        if (const auto cube = OCIO_DYNAMIC_POINTER_CAST<ocio::Lut3DTransform>(one))
            torn += count_table_nan(*cube);
        else if (const auto curve = OCIO_DYNAMIC_POINTER_CAST<ocio::Lut1DTransform>(one))
            torn += count_table_nan(*curve);
    }
    return torn;
}

ocio::MatrixTransformRcPtr neph_ocio::make_aces_matrix(ocio::TransformDirection direction)
{
    const ocio::MatrixTransformRcPtr transform = ocio::MatrixTransform::Create();
    double matrix[3][3], with_alpha[16] = {};
    neph_matrix_to_rec709(aces_chromaticities, matrix);
    for (size_t i = 0; i < 3; i++)
        std::copy_n(matrix[i], 3, &with_alpha[4 * i]);
    with_alpha[15] = 1.0;
    transform->setMatrix(with_alpha);
    transform->setDirection(direction);
    return transform;
}
