/* SPDX-License-Identifier: MIT
 *
 * Written by image_reference.py (numpy, double precision). Do not edit.
 */
#ifndef NEPH_TESTS_METRICS_IMAGE_REFERENCE_H
#define NEPH_TESTS_METRICS_IMAGE_REFERENCE_H

/* clang-format off */
struct image_reference {
    int width_px, height_px, seed;
    double white_cd_per_m2, exposure_ev, stops_mean, stops_p50, stops_p95, pu_mse, ssim_mean, ssim_p5, ssim_first, ssim_last, ssim_display, srgb_ssim, srgb_ssim_luma, srgb_ssim_7x7, ms_ssim, ms_ssim_display, ssim_decimated, mse, mse_shift1, mse_unbiased, noise_variance, mse_mean_reference;
};

static const struct image_reference image_references[] = {
    {.width_px = 193, .height_px = 181, .seed = 1, .white_cd_per_m2 = 100, .exposure_ev = 0, .stops_mean = 0.42778852201901574, .stops_p50 = 0.17871921300678814, .stops_p95 = 1.7606889407323274, .pu_mse = 1017.6257194574589, .ssim_mean = 0.52264170840766511, .ssim_p5 = 0.17871189760336664, .ssim_first = 0.085127561313887282, .ssim_last = 0.61954567709904995, .ssim_display = 0.48049557316853836, .srgb_ssim = 0.44168998942353804, .srgb_ssim_luma = 0.48383301753230679, .srgb_ssim_7x7 = 0.45835028474174999, .ms_ssim = 0.85421381272683272, .ms_ssim_display = 0.81467187762262894, .ssim_decimated = 0, .mse = 0.64459711265074382, .mse_shift1 = 0.061983183777777409, .mse_unbiased = 0.63885409226006806, .noise_variance = 0.0052280180961512719, .mse_mean_reference = 0.6414681013081438},
    {.width_px = 12, .height_px = 11, .seed = 2, .white_cd_per_m2 = 100, .exposure_ev = 0, .stops_mean = 0.74660442739923683, .stops_p50 = 0.52796824999332526, .stops_p95 = 2.0158431067998337, .pu_mse = 2006.1826684946507, .ssim_mean = 0.12731580612301674, .ssim_p5 = 0.12181679434648483, .ssim_first = 0.13342581920805222, .ssim_last = 0.12120579303798129, .ssim_display = 0.30256645558043116, .srgb_ssim = 0.19531991017956774, .srgb_ssim_luma = 0.3138251150129962, .srgb_ssim_7x7 = 0.18437168780930835, .ms_ssim = 0, .ms_ssim_display = 0, .ssim_decimated = 0, .mse = 1.2885249022281531, .mse_shift1 = 0.18725598942149768, .mse_unbiased = 1.2817033396826849, .noise_variance = 0.0049345360861884225, .mse_mean_reference = 1.2841706077257793},
    {.width_px = 61, .height_px = 50, .seed = 3, .white_cd_per_m2 = 250, .exposure_ev = -2, .stops_mean = 0.44533345608447705, .stops_p50 = 0.17999539128030084, .stops_p95 = 1.7917751611012884, .pu_mse = 997.83648933161169, .ssim_mean = 0.50075939976866057, .ssim_p5 = 0.13762913476908428, .ssim_first = 0.14020283568740247, .ssim_last = 0.30165634757709014, .ssim_display = 0.48192706692296444, .srgb_ssim = 0.46693529615331847, .srgb_ssim_luma = 0.4865656346543013, .srgb_ssim_7x7 = 0.4857590618540053, .ms_ssim = 0, .ms_ssim_display = 0, .ssim_decimated = 0, .mse = 0.67371985419851832, .mse_shift1 = 0.066431469839127344, .mse_unbiased = 0.66921387750594341, .noise_variance = 0.0052022552490234375, .mse_mean_reference = 0.67181500513045511},
    {.width_px = 385, .height_px = 391, .seed = 4, .white_cd_per_m2 = 40, .exposure_ev = 1.5, .stops_mean = 0.4381289684478431, .stops_p50 = 0.18105673345019108, .stops_p95 = 1.7715440211547586, .pu_mse = 1077.490769667316, .ssim_mean = 0.50979339964995696, .ssim_p5 = 0.16244235317570332, .ssim_first = 0.13491371531622237, .ssim_last = 0.41385234059257781, .ssim_display = 0.3494541863467403, .srgb_ssim = 0.33445891394182842, .srgb_ssim_luma = 0.34283820324762859, .srgb_ssim_7x7 = 0.33009179681947459, .ms_ssim = 0.85271081559035666, .ms_ssim_display = 0.67666272066137423, .ssim_decimated = 0.76648945988892503, .mse = 0.65943399984013185, .mse_shift1 = 0.061102066557838786, .mse_unbiased = 0.65410072145556963, .noise_variance = 0.0052102240139678298, .mse_mean_reference = 0.65670583346255351},
    {.width_px = 40, .height_px = 176, .seed = 5, .white_cd_per_m2 = 1000, .exposure_ev = 3, .stops_mean = 0.42520921015481655, .stops_p50 = 0.1794748881723989, .stops_p95 = 1.729548811776636, .pu_mse = 490.64656850542718, .ssim_mean = 0.53015846099604347, .ssim_p5 = 0.16077894576059654, .ssim_first = 0.27786355829396442, .ssim_last = 0.8275321546813863, .ssim_display = 0.35393149130249518, .srgb_ssim = 0.35901098474755339, .srgb_ssim_luma = 0.33743755039792139, .srgb_ssim_7x7 = 0.39474343198382272, .ms_ssim = 0, .ms_ssim_display = 0, .ssim_decimated = 0, .mse = 0.63069287972016763, .mse_shift1 = 0.061356966423265866, .mse_unbiased = 0.62655174398060998, .noise_variance = 0.0052224868174755214, .mse_mean_reference = 0.62916298738934773},
};

/* clang-format on */

#endif
