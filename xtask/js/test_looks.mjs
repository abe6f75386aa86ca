// What is shown, held against what the program `relume` makes of the same asset, light and camera.
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { SIZE, Viewer } from "./chromium.mjs";
import { check } from "./harness.mjs";
import { checkOther, checkSame, rendered } from "./pictures.mjs";

/**
 * Both sides read one asset, so inside surfaces only rounding differs: of a few operations in f32, of codes (half a code on either side), and of
 * corners, which rasterisers keep to 1/256 of a pixel. That is at most one code, on average well below half of one. At edges the page has 4 samples a
 * pixel and the program 16: a covered share of a quarter more or less, 64 codes between black and white. Edges cover about 2 % of these pictures
 * (outlines some 2000 pixels long, of 130,000, where contrast is rarely a half), so that the 99th percentile may fall among them: a quarter of
 * half the codes. They add 0.02 · 16 to the mean. A straight edge through a block of 16 × 16 pixels may be off the same way all along: 16 pixels of
 * 256, by up to 32 codes, are 2 codes and the rounding.
 */
const LIMITS = { mean: 0.8, p99: 32, block: 3 };

/**
 * Where textures have texels finer than pixels, the page takes the mean of a neighbourhood of powers of two (mip maps), the program that of 16
 * points: half of the contrast of a mosaic's stones at their borders (up to 128 codes), which a tenth of the picture is, and a tenth of that as an
 * average over a block.
 */
const TEXTURED = { mean: 6.4, p99: 128, block: 8 };

/** Opens a scene as the program's options would show it, and compares. */
async function compare(kind, name, { scene, light, query = "", flags = [], limits = LIMITS }) {
  const address = `panel=0&exposure=0&asset=gallery/${scene}&light=${light}${query}`;
  await Viewer.with(kind, address, async (viewer) => {
    const { size } = await viewer.settled();
    check(size[0] === SIZE.width && size[1] === SIZE.height, `a picture of ${size} pixels`);
    const shown = await viewer.picture();
    const expected = await rendered(`${kind}-${name}`, scene, SIZE, ["--light", light, "--exposure", "0", ...flags]);
    await checkSame(`${kind}-${name}`, shown, expected, limits);
    viewer.checkQuiet();
  });
}

export async function shown(kind) {
  await Viewer.with(kind, "asset=gallery/ball.glb&light=constant:1,1,1", async (viewer) => {
    const state = await viewer.settled();
    check(state.scene === "ball.glb" || state.scene === "ball", `the scene is ${state.scene}`);
    const glb = await readFile(join(process.env.RELUME_GALLERY, "ball.glb"));
    check(state.vertices === vertices(glb), `${state.vertices} of ${vertices(glb)} vertices`);
    check(state.light.includes("constant"), `the light is ${state.light}`);
    check(state.messages.length === 0, `says ${state.messages}`);
    viewer.checkQuiet();
  });
}

/** Vertices over all meshes of a .glb that has one node for each. */
function vertices(glb) {
  const { meshes, accessors } = JSON.parse(glb.subarray(20, 20 + glb.readUInt32LE(12)));
  const counts = meshes.flatMap(({ primitives }) => primitives.map((p) => accessors[p.attributes.POSITION].count));
  return counts.reduce((sum, count) => sum + count, 0);
}

export async function sameAsProgram(kind) {
  await compare(kind, "ball", { scene: "ball.glb", light: "sky:30,3" });
  await compare(kind, "room", { scene: "room.glb", light: "constant:1.5,1.2,0.9" });
  await compare(kind, "courtyard", { scene: "courtyard.glb", light: "sky:30,3", limits: TEXTURED });
}

export async function turned(kind) {
  const sun = { scene: "ball.glb", light: "sun:1,1,0.3,30,9,8,6" };
  await compare(kind, "turned", { ...sun, query: "&turn=135", flags: ["--rotate", "0,1,0:135"] });
}

export async function background(kind) {
  const picture = async (query) => {
    let shown;
    await Viewer.with(kind, `panel=0&exposure=0&asset=gallery/ball.glb&light=sky:30,3${query}`, async (viewer) => {
      await viewer.settled();
      shown = await viewer.picture();
      viewer.checkQuiet();
    });
    return shown;
  };
  await checkOther("background=0", await picture(""), await picture("&background=0"));
}
