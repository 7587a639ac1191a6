/* SPDX-License-Identifier: MIT
 *
 * Shader specialization by SPIRV-Tools (specialize.h). The only file that uses SPIRV-Tools; catches
 * all of its exceptions.
 */
extern "C" {
#include "renderer/specialize.h"
}

#include <cstdlib>
#include <cstring>
#include <exception>
#include <iterator>
#include <new>
#include <string>
#include <unordered_map>
#include <vector>

#include <spirv-tools/optimizer.hpp>

namespace
{

/* Passes of spirv-opt, by their flags. Excluded: --redundancy-elimination, because it moves values
 * so that lavapipe loses them at loop exits (docs/devices.md); loop unrolling, because the driver
 * unrolls marked loops. */
const std::vector<std::string> passes = {
    /* Remove the code that the constants exclude, function by function. */
    "--freeze-spec-const",
    "--fold-spec-const-op-composite",
    "--ccp",
    "--eliminate-dead-branches",
    "--eliminate-dead-code-aggressive",
    /* Inline everything into one function with local variables. */
    "--merge-return",
    "--inline-entry-points-exhaustive",
    "--eliminate-dead-functions",
    "--private-to-local",
    /* Remove the code excluded by arguments, which are known now. */
    "--eliminate-local-single-store",
    "--ccp",
    "--eliminate-dead-branches",
    /* Replace variables by values. */
    "--scalar-replacement=100",
    "--convert-local-access-chains",
    "--eliminate-local-single-block",
    "--eliminate-local-single-store",
    "--eliminate-dead-code-aggressive",
    "--ssa-rewrite",
    "--ccp",
    "--eliminate-dead-branches",
    "--eliminate-dead-code-aggressive",
    /* Simplify. */
    "--simplify-instructions",
    "--eliminate-dead-code-aggressive",
    "--merge-blocks",
};

using Values = std::unordered_map<uint32_t, std::vector<uint32_t>>;

Values values_of(const uint32_t *constants, int count)
{
    Values values;
    for (int i = 0; i < count; i++)
        values[static_cast<uint32_t>(i)] = {constants[i]};
    return values;
}

/* Capabilities that all kernels of a shader declare but only a CPU's kernels use: 64-bit integers
 * and texel buffers, which a GPU may lack. A capability is removed when no type needs it any more.
 * (SPIRV-Tools can do this since 2023.4: --trim-capabilities.) */
constexpr uint32_t op_capability = 17, op_type_int = 21, op_type_image = 25, dim_buffer = 5;
const struct {
    uint32_t capability, type, operand, value;
} idle_capabilities[] = {
    {11, op_type_int, 2, 64},           /* Int64 */
    {47, op_type_image, 3, dim_buffer}, /* ImageBuffer */
    {49, op_type_image, 3, dim_buffer}, /* StorageImageExtendedFormats */
};

void remove_idle(std::vector<uint32_t> *words, size_t row)
{
    constexpr size_t header_words = 5;
    const auto &idle = idle_capabilities[row];
    size_t at_capability = 0;
    for (size_t at = header_words; at < words->size(); at += (*words)[at] >> 16) {
        const uint32_t operation = (*words)[at] & 0xffff;
        if (operation == op_capability && (*words)[at + 1] == idle.capability)
            at_capability = at;
        if (operation == idle.type && (*words)[at + idle.operand] == idle.value)
            return;
    }
    const auto first = words->begin() + static_cast<std::ptrdiff_t>(at_capability);
    if (at_capability > 0)
        words->erase(first, first + 2);
}

/* The optimiser's message when it refuses the shader; empty: success. */
std::string optimize(const uint32_t *words, size_t word_count, const Values &values,
                     std::vector<uint32_t> *optimized)
{
    std::string said;
    spvtools::Optimizer optimizer(SPV_ENV_VULKAN_1_2);
    optimizer.SetMessageConsumer([&said](spv_message_level_t, const char *, const spv_position_t &,
                                         const char *message) { said = message; });
    if (!values.empty())
        optimizer.RegisterPass(spvtools::CreateSetSpecConstantDefaultValuePass(values));
    if (!optimizer.RegisterPassesFromFlags(passes))
        return "unknown pass: " + said;
    spvtools::OptimizerOptions options;
    options.set_run_validator(false); /* the build has validated it */
    if (optimizer.Run(words, word_count, optimized, options))
        return "";
    return said.empty() ? "no message" : said;
}

std::string version()
{
    std::string text = spvSoftwareVersionDetailsString();
    text += " without idle capabilities";
    for (const std::string &pass : passes)
        text += " " + pass;
    return text;
}

} // namespace

extern "C" enum neph_status neph_specialize(const uint32_t *words, size_t size_bytes,
                                            const uint32_t *constants, int count,
                                            uint32_t **specialized, size_t *specialized_bytes,
                                            struct neph_diag *diag)
try {
    std::vector<uint32_t> optimized;
    const std::string refusal = optimize(words, size_bytes / sizeof(*words),
                                         values_of(constants, count), &optimized);
    if (!refusal.empty())
        return neph_fail(diag, NEPH_ERR_INTERNAL, "SPIRV-Tools refuses to specialise it: %s",
                         refusal.c_str());
    for (size_t row = 0; row < std::size(idle_capabilities); row++)
        remove_idle(&optimized, row);
    const size_t bytes = optimized.size() * sizeof(uint32_t);
    *specialized = static_cast<uint32_t *>(std::malloc(bytes));
    if (!*specialized)
        return neph_fail_memory(diag);
    std::memcpy(*specialized, optimized.data(), bytes);
    *specialized_bytes = bytes;
    return NEPH_OK;
} catch (const std::bad_alloc &) {
    return neph_fail_memory(diag);
} catch (const std::exception &error) {
    return neph_fail(diag, NEPH_ERR_INTERNAL, "SPIRV-Tools fails: %s", error.what());
}

extern "C" const char *neph_specialize_version(void)
{
    static const std::string text = version();
    return text.c_str();
}
