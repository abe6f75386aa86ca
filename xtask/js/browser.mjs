// Tests of the viewer's page in Chromium: `cargo xtask test --only browser` builds, serves and calls it.
//
// RELUME_PAGE is the page's address, RELUME_GALLERY the folder of its scenes, RELUME the program whose pictures it is compared with,
// RELUME_PICTURES a folder for pictures, RELUME_CHROMIUM the browser; RELUME_THREE and RELUME_THREE_FOLDER are where the three.js example is. Arguments are parts of the names of tests to run, all unless given.
import { close } from "./chromium.mjs";
import { runAll } from "./harness.mjs";
import * as files from "./test_files.mjs";
import * as looks from "./test_looks.mjs";
import * as start from "./test_start.mjs";
import * as example from "./test_three.mjs";
import * as use from "./test_use.mjs";

/** Ways to draw: as they are called in chromium.mjs. */
const BOTH = ["webgpu", "webgl2"];
const ONE = ["webgl2"];

/** Statements, in which browsers they are tested, and how. */
const TESTS = [
  ["the page starts and complains of nothing", BOTH, start.startsQuietly],
  ["the viewer draws with what the browser offers", BOTH, start.drawsWith],
  ["without WebGPU it draws with WebGL2", ["webgpu"], start.fallsBack],
  ["a browser that can draw with neither is told so", ONE, start.cannotDraw],
  ["a program that does not come is said in words", ONE, start.noProgram],
  ["the policy keeps scripts, addresses and markup out", ONE, start.policyHolds],
  ["the canvas fills the window and follows it", ["twofold"], start.fillsWindow],
  ["a scene under its address is shown in its light", BOTH, looks.shown],
  ["pictures are those of relume render", BOTH, looks.sameAsProgram],
  ["a turned light is that of relume render", BOTH, looks.turned],
  ["the background can be left out", ONE, looks.background],
  ["a dropped asset is shown", BOTH, files.dropped],
  ["what is no asset is said in a message", ONE, files.noAsset],
  ["a damaged asset is said in a message", ONE, files.damaged],
  ["a file that is too large is said in a message", ONE, files.tooLarge],
  ["names of files are shown as text", ONE, files.hostileName],
  ["addresses elsewhere are refused", ONE, files.elsewhere],
  ["keys move the camera and change the look", ONE, use.keys],
  ["dragging with shift turns the light", BOTH, use.turnsLight],
  ["five hundred lights take no memory", BOTH, use.keepsMemory],
  ["the three js example draws what relume render draws", ONE, example.three],
];

const wanted = process.argv.slice(2);
const all = TESTS.flatMap(([statement, kinds, test]) =>
  kinds.map((kind) => ({
    name: `${kind}::${statement.replaceAll(/[^A-Za-z0-9]+/g, "_")}`,
    run: () => test(kind),
    seconds: 240,
  })),
);
const chosen = all.filter(({ name }) => wanted.length === 0 || wanted.some((part) => name.includes(part)));
let good = false;
try {
  good = await runAll(chosen);
} finally {
  await close();
}
process.exit(good ? 0 : 1);
