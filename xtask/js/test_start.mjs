// How the page starts, and what it says when it cannot.
import { SIZE, Viewer } from "./chromium.mjs";
import { check } from "./harness.mjs";

export async function startsQuietly(kind) {
  await Viewer.with(kind, "", async (viewer) => {
    await viewer.started();
    check((await viewer.message()) === "", `still says ${await viewer.message()}`);
    viewer.checkQuiet();
  });
}

/** Which one draws is the viewer's own word; that something is drawn, the pixels'. */
export async function drawsWith(kind) {
  await Viewer.with(kind, "", async (viewer) => {
    const { backend } = await viewer.when("first frames", (state) => state.frames > 2);
    check(backend === kind, `draws with ${backend}`);
    await checkDrawn(viewer);
    viewer.checkQuiet();
  });
}

export async function fallsBack(kind) {
  const init = () => delete Navigator.prototype.gpu;
  const use = async (viewer) => {
    const { backend } = await viewer.when("first frames", (state) => state.frames > 2);
    check(backend === "webgl2", `draws with ${backend}`);
    await checkDrawn(viewer);
    viewer.checkQuiet();
  };
  await Viewer.with(kind, "", use, { init });
}

/** A canvas on which nothing was drawn is one colour. */
async function checkDrawn(viewer) {
  const bytes = (await viewer.picture()).length;
  const plain = await viewer.page.evaluate(async ({ width, height }) => {
    const canvas = new OffscreenCanvas(width, height);
    canvas.getContext("2d").fillRect(0, 0, width, height);
    return (await canvas.convertToBlob({ type: "image/png" })).size;
  }, SIZE);
  check(bytes > 2 * plain, `the canvas is blank: ${bytes} bytes as a PNG, ${plain} would be one colour`);
}

export async function cannotDraw(kind) {
  const init = () => {
    delete Navigator.prototype.gpu;
    const getContext = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (name, ...rest) {
      return name === "webgl2" ? null : getContext.call(this, name, ...rest);
    };
  };
  const use = async (viewer) => {
    await viewer.until("word about it", async () => (await viewer.message()).includes("this browser offers neither"));
    const asked = await viewer.page.evaluate(() => performance.getEntriesByType("resource").map(({ name }) => name));
    check(!asked.some((name) => name.endsWith(".wasm")), "loads a program that cannot run");
  };
  await Viewer.with(kind, "", use, { init });
}

export async function noProgram(kind) {
  for (const [answer, words] of [
    [(route) => route.fulfill({ status: 404, body: "" }), "answers 404 for relume_viewer_bg.wasm"],
    [(route) => route.abort(), "Relume did not start"],
    [(route) => route.fulfill({ status: 200, body: "<!doctype html>" }), "Relume did not start"],
  ]) {
    const prepare = (page) => page.route("**/*.wasm", answer);
    const use = (viewer) => viewer.until(words, async () => (await viewer.message()).includes(words));
    await Viewer.with(kind, "", use, { prepare });
  }
}

export async function policyHolds(kind) {
  await Viewer.with(kind, "", async (viewer) => {
    await viewer.started();
    const broken = await viewer.page.evaluate(tryToBreakOut);
    check(broken.length === 0, broken.join("; "));
    check(viewer.complaints.some((what) => what.includes("Content Security Policy")), "nothing was refused");
  });
}

/** Runs in the page; gives what it should not have been able to do. */
async function tryToBreakOut() {
  const broken = [];
  // What a debugger runs may evaluate; what comes after it is the page's own.
  await new Promise((resolve) => setTimeout(resolve));
  const attempt = async (what, act) => {
    try {
      await act();
      broken.push(what);
    } catch {
      // As it should be.
    }
  };
  await attempt("eval", () => (0, eval)("1"));
  await attempt("a function made of text", () => new Function("return 1")());
  await attempt("markup made of text", () => (document.createElement("p").innerHTML = "<b>x</b>"));
  await attempt("another host", () => fetch("http://127.0.0.1:9/"));
  await attempt("a script of data", () => import("data:text/javascript,1"));
  await attempt("a script in the page", () => {
    const script = document.createElement("script");
    script.append("window.ran = true");
    document.body.append(script);
    if (!window.ran) {
      throw new Error("refused");
    }
  });
  await attempt("a form", async () => {
    const form = Object.assign(document.createElement("form"), { action: "http://127.0.0.1:9/", target: "_blank" });
    const refused = new Promise((resolve) => document.addEventListener("securitypolicyviolation", resolve, { once: true }));
    document.body.append(form);
    form.submit();
    await Promise.race([refused.then(() => Promise.reject(new Error("refused"))), new Promise((r) => setTimeout(r, 1000))]);
  });
  return broken;
}

export async function fillsWindow(kind) {
  const use = async (viewer) => {
    const fits = ({ width, height }) => (state) => state.size[0] === width && state.size[1] === height;
    // Device pixels, not the page's.
    await viewer.when("picture as large as the window", fits({ width: 600, height: 900 }));
    await viewer.page.setViewportSize({ width: 450, height: 300 });
    await viewer.when("picture that follows the window", fits({ width: 900, height: 600 }));
    viewer.checkQuiet();
  };
  const phone = { size: { width: 300, height: 450 }, scale: 2 };
  await Viewer.with(kind, "panel=0&asset=gallery/ball.glb", use, phone);
}
