// SPDX-License-Identifier: MIT
//
// From floats to the colours of a screen: OpenColorIO's view as the table that the data bring
// (metrics/display.h, neph_display_bake), and the colours of differences and amounts, as
// neph_display_map() has them.
(function () {
  "use strict";

  const word = new Uint32Array(1);
  const real = new Float32Array(word.buffer);

  /** Codes 0..255 of linear values: exact, by the least value of each code. */
  function display(leastOfCodes) {
    const least = Float32Array.from([-Infinity, ...leastOfCodes, NaN]); // beyond NaN is nothing
    const guess = new Uint8Array(1 << 16); // by the upper half of a float: never too high
    let code = 0;
    for (let upper = 0; upper < 0x8000; upper++) {
      word[0] = upper << 16;
      while (real[0] >= least[code + 1]) code++;
      guess[upper] = code;
    }
    return (value) => {
      real[0] = value;
      let found = guess[word[0] >>> 16];
      while (real[0] >= least[found + 1]) found++;
      return found;
    };
  }

  /** The picture of three planes, or of one. A pixel with a NaN is magenta. */
  function paintPicture(rgba, planes, gain, codeOf) {
    const last = planes.length - 1;
    for (let i = 0; i < planes[0].length; i++) {
      const r = planes[0][i] * gain;
      const g = planes[Math.min(1, last)][i] * gain;
      const b = planes[last][i] * gain;
      const bad = r !== r || g !== g || b !== b;
      rgba[4 * i] = bad ? 255 : codeOf(r);
      rgba[4 * i + 1] = bad ? 0 : codeOf(g);
      rgba[4 * i + 2] = bad ? 255 : codeOf(b);
      rgba[4 * i + 3] = 255;
    }
  }

  /** Depth: the nearer the brighter, the sky black. */
  function paintDepth(rgba, plane, near, gain, codeOf) {
    for (let i = 0; i < plane.length; i++) {
      const code = codeOf(near / plane[i] * gain);
      rgba[4 * i] = rgba[4 * i + 1] = rgba[4 * i + 2] = code;
      rgba[4 * i + 3] = 255;
    }
  }

  const luminance = (r, g, b) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

  /** Of one pixel: the value itself, or the luminance of three. */
  const valueOf = (planes, i) => (planes.length === 1 ? planes[0][i]
    : luminance(planes[0][i], planes[1][i], planes[2][i]));

  /** Shown - reference of one pixel. Depth knows infinity: the sky. */
  function differenceOf(reference, shown, i) {
    if (reference.length === 1)
      return reference[0][i] === shown[0][i] ? 0 : shown[0][i] - reference[0][i];
    return luminance(shown[0][i] - reference[0][i], shown[1][i] - reference[1][i],
      shown[2][i] - reference[2][i]);
  }

  /** The colour at a place of a scale: linear between its stops. */
  function colour(colours, position, rgba, at) {
    const { stops } = colours;
    let rgb = null;
    if (position !== position) rgb = colours.not_a_number;
    else if (position < stops[0].position) rgb = colours.below;
    else if (position > 1) rgb = colours.above;
    let upper = 1;
    while (!rgb && upper < stops.length - 1 && position > stops[upper].position) upper++;
    const [a, b] = [stops[upper - 1], stops[upper]];
    const share = (position - a.position) / (b.position - a.position);
    for (let c = 0; c < 3; c++)
      rgba[at + c] = rgb ? rgb[c] : Math.round(a.rgb[c] + share * (b.rgb[c] - a.rgb[c]));
    rgba[at + 3] = 255;
  }

  function paintValues(rgba, count, value, colours, scale) {
    for (let i = 0; i < count; i++) colour(colours, value(i) / scale, rgba, 4 * i);
  }

  /** A CSS gradient of a scale. */
  const gradient = (colours) => {
    const first = colours.stops[0].position;
    const stops = colours.stops.map(({ position, rgb }) =>
      `rgb(${rgb.join(" ")}) ${(100 * (position - first)) / (1 - first)}%`);
    return `linear-gradient(to right, ${stops.join(", ")})`;
  };

  window.NephPaint = { display, paintPicture, paintDepth, paintValues, valueOf, differenceOf,
    gradient };
})();
