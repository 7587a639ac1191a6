// SPDX-License-Identifier: MIT

/** Runs in a page: each text whose contrast is below that of WCAG 2.1, 1.4.3, with its ratio. */
export function faintTexts() {
  const visible = (element) => element.checkVisibility({ visibilityProperty: true,
      opacityProperty: true });
  const parse = (colour) => {
    const c = colour.match(/[\d.]+/g).map(Number);
    return { r: c[0], g: c[1], b: c[2], a: c[3] ?? 1 };
  };
  const over = (top, bottom) => ({ r: top.r * top.a + bottom.r * (1 - top.a),
      g: top.g * top.a + bottom.g * (1 - top.a), b: top.b * top.a + bottom.b * (1 - top.a), a: 1 });
  const linear = (c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4);
  const luminance = ({ r, g, b }) => 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
  const background = (element) => {
    const layers = [];
    for (let e = element; e; e = e.parentElement) {
      const colour = parse(getComputedStyle(e).backgroundColor);
      if (colour.a > 0) layers.push(colour);
      if (colour.a === 1) break;
    }
    return layers.reverse().reduce((below, layer) => over(layer, below),
      { r: 255, g: 255, b: 255, a: 1 });
  };
  const faint = new Set();
  for (const element of document.querySelectorAll(
    "body *:not(svg, svg *, .hidden, noscript, script)")) {
    if (![...element.childNodes].some((node) => node.nodeType === 3 && node.data.trim())
      || !visible(element)) continue;
    const style = getComputedStyle(element);
    const behind = background(element);
    const [light, dark] = [luminance(over(parse(style.color), behind)),
      luminance(behind)].sort((a, b) => b - a);
    const ratio = (light + 0.05) / (dark + 0.05);
    const size = parseFloat(style.fontSize);
    const large = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700);
    const className = element.className ? `.${element.className}` : "";
    if (ratio < (large ? 3 : 4.5)) faint.add(element.tagName.toLowerCase() + className
      + ` "${element.textContent.slice(0, 30)}" ${ratio.toFixed(2)}`);
  }
  return [...faint];
}
