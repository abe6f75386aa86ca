// Files that people bring, good and bad, and addresses.
import { Viewer } from "./chromium.mjs";
import { check } from "./harness.mjs";

/** Runs in the page: a scene of the gallery, the first `share` of it. */
async function fromGallery({ scene, share }) {
  const bytes = await (await fetch(`gallery/${scene}`)).arrayBuffer();
  return [bytes.slice(0, Math.floor(bytes.byteLength * share))];
}

/** Waits until the viewer shows a message that `fits`; it is one line of text. */
async function said(viewer, fits) {
  const state = await viewer.when(`message like ${fits}`, ({ messages }) => messages.some((text) => fits.test(text)));
  const text = state.messages.find((text) => fits.test(text));
  check(!text.includes("\n"), `more than a line: ${text}`);
  return state;
}

export async function dropped(kind) {
  await Viewer.with(kind, "", async (viewer) => {
    await viewer.when("first frame", (state) => state.frames > 0);
    await viewer.drop("mine.glb", fromGallery, { scene: "ball.glb", share: 1 });
    const state = await viewer.settled();
    check(state.scene.startsWith("mine"), `the scene is ${state.scene}`);
    check(state.vertices > 0 && state.messages.length === 0, JSON.stringify(state));
    // Another one takes its place.
    await viewer.drop("other.glb", fromGallery, { scene: "room.glb", share: 1 });
    await viewer.when("other scene", ({ scene }) => scene.startsWith("other"));
    viewer.checkQuiet();
  });
}

/** Drops bytes under a name, and expects a message and the scene that was there. */
async function refused(kind, name, makeParts, data, fits) {
  await Viewer.with(kind, "asset=gallery/ball.glb", async (viewer) => {
    const { scene } = await viewer.settled();
    await viewer.drop(name, makeParts, data);
    const state = await said(viewer, fits);
    check(state.scene === scene, `the scene is ${state.scene} now`);
    viewer.checkQuiet();
  });
}

export async function noAsset(kind) {
  await refused(kind, "letter.glb", () => ["Dear viewer"], null, /letter\.glb/);
  // A .glb, and nothing baked.
  const bare = () => {
    const json = JSON.stringify({ asset: { version: "2.0" } }).padEnd(28);
    const head = new Uint32Array([0x46546c67, 2, 20 + json.length, json.length, 0x4e4f534a]);
    return [head, json];
  };
  await refused(kind, "bare.glb", bare, null, /bare\.glb/);
  await refused(kind, "photo.png", () => ["no picture"], null, /photo\.png/);
}

export async function damaged(kind) {
  await refused(kind, "cut.glb", fromGallery, { scene: "ball.glb", share: 0.6 }, /cut\.glb/);
  const lying = async () => {
    const bytes = new Uint8Array(await (await fetch("gallery/ball.glb")).arrayBuffer());
    // Counts and offsets become nines.
    const end = 20 + new DataView(bytes.buffer).getUint32(12, true);
    for (let i = 20; i < end; i += 1) {
      bytes[i] = bytes[i] >= 0x31 && bytes[i] <= 0x38 ? 0x39 : bytes[i];
    }
    return [bytes];
  };
  await refused(kind, "lying.glb", lying, null, /lying\.glb/);
}

export async function tooLarge(kind) {
  // A gigabyte that takes no room: one part many times.
  const large = () => Array(1024).fill(new Blob([new Uint8Array(1 << 20)]));
  await refused(kind, "large.glb", large, null, /large\.glb.*(large|MB)/);
}

export async function hostileName(kind) {
  const name = "<img src=x onerror=alert(1)>\u202e\n.glb";
  await Viewer.with(kind, "", async (viewer) => {
    await viewer.when("first frame", (state) => state.frames > 0);
    await viewer.drop(name, () => ["no asset"], null);
    await said(viewer, /onerror/);
    const images = await viewer.page.locator("img").count();
    check(images === 0, "the name has become markup");
    viewer.checkQuiet();
  });
}

export async function elsewhere(kind) {
  for (const address of [
    "https://elsewhere.example/x.glb",
    "//elsewhere.example/x.glb",
    "/\\elsewhere.example/x.glb",
    "\\\\elsewhere.example/x.glb",
    " https://elsewhere.example/x.glb",
    "data:model/gltf-binary,glTF",
    "blob:null/1",
    "javascript:alert(1)",
    "file:///etc/passwd",
  ]) {
    await Viewer.with(kind, `asset=${encodeURIComponent(address)}`, async (viewer) => {
      const state = await viewer.when("refusal", ({ messages }) => messages.length > 0);
      check(state.scene === null, `${address} is shown`);
      viewer.checkQuiet();
    });
  }
}
