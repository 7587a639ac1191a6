// SPDX-License-Identifier: MIT
//
// Tone curves and display encodings, from scene-linear Rec.709 to the values that a display
// receives. All curves take and return colours >= 0 and keep greys grey. Used by post_tone.comp and
// post_lut.comp.
#ifndef NEPH_TONE_GLSL
#define NEPH_TONE_GLSL

#include "post.glsl"

// --- curves per channel -------------------------------------------------------------------------

// E. Reinhard et al., "Photographic tone reproduction for digital images", SIGGRAPH 2002, eq. 3.
vec3 reinhard(vec3 x) { return x / (1.0 + x); }

// K. Narkowicz, "ACES Filmic Tone Mapping Curve" (2016). Its supremum is 1.033, so the result is
// clamped to 1. Above 1e6 squares could overflow, and the result is 1 to the last digit anyway.
vec3 narkowicz(vec3 x)
{
    x = min(x, vec3(1e6));
    vec3 y = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
    return min(y, vec3(1.0));
}

// --- Khronos PBR Neutral (2024) -----------------------------------------------------------------

// The identity up to 0.76, minus the reflection of a dielectric (4 %). Above, the peak is
// compressed and the colour is desaturated towards white.
vec3 neutral(vec3 colour)
{
    const float FRESNEL = 0.04, START = 0.8 - FRESNEL, DESATURATION = 0.15;
    float least = min(colour.r, min(colour.g, colour.b));
    colour -= least < 2.0 * FRESNEL ? least - least * least / (4.0 * FRESNEL) : FRESNEL;
    float peak = max(colour.r, max(colour.g, colour.b));
    if (peak < START)
        return colour;
    const float ROOM = 1.0 - START;
    float compressed = 1.0 - ROOM * ROOM / (peak + ROOM - START);
    float faded = 1.0 - 1.0 / (DESATURATION * (peak - compressed) + 1.0);
    return mix(colour * (compressed / peak), vec3(compressed), faded);
}

// --- the film curve of Unreal Engine 4.26 -------------------------------------------------------
//
// After ACES 1.0 (Academy S-2014-004): glow and the red modifier in AP0, then a curve per channel
// in AP1. Over log10 of the value, the curve has a straight part, and a logistic toe and shoulder.

const vec3 AP1_LUMINANCE = vec3(0.2722287168, 0.6740817658, 0.0536895174);

float compute_saturation(vec3 ap0)
{
    const float LEAST = 1e-10, LEAST_PEAK = 1e-2;
    float peak = max(ap0.r, max(ap0.g, ap0.b)), least = min(ap0.r, min(ap0.g, ap0.b));
    return (max(peak, LEAST) - max(least, LEAST)) / max(peak, LEAST_PEAK);
}

// ACES YC: luminance plus a part of the chroma.
float luminance_with_chroma(vec3 c)
{
    float chroma = c.b * (c.b - c.g) + c.g * (c.g - c.r) + c.r * (c.r - c.b);
    // = 0, except for rounding
    return (c.r + c.g + c.b + 1.75 * sqrt(max(chroma, 0.0))) / 3.0;
}

// ACES sigmoid shaper: 0 .. 1 over -2 .. 2, from two parabolas.
float shaped(float x)
{
    float t = max(1.0 - abs(0.5 * x), 0.0);
    return 0.5 * (1.0 + sign(x) * (1.0 - t * t));
}

// ACES glow: dark saturated colours get brighter.
vec3 with_glow(vec3 ap0)
{
    const float MIDDLE = 0.08;
    float gain = 0.05 * shaped((compute_saturation(ap0) - 0.4) / 0.2);
    float luminance = luminance_with_chroma(ap0);
    float part = luminance <= 2.0 / 3.0 * MIDDLE ? 1.0
                 : luminance >= 2.0 * MIDDLE     ? 0.0
                                                 : MIDDLE / luminance - 0.5;
    return ap0 * (1.0 + gain * part);
}

// Hue in degrees from red, -180 .. 180; 0 for a grey.
float hue_from_red(vec3 c)
{
    float y = sqrt(3.0) * (c.g - c.b), x = 2.0 * c.r - c.g - c.b;
    return y == 0.0 && x == 0.0 ? 0.0 : degrees(atan(y, x));
}

// ACES red modifier: saturated reds get darker. ACES weights the hue with a B-spline, Unreal with
// this square.
vec3 with_less_red(vec3 ap0)
{
    const float SCALE = 0.82, PIVOT = 0.03, WIDTH_DEG = 135.0;
    float nearness = smoothstep(0.0, 1.0, 1.0 - abs(2.0 * hue_from_red(ap0) / WIDTH_DEG));
    float weight = nearness * nearness * compute_saturation(ap0);
    ap0.r += weight * (PIVOT - ap0.r) * (1.0 - SCALE);
    return ap0;
}

// 2 / (1 + e^x). For large x exp() overflows to infinity, and the result is the correct 0.
float logistic(float exponent) { return 2.0 / (1.0 + exp(exponent)); }

float apply_film_curve(float x)
{
    float slope = setting(POST_FILM_SLOPE), black = setting(POST_FILM_BLACK_CLIP),
          white = setting(POST_FILM_WHITE_CLIP);
    float toe_scale = 1.0 + black - setting(POST_FILM_TOE);
    float shoulder_scale = 1.0 + white - setting(POST_FILM_SHOULDER);
    if (x <= 0.0)
        return -black;
    float place = log2(x) * 0.30102999566; // log10
    float straight = slope * (place + view.straight_match);
    float toe = straight, shoulder = straight;
    if (place < view.toe_match)
        toe = toe_scale * logistic(-2.0 * slope / toe_scale * (place - view.toe_match)) - black;
    if (place > view.shoulder_match)
        shoulder = 1.0 + white - shoulder_scale * logistic(2.0 * slope / shoulder_scale *
                                                           (place - view.shoulder_match));
    float way = clamp((place - view.toe_match) / (view.shoulder_match - view.toe_match), 0.0, 1.0);
    way = view.shoulder_match < view.toe_match ? 1.0 - way : way;
    return mix(toe, shoulder, way * way * (3.0 - 2.0 * way));
}

vec3 unreal(vec3 rec709)
{
    const float BEFORE = 0.96, AFTER = 0.93; // factors of the saturation
    vec3 ap0 = multiply_rows(view.ap1_to_ap0, multiply_rows(view.rec709_to_ap1, rec709));
    ap0 = with_less_red(with_glow(ap0));
    vec3 colour = max(multiply_rows(view.ap0_to_ap1, ap0), vec3(0.0));
    colour = mix(vec3(dot(colour, AP1_LUMINANCE)), colour, BEFORE);
    colour = vec3(apply_film_curve(colour.r), apply_film_curve(colour.g),
                  apply_film_curve(colour.b));
    colour = mix(vec3(dot(colour, AP1_LUMINANCE)), colour, AFTER);
    return max(multiply_rows(view.ap1_to_rec709, max(colour, vec3(0.0))), vec3(0.0));
}

// --- AgX (T. Sobotka, 2022; base look) ----------------------------------------------------------

// The primaries are moved inwards, then each channel is mapped from 16.5 stops around grey. The
// curve is 1/2 with a slope of 2 at grey, and its ends approach 0 and 1 as power functions. The
// result is encoded for a display with gamma 2.2; the last line makes it linear.
float agx_curve(float place)
{
    const float PIVOT = 20.0 / 33.0, SLOPE = 2.0, TOE = 3.0, SHOULDER = 3.25;
    bool is_toe = place < PIVOT;
    float power = is_toe ? TOE : SHOULDER, reach = is_toe ? PIVOT : 1.0 - PIVOT;
    float from = abs(place - PIVOT);
    float bend = (pow(2.0 * SLOPE * reach, power) - 1.0) * pow(from / reach, power);
    float way = SLOPE * from * pow(1.0 + bend, -1.0 / power);
    return clamp(0.5 + (is_toe ? -way : way), 0.0, 1.0);
}

vec3 agx(vec3 rec709)
{
    const float INSET[9] = float[](0.842479062253094, 0.0784335999999992, 0.0792237451477643,
                                   0.0423282422610123, 0.878468636469772, 0.0791661274605434,
                                   0.0423756549057051, 0.0784336, 0.879142973793104);
    const float LEAST_EV = -12.47393, MOST_EV = 4.026069, LEAST = 1e-6;
    vec3 ev = log2(max(multiply_rows(INSET, rec709), vec3(LEAST)));
    vec3 place = clamp((ev - LEAST_EV) / (MOST_EV - LEAST_EV), 0.0, 1.0);
    return pow(vec3(agx_curve(place.r), agx_curve(place.g), agx_curve(place.b)), vec3(2.2));
}

// --- SMPTE ST 2084 (PQ) and ITU-R BT.2390 -------------------------------------------------------

const float PQ_M1 = 2610.0 / 16384.0, PQ_M2 = 2523.0 / 32.0, PQ_C1 = 3424.0 / 4096.0,
            PQ_C2 = 2413.0 / 128.0, PQ_C3 = 2392.0 / 128.0, PQ_NITS = 10000.0;

float encode_pq(float nits)
{
    float y = pow(clamp(nits / PQ_NITS, 0.0, 1.0), PQ_M1);
    return pow((PQ_C1 + PQ_C2 * y) / (1.0 + PQ_C3 * y), PQ_M2);
}

float decode_pq(float code)
{
    float x = pow(code, 1.0 / PQ_M2);
    return PQ_NITS * pow(max(x - PQ_C1, 0.0) / (PQ_C2 - PQ_C3 * x), 1.0 / PQ_M1);
}

// Peak of the display [cd/m^2]; for an SDR display its white.
float peak_nits()
{
    return choice(POST_ENCODE) == POST_ENCODE_PQ ? setting(POST_PEAK_NITS)
                                                 : setting(POST_WHITE_NITS);
}

// ITU-R BT.2390, 5.4.1: PQ codes are unchanged up to a knee, and follow a Hermite spline above it,
// which ends with slope 0 and maps 10000 cd/m^2 to the display's peak. The colour is scaled by the
// change of its largest channel.
vec3 bt2390(vec3 colour)
{
    float most = max(colour.r, max(colour.g, colour.b));
    float code = encode_pq(most * setting(POST_WHITE_NITS)), peak = encode_pq(peak_nits());
    float knee = 1.5 * peak - 0.5;
    if (code <= knee || peak >= 1.0)
        return colour;
    float t = (code - knee) / (1.0 - knee), t2 = t * t, t3 = t2 * t;
    float held = (2.0 * t3 - 3.0 * t2 + 1.0) * knee + (t3 - 2.0 * t2 + t) * (1.0 - knee) +
                 (3.0 * t2 - 2.0 * t3) * peak;
    return colour * (decode_pq(held) / (setting(POST_WHITE_NITS) * most));
}

// --- all curves ---------------------------------------------------------------------------------

vec3 apply_tone_curve(vec3 colour)
{
    switch (choice(POST_TONE_MAP)) {
    case POST_MAP_REINHARD:
        return reinhard(colour);
    case POST_MAP_NARKOWICZ:
        return narkowicz(colour);
    case POST_MAP_UNREAL:
        return unreal(colour);
    case POST_MAP_NEUTRAL:
        return neutral(colour);
    case POST_MAP_AGX:
        return agx(colour);
    case POST_MAP_BT2390:
        return bt2390(colour);
    default:
        return colour;
    }
}

// IEC 61966-2-1.
float srgb(float x)
{
    return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1.0 / 2.4) - 0.055;
}

// PQ in BT.2020; the value 1 is white_nits, and values are clamped to the display's peak.
vec3 encoded_hdr(vec3 colour)
{
    vec3 nits = setting(POST_WHITE_NITS) * multiply_rows(view.rec709_to_rec2020, colour);
    nits = clamp(nits, vec3(0.0), vec3(setting(POST_PEAK_NITS)));
    return vec3(encode_pq(nits.r), encode_pq(nits.g), encode_pq(nits.b));
}

vec3 encode_display(vec3 colour)
{
    if (choice(POST_ENCODE) == POST_ENCODE_PQ)
        return encoded_hdr(colour);
    colour = min(colour, vec3(1.0));
    return choice(POST_ENCODE) == POST_ENCODE_SRGB
               ? vec3(srgb(colour.r), srgb(colour.g), srgb(colour.b))
               : colour;
}

// White balance, tone curve and encoding of an exposed scene-linear colour.
vec3 develop_colour(vec3 colour)
{
    return encode_display(
        apply_tone_curve(max(multiply_rows(view.white_balance, colour), vec3(0.0))));
}

// --- the colour table ---------------------------------------------------------------------------
//
// As in Unreal: 32^3 nodes at equal steps of the logarithm over 14 stops, 0.18 at code 444 of 1023.
// The colour of the first node is subtracted from all nodes, so that the first node is black.

const float LUT_STOPS = 14.0, LUT_GREY = 0.18, LUT_GREY_AT = 444.0 / 1023.0;

vec3 from_place(vec3 place) { return LUT_GREY * exp2((place - LUT_GREY_AT) * LUT_STOPS); }

vec3 to_place(vec3 colour)
{
    return clamp(log2(colour / LUT_GREY) / LUT_STOPS + LUT_GREY_AT, 0.0, 1.0);
}

// The colour of a table coordinate, and the inverse.
vec3 table_to_colour(vec3 place) { return from_place(place) - from_place(vec3(0.0)); }
vec3 colour_to_table(vec3 colour) { return to_place(colour + from_place(vec3(0.0))); }

#endif
