// How long the viewer's page takes from its opening to the first lit picture, in a browser that has nothing of it yet: `cargo xtask bench page`.
//
// RELUME_PAGE is the page's address on this machine, RELUME_CHROMIUM the browser. Prints a line for each way to draw and scene.
import { close, Viewer } from "./chromium.mjs";

const TIMES = 5;

/** Milliseconds since the page was asked for, at the first frame after light fell on a scene; 0 before. */
function lit() {
  const state = window.relume?.state && JSON.parse(window.relume.state() || "null");
  return state?.scene && state.relights > 0 && state.frames > 2 ? performance.now() : 0;
}

/** One opening: when the program's code was all there, and when its picture was. */
async function open(kind, query) {
  let times;
  await Viewer.with(kind, query, async ({ page }) => {
    const picture = await (await page.waitForFunction(lit, undefined, { polling: "raf", timeout: 120_000 })).jsonValue();
    const loaded = await page.evaluate(() => {
      const program = performance.getEntriesByType("resource").find(({ name }) => name.endsWith(".wasm"));
      return program.responseEnd;
    });
    times = { loaded, picture };
  });
  return times;
}

const middle = (values) => values.sort((a, b) => a - b)[Math.floor(values.length / 2)];

console.log("drawn with\tscene\tprogram there, s\tfirst lit picture, s (medians)");
try {
  for (const kind of ["webgpu", "webgl2"]) {
    for (const scene of ["ball", "courtyard"]) {
      const query = `asset=gallery/${scene}.glb&light=sky:30,3`;
      // The browser itself is started by the first.
      await open(kind, query);
      const times = [];
      for (let i = 0; i < TIMES; i++) {
        times.push(await open(kind, query));
      }
      const seconds = (of) => (middle(times.map(of)) / 1000).toFixed(2);
      console.log([kind, scene, seconds(({ loaded }) => loaded), seconds(({ picture }) => picture)].join("\t"));
    }
  }
} finally {
  await close();
}
