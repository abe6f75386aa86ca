// Looks at the page in a browser and holds what it draws against a picture of `relume render`.
//
//     node check.mjs URL PICTURE.png
//
// URL is the page on a loopback server, with the asset, light, camera, exposure and turn of the picture; the window takes the picture's size. Needs
// playwright-core, beside this file or in NODE_PATH, and a Chromium: the one that CHROMIUM names, or Debian's.
// Exits 1 with a line for everything that is wrong.
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";

/**
 * Mean difference, in codes of 8 bits, over pixels where either shows a surface. Radiance agrees to rounding in the vertices; between them both
 * interpolate linearly. What is left: rounding to a code on either side (1/4 on average), textures, which a browser reads from
 * mip levels and `relume render` does not, and silhouettes, where a pixel's centre falls on the other side of an edge: a few hundred pixels
 * of some hundred thousand that differ by a hundred codes or so.
 */
const TOLERANCE = 1;

/** Without these WebGL is there but draws nothing, or the browser asks the network for updates. */
const FLAGS = [
  "--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
  "--disable-component-update", "--disable-sync",
];

const { chromium } = createRequire(import.meta.url)("playwright-core");

/** In the page: the mean difference between the canvas and a picture, and how many pixels of each show something. */
async function compare(png) {
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
  let [sum, either, inDrawn, inWanted] = [0, 0, 0, 0];
  for (let i = 0; i < wanted.length; i += 4) {
    inDrawn += lit(drawn, i);
    inWanted += lit(wanted, i);
    if (!lit(drawn, i) && !lit(wanted, i)) continue;
    either += 1;
    for (let c = 0; c < 3; c++) sum += Math.abs(drawn[i + c] - wanted[i + c]) / 3;
  }
  return { difference: sum / either, inDrawn, inWanted };
}

/** What is wrong with the page. */
async function check(url, path) {
  const png = await readFile(path);
  const [width, height] = [png.readUInt32BE(16), png.readUInt32BE(20)];
  const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: FLAGS });
  try {
    const page = await browser.newPage({ viewport: { width, height } });
    const wrong = [];
    page.on("console", (message) => message.type() === "error" && wrong.push(`console: ${message.text()}`));
    page.on("pageerror", (error) => wrong.push(`page: ${error.message}`));
    page.on("requestfailed", (request) => wrong.push(`not loaded: ${request.url()}`));
    await page.goto(url);
    await page.waitForFunction(() => window.draw, undefined, { timeout: 60_000 }).catch(() => wrong.push("the page never drew"));
    if (wrong.length > 0) return wrong;
    const { difference, inDrawn, inWanted } = await page.evaluate(compare, png.toString("base64"));
    console.log(`${inDrawn} pixels drawn, ${inWanted} in the picture; mean difference ${difference.toFixed(3)} codes`);
    if (inWanted < 1000) wrong.push("the picture shows next to nothing: compare with another");
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
