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

/**
 * How far two PNGs of one size are apart: mean and 99th percentile of the pixels' largest code difference, how many pixels of the first are
 * not black, and a PNG of eight times the difference. The browser decodes them.
 */
export async function difference(one, other) {
  const context = await (await browser("webgl2")).newContext();
  try {
    const page = await context.newPage();
    const result = await page.evaluate(inPage, [one.toString("base64"), other.toString("base64")]);
    return { ...result, png: Buffer.from(result.png, "base64") };
  } finally {
    await context.close();
  }
}

/** Runs in an empty page. */
async function inPage(pngs) {
  const codes = async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const options = { colorSpaceConversion: "none", premultiplyAlpha: "none" };
    const image = await createImageBitmap(new Blob([bytes], { type: "image/png" }), options);
    const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
    context.drawImage(image, 0, 0);
    return context.getImageData(0, 0, image.width, image.height);
  };
  const [a, b] = [await codes(pngs[0]), await codes(pngs[1])];
  if (a.width !== b.width || a.height !== b.height) {
    throw new Error(`pictures of ${a.width}×${a.height} and ${b.width}×${b.height} pixels`);
  }
  const shown = new ImageData(a.width, a.height);
  const largest = new Uint8Array(a.width * a.height);
  let [sum, lit] = [0, 0];
  for (let i = 0; i < largest.length; i += 1) {
    for (let c = 4 * i; c < 4 * i + 3; c += 1) {
      const off = Math.abs(a.data[c] - b.data[c]);
      largest[i] = Math.max(largest[i], off);
      shown.data[c] = Math.min(255, 8 * off);
    }
    shown.data[4 * i + 3] = 255;
    sum += largest[i];
    lit += a.data[4 * i] + a.data[4 * i + 1] + a.data[4 * i + 2] > 0 ? 1 : 0;
  }
  largest.sort();
  const canvas = new OffscreenCanvas(a.width, a.height);
  canvas.getContext("2d").putImageData(shown, 0, 0);
  const blob = await canvas.convertToBlob({ type: "image/png" });
  const png = btoa(String.fromCharCode(...new Uint8Array(await blob.arrayBuffer())));
  const pixels = largest.length;
  return { mean: sum / pixels, p99: largest[Math.floor(0.99 * (pixels - 1))], lit: lit / pixels, png };
}

/** Fails where the two PNGs differ by more than `mean` codes on average, or `p99` at the 99th percentile; then leaves both and their difference. */
export async function checkSame(name, shown, expected, limits) {
  const { mean, p99, lit, png } = await difference(expected, shown);
  const found = `${name}: mean ${mean.toFixed(2)}, 99th percentile ${p99} codes`;
  console.log(found);
  if (mean <= limits.mean && p99 <= limits.p99) {
    // A picture of nothing agrees with another one.
    check(lit > 0.1, `${name}: only ${(100 * lit).toFixed(0)} % of the expected picture are lit`);
    return;
  }
  await writeFile(await place(`${name}.shown.png`), shown);
  await writeFile(await place(`${name}.expected.png`), expected);
  const path = await place(`${name}.difference.png`);
  await writeFile(path, png);
  throw new Error(`${found}, more than ${limits.mean} and ${limits.p99}; see ${path} and its neighbours`);
}

/** Fails where two PNGs show the same. */
export async function checkOther(what, one, other) {
  const { mean } = await difference(one, other);
  check(mean > 0.5, `${what}: the picture has not changed (by ${mean.toFixed(2)} codes on average)`);
}
