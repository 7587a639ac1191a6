// SPDX-License-Identifier: MIT
//
// Conversion of floats to display colours for neph view: OpenColorIO's view by a table of the data
// (metrics/display.h, neph_display_bake), and the colours of differences and amounts, equal to
// those of neph_display_map().
(function () {
  "use strict";

  const word = new Uint32Array(1);
  const real = new Float32Array(word.buffer);

  /** A function from linear values to codes 0..255: exact, by the least values of codes 1..255. */
  function display(leastOfCodes) {
    const least = Float32Array.from([-Infinity, ...leastOfCodes, NaN]); // no value is >= NaN
    const guess = new Uint8Array(1 << 16); // code by the upper half of a float: never too high
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

  /** A function from linear RGB to the codes of a pixel, channel by channel. */
  const byCodes = (codeOf) => (r, g, b, rgba, at) => {
    rgba[at] = codeOf(r);
    rgba[at + 1] = codeOf(g);
    rgba[at + 2] = codeOf(b);
  };

  /** A function from linear RGB to the codes of a pixel, trilinear in a table of colours
   * (metrics/display_cube.h). */
  function byCube({ side, knee, top }, nodes) {
    const all = Math.log2(1 + top / knee);
    const low = [0, 0, 0];
    const share = [0, 0, 0];
    return (r, g, b, rgba, at) => {
      [r, g, b].forEach((value, c) => {
        const place = Math.min(1, Math.log2(1 + Math.max(value, 0) / knee) / all) * (side - 1);
        low[c] = Math.min(Math.floor(place), side - 2);
        share[c] = place - low[c];
      });
      const first = (low[2] * side + low[1]) * side + low[0];
      for (let c = 0; c < 3; c++) {
        const plane = nodes[c];
        let sum = 0;
        for (let corner = 0; corner < 8; corner++) {
          const [x, y, z] = [corner & 1, corner >> 1 & 1, corner >> 2];
          sum += (x ? share[0] : 1 - share[0]) * (y ? share[1] : 1 - share[1])
            * (z ? share[2] : 1 - share[2]) * plane[first + (z * side + y) * side + x];
        }
        rgba[at + c] = Math.round(sum);
      }
    };
  }

  /** Paints a frame of three planes or of one. A pixel with a NaN is magenta. */
  function paintPicture(rgba, planes, gain, colourOf) {
    const last = planes.length - 1;
    for (let i = 0; i < planes[0].length; i++) {
      const r = planes[0][i] * gain;
      const g = planes[Math.min(1, last)][i] * gain;
      const b = planes[last][i] * gain;
      const bad = r !== r || g !== g || b !== b;
      if (bad) [rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2]] = [255, 0, 255];
      else colourOf(r, g, b, rgba, 4 * i);
      rgba[4 * i + 3] = 255;
    }
  }

  /** Paints depth: near pixels are bright, the sky is black. */
  function paintDepth(rgba, plane, near, gain, codeOf) {
    for (let i = 0; i < plane.length; i++) {
      const code = codeOf(near / plane[i] * gain);
      rgba[4 * i] = rgba[4 * i + 1] = rgba[4 * i + 2] = code;
      rgba[4 * i + 3] = 255;
    }
  }

  const luminance = (r, g, b) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

  /** The value of a pixel: the only plane, or the luminance of three planes. */
  const valueOf = (planes, i) => (planes.length === 1 ? planes[0][i]
    : luminance(planes[0][i], planes[1][i], planes[2][i]));

  /** Shown - reference of one pixel. Equal depths differ by 0, also infinite ones (the sky). */
  function differenceOf(reference, shown, i) {
    if (reference.length === 1)
      return reference[0][i] === shown[0][i] ? 0 : shown[0][i] - reference[0][i];
    return luminance(shown[0][i] - reference[0][i], shown[1][i] - reference[1][i],
      shown[2][i] - reference[2][i]);
  }

  /** Writes the colour of a position on a scale: linear between its stops. */
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

  /** The CSS gradient of a scale. */
  const gradient = (colours) => {
    const first = colours.stops[0].position;
    const stops = colours.stops.map(({ position, rgb }) =>
      `rgb(${rgb.join(" ")}) ${(100 * (position - first)) / (1 - first)}%`);
    return `linear-gradient(to right, ${stops.join(", ")})`;
  };

  window.NephPaint = { display, byCodes, byCube, paintPicture, paintDepth, paintValues, valueOf,
    differenceOf, gradient };
})();
