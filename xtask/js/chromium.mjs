// Chromium with one way to draw or the other, and the viewer's page in it.
import { chromium } from "playwright-core";
import { check } from "./harness.mjs";

/** Of the 3D picture, in pixels: large enough to see edges, small enough for a renderer in software. */
export const SIZE = { width: 480, height: 270 };

const BASE = [
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
];
/** With other sets of flags a WebGPU canvas stays blank while everything reports success: tests look at pixels, too. */
const FLAGS = {
  webgl2: BASE,
  webgpu: [
    ...BASE,
    "--enable-unsafe-webgpu",
    "--use-angle=swiftshader",
    "--enable-features=Vulkan",
    "--use-vulkan=swiftshader",
  ],
  // Emulated ones scale the page but not the boxes, in device pixels, that canvases are made by.
  twofold: [...BASE, "--force-device-scale-factor=2"],
};

const browsers = new Map();

/** The browser that draws with `kind`, started once. */
export async function browser(kind) {
  if (!browsers.has(kind)) {
    const options = { executablePath: await program(), chromiumSandbox: false, args: FLAGS[kind] };
    browsers.set(kind, await chromium.launch(options));
  }
  return browsers.get(kind);
}

/** Ends all browsers. */
export async function close() {
  await Promise.all([...browsers.values()].map((each) => each.close()));
}

/** Where the browser named by RELUME_CHROMIUM is on the path. */
export async function program() {
  const { execFileSync } = await import("node:child_process");
  const name = process.env.RELUME_CHROMIUM ?? "chromium";
  return execFileSync("/bin/sh", ["-c", 'command -v "$1"', "sh", name], { encoding: "utf8" }).trim();
}

/** The viewer's page: what it complains of, what it says of itself, and what people do to it. */
export class Viewer {
  /** What went wrong, as far as the browser noticed: errors on the console, policy violations, files that did not come. */
  complaints = [];
  /** Addresses that were asked for outside the page's folder. */
  strays = [];

  constructor(context, page) {
    this.context = context;
    this.page = page;
    const complain = (what) => this.complaints.push(what);
    page.on("console", (message) => message.type() === "error" && complain(`console: ${message.text()}`));
    page.on("pageerror", (error) => complain(`uncaught: ${error.stack ?? error}`));
    page.on("requestfailed", (request) => complain(`failed: ${request.url()}`));
    page.on("request", (request) => {
      if (!request.url().startsWith(process.env.RELUME_PAGE)) {
        this.strays.push(request.url());
      }
    });
  }

  /**
   * Opens the page in the browser for `kind`, with the part of the address after `?`.
   * `init` runs in the page before anything of its own; `prepare` gets the Playwright page before it loads; `size` and `scale` are of its window.
   */
  static async open(kind, query = "", { init, prepare, size = SIZE, scale = 1 } = {}) {
    const context = await (await browser(kind)).newContext({ viewport: size, deviceScaleFactor: scale });
    const page = await context.newPage();
    const viewer = new Viewer(context, page);
    if (init) {
      await page.addInitScript(init);
    }
    await prepare?.(page);
    await page.goto(`${process.env.RELUME_PAGE}${query && `?${query}`}`);
    return viewer;
  }

  /** Opens the page, hands it to `use` and closes it. */
  static async with(kind, query, use, options) {
    const viewer = await Viewer.open(kind, query, options);
    try {
      await use(viewer);
    } finally {
      await viewer.context.close();
    }
  }

  /** The text in the page's message place. */
  message() {
    return this.page.locator("#message").textContent();
  }

  /** Waits until `ask` gives something true, and gives it; fails with the last state and all complaints. */
  async until(what, ask, seconds = 60) {
    const deadline = Date.now() + seconds * 1000;
    let answer;
    while (!(answer = await ask())) {
      if (Date.now() > deadline) {
        const state = await this.state().catch((failure) => failure.message);
        const said = JSON.stringify({ state, message: await this.message(), complaints: this.complaints });
        throw new Error(`no ${what} after ${seconds} s: ${said}`);
      }
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
    return answer;
  }

  /** Waits until the program runs and the page has nothing more to say about starting. */
  async started() {
    const runs = () => this.page.evaluate(() => typeof window.relume?.start === "function");
    await this.until("running program", runs);
    await this.until("end of the starting message", async () => !(await this.message()).startsWith("Starting"));
  }

  /** What the viewer says of itself; nothing before its first frame, and throws before it runs. */
  async state() {
    return JSON.parse((await this.page.evaluate(() => window.relume.state())) || "null");
  }

  /** Waits for a state of which `holds` is true, and gives it. */
  async when(what, holds, seconds) {
    await this.started();
    return this.until(what, async () => {
      const state = await this.state();
      return state !== null && holds(state) && state;
    }, seconds);
  }

  /** Waits until a scene is lit and frames stop coming, so that what is shown is what will be shown. */
  async settled() {
    const lit = (state) => state.scene !== null && state.relights > 0 && state.frames > 2;
    let before = await this.when("lit scene", lit);
    return this.until("frame without a successor", async () => {
      await new Promise((resolve) => setTimeout(resolve, 300));
      const now = await this.state();
      const still = now.frames === before.frames;
      before = now;
      return still && now;
    });
  }

  /** What the page shows, as a PNG. */
  picture() {
    return this.page.screenshot({ type: "png" });
  }

  /** Drops a file on the canvas; `makeParts` is run in the page with `data` and gives what the file consists of. */
  async drop(name, makeParts, data) {
    const parts = await this.page.evaluateHandle(makeParts, data);
    await this.page.evaluate(
      ([name, parts]) => {
        const transfer = new DataTransfer();
        transfer.items.add(new File(parts, name));
        const canvas = document.getElementById("relume");
        for (const type of ["dragenter", "dragover", "drop"]) {
          const event = new DragEvent(type, { dataTransfer: transfer, bubbles: true, cancelable: true });
          canvas.dispatchEvent(event);
        }
      },
      [name, parts],
    );
  }

  /** Fails where something went wrong that a person at the browser's console would see, or something came from elsewhere. */
  checkQuiet() {
    check(this.complaints.length === 0, this.complaints.join("\n"));
    check(this.strays.length === 0, `asked for ${this.strays.join(", ")}`);
  }
}
