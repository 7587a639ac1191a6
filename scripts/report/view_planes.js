// SPDX-License-Identifier: MIT
//
// Loads the planes of floats of a page of neph view. Each file of frames/ is a script that calls
// NEPH_VIEW_PLANES, because a page on file:// may not read files. A file is loaded when the page
// first shows it. base/packed.h describes the packing; unpacked floats equal the EXR's bit for bit.
(function () {
  "use strict";

  let keptBytes = 384 * 1024 * 1024; // limit of opened planes; the least recently used go first
  const waiting = new Map(); // key: function that receives the text of its file
  const opened = new Map(); // key: Promise of planes; in the order of their last use
  const ready = new Map(); // key: planes

  window.NEPH_VIEW_PLANES = (key, text) => {
    waiting.get(key)?.(text);
    waiting.delete(key);
  };

  /** A promise of the text of a file of frames/. */
  function load(key) {
    return new Promise((resolve, reject) => {
      const script = document.createElement("script");
      script.src = `frames/${key}.js`;
      waiting.set(key, resolve);
      script.addEventListener("load", () => {
        script.remove();
        if (waiting.delete(key)) reject(new Error(`frames/${key}.js is damaged`));
      });
      script.addEventListener("error", () => {
        script.remove();
        reject(new Error(`frames/${key}.js cannot be read`));
      });
      document.head.append(script);
    });
  }

  async function inflate(bytes) {
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }

  function bytesOf(base64) {
    const characters = atob(base64);
    const bytes = new Uint8Array(characters.length);
    for (let i = 0; i < bytes.length; i++) bytes[i] = characters.charCodeAt(i);
    return bytes;
  }

  /** Unpacks floats from planes of bytes of differences (base/packed.h). */
  function floatsOf(bytes) {
    const count = bytes.length / 4;
    const bits = new Int32Array(count);
    let before = 0;
    for (let i = 0; i < count; i++) {
      before = (before + ((bytes[i] << 24) | (bytes[count + i] << 16) | (bytes[2 * count + i] << 8)
        | bytes[3 * count + i])) | 0;
      bits[i] = before;
    }
    return new Float32Array(bits.buffer);
  }

  async function open(key, pixels) {
    const floats = floatsOf(await inflate(bytesOf(await load(key))));
    const planes = [];
    for (let first = 0; first < floats.length; first += pixels)
      planes.push(floats.subarray(first, first + pixels));
    ready.set(key, planes);
    return planes;
  }

  const bytesIn = (planes) => 4 * planes[0].length * planes.length;

  function forget() {
    let bytes = 0;
    for (const planes of ready.values()) bytes += bytesIn(planes);
    for (const key of [...opened.keys()]) {
      if (bytes <= keptBytes) return;
      if (!ready.has(key)) continue;
      bytes -= bytesIn(ready.get(key));
      ready.delete(key);
      opened.delete(key);
    }
  }

  /** A promise of the planes of a key, Float32Arrays of `pixels` each. */
  function want(key, pixels) {
    const planes = opened.get(key) ?? open(key, pixels);
    opened.delete(key);
    opened.set(key, planes);
    forget();
    return planes;
  }

  /** Raises the limit to `bytes`. It must fit all planes of one view, or they would be loaded again
   * and again. */
  function keep(bytes) {
    keptBytes = Math.max(keptBytes, bytes);
  }

  window.NephPlanes = { want, keep, have: (key) => ready.get(key) };
})();
