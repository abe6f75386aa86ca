// Pictures of the page held against pictures of the program `relume`.
import { execFile } from "node:child_process";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { promisify } from "node:util";
import { browser } from "./chromium.mjs";
import { check } from "./harness.mjs";

const FOLDER = process.env.RELUME_PICTURES ?? "browser-pictures";

/** A file of this name among the pictures that are kept for people to look at. */
async function place(name) {
  await mkdir(FOLDER, { recursive: true });
  return join(FOLDER, name);
}

/** What `relume render` makes of a scene of the gallery, as a PNG; `flags` are its own. */
export async function rendered(name, scene, { width, height }, flags) {
  const path = await place(`${name}.expected.png`);
  const asset = join(process.env.RELUME_GALLERY, scene);
  await promisify(execFile)(process.env.RELUME, ["render", asset, "--size", `${width}x${height}`, "-o", path, ...flags]);
  return readFile(path);
}

/** Runs `use` with an empty page, whose browser reads and writes PNGs. */
async function withPage(use) {
  const context = await (await browser("webgl2")).newContext();
  try {
    return await use(await context.newPage());
  } finally {
    await context.close();
  }
}

/** Width, height and codes (RGBA, row after row) of a PNG. */
async function decoded(page, png) {
  const { width, height, base64 } = await page.evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const options = { colorSpaceConversion: "none", premultiplyAlpha: "none" };
    const image = await createImageBitmap(new Blob([bytes], { type: "image/png" }), options);
    const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
    context.drawImage(image, 0, 0);
    const { data, width, height } = context.getImageData(0, 0, image.width, image.height);
    return { width, height, base64: btoa(Array.from(data, (code) => String.fromCharCode(code)).join("")) };
  }, png.toString("base64"));
  return { width, height, codes: Buffer.from(base64, "base64") };
}

/** A PNG of codes (RGBA, row after row). */
async function encoded(page, { width, height, codes }) {
  const base64 = await page.evaluate(
    async ({ width, height, base64 }) => {
      const codes = Uint8ClampedArray.from(atob(base64), (c) => c.charCodeAt(0));
      const canvas = new OffscreenCanvas(width, height);
      canvas.getContext("2d").putImageData(new ImageData(codes, width, height), 0, 0);
      const bytes = new Uint8Array(await (await canvas.convertToBlob({ type: "image/png" })).arrayBuffer());
      return btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""));
    },
    { width, height, base64: codes.toString("base64") },
  );
  return Buffer.from(base64, "base64");
}

/** The value below which a share of them lies. */
function percentile(values, share) {
  const sorted = Float64Array.from(values).sort();
  return sorted[Math.floor(share * (sorted.length - 1))];
}

/** For each pixel, the difference of the channel that is farthest off. */
function farthest(one, other) {
  return Array.from({ length: one.width * one.height }, (_, i) => {
    const off = (channel) => Math.abs(one.codes[4 * i + channel] - other.codes[4 * i + channel]);
    return Math.max(off(0), off(1), off(2));
  });
}

/** For each channel of each 16 × 16 pixels, how far the means are apart: edges and grain cancel, what is too bright or too dark does not. */
function blockMeans(one, other) {
  const blocks = new Map();
  const colours = [...one.codes.keys()].filter((at) => at % 4 < 3);
  for (const at of colours) {
    const [x, y] = [(at >> 2) % one.width, Math.floor((at >> 2) / one.width)];
    const key = `${x >> 4} ${y >> 4} ${at & 3}`;
    const { sum, count } = blocks.get(key) ?? { sum: 0, count: 0 };
    blocks.set(key, { sum: sum + one.codes[at] - other.codes[at], count: count + 1 });
  }
  return [...blocks.values()].map(({ sum, count }) => Math.abs(sum / count));
}

/**
 * How far two pictures of one size are apart, in codes: the mean and the 99th percentile over pixels, and the 95th percentile over the means of
 * blocks; and the share of the first one's pixels that are not black.
 */
function distance(one, other) {
  const pixels = farthest(one, other);
  const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;
  const lit = pixels.map((_, i) => (one.codes[4 * i] + one.codes[4 * i + 1] + one.codes[4 * i + 2] > 0 ? 1 : 0));
  const block = percentile(blockMeans(one, other), 0.95);
  return { mean: mean(pixels), p99: percentile(pixels, 0.99), block, lit: mean(lit) };
}

/** Eight times the difference, as a picture. */
function enlarged(one, other) {
  const code = (at) => (at % 4 === 3 ? 255 : Math.min(255, 8 * Math.abs(one.codes[at] - other.codes[at])));
  return { ...one, codes: Buffer.from(one.codes.map((_, at) => code(at))) };
}

/** Fails where the two PNGs differ by more than `limits`, which has the names of [distance]; then leaves both and their difference. */
export async function checkSame(name, shown, expected, limits) {
  await withPage(async (page) => {
    const [one, other] = [await decoded(page, expected), await decoded(page, shown)];
    check(one.width === other.width && one.height === other.height, `${name}: pictures of two sizes`);
    const found = distance(one, other);
    const said = `${name}: mean ${found.mean.toFixed(2)}, 99th percentile ${found.p99}, blocks ${found.block.toFixed(2)} codes`;
    console.log(said);
    if (Object.entries(limits).every(([what, limit]) => found[what] <= limit)) {
      // A picture of nothing agrees with another one.
      check(found.lit > 0.1, `${name}: only ${(100 * found.lit).toFixed(0)} % of the expected picture are lit`);
      return;
    }
    await writeFile(await place(`${name}.shown.png`), shown);
    const path = await place(`${name}.difference.png`);
    await writeFile(path, await encoded(page, enlarged(one, other)));
    throw new Error(`${said}; allowed are ${JSON.stringify(limits)}; see ${path} and its neighbours`);
  });
}

/** Fails where two PNGs show the same. */
export async function checkOther(what, one, other) {
  await withPage(async (page) => {
    const { mean } = distance(await decoded(page, one), await decoded(page, other));
    check(mean > 0.5, `${what}: the picture has not changed (by ${mean.toFixed(2)} codes on average)`);
  });
}
