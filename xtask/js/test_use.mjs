// What people do with pointer and keys, and for how long.
import { SIZE, Viewer } from "./chromium.mjs";
import { check } from "./harness.mjs";
import { checkOther } from "./pictures.mjs";

const SCENE = "asset=gallery/ball.glb&light=sun:1,1,0.3,30,9,8,6&exposure=0";

export async function keys(kind) {
  await Viewer.with(kind, SCENE, async (viewer) => {
    const { size } = await viewer.settled();
    let before = await viewer.picture();
    const changes = async (what, act) => {
      await act();
      await viewer.settled();
      const after = await viewer.picture();
      await checkOther(what, before, after);
      before = after;
    };
    const { keyboard } = viewer.page;
    await changes("b (background)", () => keyboard.press("b"));
    await changes("period (exposure)", () => keyboard.press("."));
    await changes("arrow right, held (camera)", () => keyboard.press("ArrowRight", { delay: 500 }));
    await changes("r (camera back)", () => keyboard.press("r"));
    await changes("F2 (panels)", () => keyboard.press("F2"));
    const all = (await viewer.state()).size;
    check(all[0] === SIZE.width && all[1] === SIZE.height, `F2: from ${size} to ${all} pixels`);
    check(size[0] * size[1] < all[0] * all[1], `panels were no part of ${size} pixels`);
    viewer.checkQuiet();
  });
}

/** Drags along a line in `steps` moves with shift held; `each` runs after every move. */
async function drag(viewer, steps, each = () => {}) {
  const { mouse, keyboard } = viewer.page;
  const [left, y] = [SIZE.width * 0.2, SIZE.height / 2];
  await mouse.move(left, y);
  await keyboard.down("Shift");
  await mouse.down();
  for (let i = 1; i <= steps; i += 1) {
    // Back and forth.
    const at = Math.abs(((i / 30) % 2) - 1);
    await mouse.move(left + SIZE.width * 0.6 * (1 - at), y);
    await each();
  }
  await mouse.up();
  await keyboard.up("Shift");
}

export async function turnsLight(kind) {
  await Viewer.with(kind, `${SCENE}&panel=0`, async (viewer) => {
    const { relights } = await viewer.settled();
    const before = await viewer.picture();
    await drag(viewer, 10);
    const after = await viewer.settled();
    check(after.relights > relights, `${after.relights} relights after ${relights}`);
    await checkOther("dragging with shift", before, await viewer.picture());
    viewer.checkQuiet();
  });
}

/** JavaScript's heap after what is garbage has gone, and the program's memory. */
async function memory(viewer, session) {
  await session.send("HeapProfiler.collectGarbage");
  const { metrics } = await session.send("Performance.getMetrics");
  const heap = metrics.find(({ name }) => name === "JSHeapUsedSize").value;
  const { memory_pages: pages, relights } = await viewer.state();
  return { heap, pages, relights };
}

export async function keepsMemory(kind) {
  await Viewer.with(kind, `${SCENE}&panel=0`, async (viewer) => {
    await viewer.settled();
    const session = await viewer.context.newCDPSession(viewer.page);
    await session.send("Performance.enable");
    // Buffers and caches find their size.
    const enough = async (target) => {
      while ((await viewer.state()).relights < target) {
        await drag(viewer, 60);
      }
    };
    await enough(100);
    const before = await memory(viewer, session);
    await enough(before.relights + 500);
    const after = await memory(viewer, session);
    // Pages are 64 KiB and are never given back: a leak of one light (300 bytes) each time is three of them, of one frame's vertices many more.
    check(after.pages <= before.pages + 1, `the program's memory grew from ${before.pages} to ${after.pages} pages`);
    // A leak of one small object (100 bytes) each time is 50 kB; engines keep about as much for themselves, more or less.
    const growth = after.heap - before.heap;
    check(growth < 100_000, `JavaScript's heap grew by ${growth} bytes over ${after.relights - before.relights} lights`);
    viewer.checkQuiet();
  });
}
