// Starts the viewer on the canvas: says how far loading is, and in plain words what went wrong. Everything is shown as text.
//
// `window.relume` is there once the program is loaded, for tests and for pages that script it: `start(canvasId)`, and `state()`, which is
// a JSON text.

const CANVAS = "relume";
const LOADING = "Loading Relume…";
const message = document.getElementById("message");

function say(text) {
  message.textContent = text;
}

/** A failure that people can do something about. */
class Trouble extends Error {}

/** The program as a response that says how much of it has come. */
async function program() {
  const name = "relume_viewer_bg.wasm";
  const response = await fetch(new URL(name, import.meta.url));
  if (!response.ok) {
    throw new Trouble(`The server answers ${response.status} for ${name}: upload the page's files again, all of them.`);
  }
  let bytes = 0;
  const counter = new TransformStream({
    transform(chunk, controller) {
      bytes += chunk.byteLength;
      say(`${LOADING} ${(bytes / 1e6).toFixed(1)} MB`);
      controller.enqueue(chunk);
    },
  });
  // Compiled as it comes, whatever type the server gives it.
  const headers = { "Content-Type": "application/wasm" };
  return new Response(response.body.pipeThrough(counter), { headers });
}

/** Whether there is something to draw with; a canvas of its own, because one that has had a context takes no other. */
function canDraw() {
  return "gpu" in navigator || document.createElement("canvas").getContext("webgl2") !== null;
}

async function run() {
  if (typeof WebAssembly !== "object") {
    throw new Trouble("This browser runs no WebAssembly, which Relume is made of: update it, or use another one.");
  }
  if (!canDraw()) {
    throw new Trouble(
      "Relume draws with WebGPU or WebGL2, and this browser offers neither: switch hardware acceleration on in its settings, or use another one.",
    );
  }
  const { default: init, start, state } = await import("./relume_viewer.js");
  await init({ module_or_path: await program() });
  window.relume = { start, state };
  say("Starting Relume…");
  const shown = message.textContent;
  await start(CANVAS);
  // The viewer may have had something to say itself.
  if (message.textContent === shown) {
    say("");
  }
}

/** Says a failure to the person, and everything about it to the console. */
function fail(reason) {
  console.error(reason);
  if (reason instanceof Trouble) {
    say(reason.message);
  } else {
    say(`Relume did not start: ${reason?.message ?? reason}\nReload the page; if that does not help, use another browser.`);
  }
}

/** WebAssembly that has stopped does not go on: say so instead of showing a still picture. */
function stopped(reason) {
  if (reason instanceof WebAssembly.RuntimeError) {
    say("Relume has stopped because of an error of its own; the browser's console says which. Reload the page to go on.");
  }
}

window.addEventListener("error", (event) => stopped(event.error));
window.addEventListener("unhandledrejection", (event) => stopped(event.reason));
run().catch(fail);
