// Looks at the page in a browser and holds what it draws against a picture of `relume render`.
//
//     node check.mjs URL PICTURE.png
//
// URL is the page on a loopback server with the asset, light, camera, exposure and turn of the picture, which was made with `--background black
// --samples-per-pixel 1`; the window takes its size. Needs playwright-core, beside this file or in NODE_PATH, and a Chromium: the one at
// RELUME_CHROMIUM, or Debian's.
// Exits 1 with a line for everything that is wrong.
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";

/**
 * Two pixels that differ by more codes of 8 bits than this lie at an edge, where a pixel's centre falls on one side here and on the other there, or
 * show a texture made smaller, for which a browser reads mip levels and `relume render` does not.
 */
const EDGE = 16;
/** The share of the surface's pixels that may be such. Outlines and folds of scanned figures and rooms are 0.6 % at most in a picture of 960 × 540. */
const EDGES = 0.02;
/**
 * Mean difference of the others. Radiance agrees to rounding at the vertices, and between them both interpolate linearly; but a GPU puts corners
 * to 1/256 of a pixel, which moves a code where it changes by dozens from pixel to pixel. From rooms to noisy figures that makes 0.00 to 0.15; green
 * for blue makes 0.6 where all light is nearly white, a turn by 30 degrees 24. Textures that are made smaller make more than 0.25: choose a view
 * without.
 */
const TOLERANCE = 0.25;

/** Without these WebGL is there but draws nothing, or the browser asks the network for updates. */
const FLAGS = [
  "--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
  "--disable-component-update", "--disable-sync",
];

const { chromium } = createRequire(import.meta.url)("playwright-core");

/** In the page: how the canvas differs from a picture, and how many pixels of either show something. */
async function compare([png, edge]) {
  const bytes = await (await fetch(`data:image/png;base64,${png}`)).blob();
  const picture = await createImageBitmap(bytes, { colorSpaceConversion: "none" });
  const codes = (image) => {
    const context = new OffscreenCanvas(picture.width, picture.height).getContext("2d");
    context.drawImage(image, 0, 0);
    return context.getImageData(0, 0, picture.width, picture.height).data;
  };
  window.draw(0);
  const [drawn, wanted] = [codes(document.querySelector("canvas")), codes(picture)];
  const lit = (pixels, i) => pixels[i] + pixels[i + 1] + pixels[i + 2] > 0;
  let [sum, edges, smooth] = [0, 0, 0];
  for (let i = 0; i < wanted.length; i += 4) {
    if (!lit(drawn, i) && !lit(wanted, i)) continue;
    const off = [0, 1, 2].map((c) => Math.abs(drawn[i + c] - wanted[i + c]));
    if (Math.max(...off) > edge) {
      edges += 1;
    } else {
      smooth += 1;
      sum += (off[0] + off[1] + off[2]) / 3;
    }
  }
  return { pixels: edges + smooth, edges: edges / (edges + smooth), difference: sum / smooth };
}

/** What is wrong with the page. */
async function check(url, path) {
  const png = await readFile(path);
  const [width, height] = [png.readUInt32BE(16), png.readUInt32BE(20)];
  const browser = await chromium.launch({ executablePath: process.env.RELUME_CHROMIUM ?? "/usr/bin/chromium", args: FLAGS });
  try {
    const page = await browser.newPage({ viewport: { width, height } });
    const wrong = [];
    page.on("console", (message) => message.type() === "error" && wrong.push(`console: ${message.text()}`));
    page.on("pageerror", (error) => wrong.push(`page: ${error.message}`));
    page.on("requestfailed", (request) => wrong.push(`not loaded: ${request.url()}`));
    await page.goto(url);
    await page.waitForFunction(() => window.draw, undefined, { timeout: 60_000 }).catch(() => wrong.push("the page never drew"));
    if (wrong.length > 0) return wrong;
    const { pixels, edges, difference } = await page.evaluate(compare, [png.toString("base64"), EDGE]);
    const share = `${(100 * edges).toFixed(2)} % of ${pixels} pixels at edges`;
    console.log(`${share}; mean difference of the others ${difference.toFixed(3)} codes`);
    if (pixels < 1000) wrong.push("the picture shows next to nothing: compare with another");
    if (!(edges <= EDGES)) wrong.push(`more than ${100 * EDGES} % differ by more than ${EDGE} codes`);
    if (!(difference <= TOLERANCE)) wrong.push(`the mean difference is above ${TOLERANCE}`);
    return wrong;
  } finally {
    await browser.close();
  }
}

const [url, picture] = process.argv.slice(2);
if (!picture) {
  console.error("usage: node check.mjs URL PICTURE.png");
  process.exit(2);
}
const wrong = await check(url, picture);
wrong.forEach((line) => console.error(line));
process.exit(wrong.length > 0 ? 1 : 0);
