// SPDX-License-Identifier: MIT
//
// Clouds of @takram/three-clouds over a sea of the Earth's shape, from a camera at rest 500 m above
// it. What ?key=value changes: w, h [px], preset (low, medium, high, ultra), map (texels along a
// side of its shadow maps), upscale (0: no temporal upscaling), wind (of its weather, a second).
import * as THREE from "three";
import { EffectComposer, EffectPass, RenderPass, ToneMappingEffect, ToneMappingMode } from
  "postprocessing";
import { AerialPerspectiveEffect, PrecomputedTexturesLoader } from "@takram/three-atmosphere";
import { CloudsEffect } from "@takram/three-clouds";
import { DataTextureLoader, Ellipsoid, Geodetic, parseUint8Array, radians } from
  "@takram/three-geospatial";

const asked = new URLSearchParams(location.search);
const number = (key, otherwise) => Number(asked.get(key) ?? otherwise);
const width = number("w", 192), height = number("h", 108);

function cameraAtRest() {
  const camera = new THREE.PerspectiveCamera(50, width / height, 10, 4e5);
  const [east, north, up] = [0, 1, 2].map(() => new THREE.Vector3());
  camera.position.copy(new Geodetic(radians(139), radians(35), 500).toECEF());
  Ellipsoid.WGS84.getEastNorthUpVectors(camera.position, east, north, up);
  camera.up.copy(up);
  camera.lookAt(camera.position.clone().addScaledVector(north, 1000).addScaledVector(up, 180));
  camera.updateMatrixWorld();
  const sun = north.multiplyScalar(0.5).addScaledVector(east, 0.6).addScaledVector(up, 0.6);
  return { camera, sun: sun.normalize() };
}

function cloudsOf(camera, sun) {
  const clouds = new CloudsEffect(camera);
  clouds.qualityPreset = asked.get("preset") ?? "medium";
  clouds.coverage = 0.4;
  clouds.sunDirection.copy(sun);
  clouds.temporalUpscale = number("upscale", 1) !== 0;
  clouds.localWeatherVelocity.set(number("wind", 0), 0);
  clouds.shadow.mapSize = new THREE.Vector2(1, 1).multiplyScalar(number("map", 256));
  return clouds;
}

// The sky behind, which also puts the clouds into the picture.
function skyWith(clouds, camera, sun) {
  const sky = new AerialPerspectiveEffect(camera, { sky: true });
  sky.sunDirection.copy(sun);
  clouds.events.addEventListener("change", ({ property }) => {
    if (property === "atmosphereOverlay") sky.overlay = clouds.atmosphereOverlay;
    if (property === "atmosphereShadow") sky.shadow = clouds.atmosphereShadow;
    if (property === "atmosphereShadowLength") sky.shadowLength = clouds.atmosphereShadowLength;
  });
  return sky;
}

const loaded = (loader, url) => new Promise((done, failed) =>
  loader.load(url, done, undefined, failed));

async function picture(url) {
  const texture = await loaded(new THREE.TextureLoader(), url);
  return Object.assign(texture, { minFilter: THREE.LinearMipMapLinearFilter,
    magFilter: THREE.LinearFilter, wrapS: THREE.RepeatWrapping, wrapT: THREE.RepeatWrapping,
    colorSpace: THREE.NoColorSpace, needsUpdate: true });
}

const volume = (url, side) => loaded(new DataTextureLoader(THREE.Data3DTexture, parseUint8Array, {
  width: side, height: side, depth: side, format: THREE.RedFormat, minFilter: THREE.LinearFilter,
  magFilter: THREE.LinearFilter, wrapS: THREE.RepeatWrapping, wrapT: THREE.RepeatWrapping,
  wrapR: THREE.RepeatWrapping, colorSpace: THREE.NoColorSpace }), url);

// The package comes without its blue noise: white in place, steps of the golden ratio over time.
function noise(side = 128, depth = 64) {
  const data = new Uint8Array(side * side * depth);
  let state = 12345;
  for (let i = 0; i < side * side; i++) {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    for (let k = 0; k < depth; k++)
      data[i + k * side * side] = 256 * ((state / 2 ** 32 + k * 0.618034) % 1);
  }
  return Object.assign(new THREE.Data3DTexture(data, side, side, depth), {
    type: THREE.UnsignedByteType, format: THREE.RedFormat, minFilter: THREE.NearestFilter,
    magFilter: THREE.NearestFilter, wrapS: THREE.RepeatWrapping, wrapT: THREE.RepeatWrapping,
    wrapR: THREE.RepeatWrapping, needsUpdate: true });
}

async function fill(clouds, sky) {
  clouds.localWeatherTexture = await picture("clouds/local_weather.png");
  clouds.turbulenceTexture = await picture("clouds/turbulence.png");
  clouds.shapeTexture = await volume("clouds/shape.bin", 128);
  clouds.shapeDetailTexture = await volume("clouds/shape_detail.bin", 32);
  clouds.stbnTexture = sky.stbnTexture = noise();
  const tables = await loaded(new PrecomputedTexturesLoader({ format: "binary",
    type: THREE.HalfFloatType }), "atmosphere");
  for (const [name, texture] of Object.entries(tables)) clouds[name] = sky[name] = texture;
}

async function start() {
  const { camera, sun } = cameraAtRest();
  const clouds = cloudsOf(camera, sun), sky = skyWith(clouds, camera, sun);
  const renderer = new THREE.WebGLRenderer({ antialias: false, depth: false, stencil: false });
  renderer.toneMappingExposure = 10;
  const composer = new EffectComposer(renderer, { frameBufferType: THREE.HalfFloatType });
  composer.addPass(new RenderPass(new THREE.Scene(), camera));
  composer.addPass(new EffectPass(camera, clouds, sky));
  composer.addPass(new EffectPass(camera, new ToneMappingEffect({ mode: ToneMappingMode.AGX })));
  composer.setSize(width, height);
  await fill(clouds, sky);
  const flat = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
  const sum = new Float64Array(4 * width * height);
  let count = 0;
  // The next picture, a 30th of a second later; `counts` into the mean.
  window.nextPicture = (counts) => {
    composer.render(1 / 30);
    flat.drawImage(renderer.domElement, 0, 0);
    if (counts) flat.getImageData(0, 0, width, height).data.forEach((v, i) => { sum[i] += v; });
    count += counts;
    return renderer.domElement.toDataURL("image/png");
  };
  window.meanPicture = () => {
    const canvas = Object.assign(document.createElement("canvas"), { width, height });
    const mean = Uint8ClampedArray.from(sum, (value) => Math.round(value / count));
    canvas.getContext("2d").putImageData(new ImageData(mean, width, height), 0, 0);
    return canvas.toDataURL("image/png");
  };
}

start().then(() => { document.documentElement.dataset.ready = "yes"; },
  (error) => console.error(error));
