// The example for three.js: what it draws, held against the program by the check that lies beside it.
import { execFile } from "node:child_process";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";
import { program, SIZE } from "./chromium.mjs";
import { rendered } from "./pictures.mjs";

const run = promisify(execFile);
const LIGHT = ["--light", "sky:30,3"];
/** Seen so that its textures are not made smaller: see check.mjs. */
const VIEW = { eye: "1.6,1.2,2.4", target: "0,0.4,0", fov: "40" };

export async function three() {
  const folder = process.env.RELUME_THREE_FOLDER;
  await run(process.env.RELUME, ["light", LIGHT[1], "-o", join(folder, "light.json")]);
  for (const [scene, turn] of [["ball", 0], ["room", 75]]) {
    const flags = [...LIGHT, "--background", "black", "--samples-per-pixel", "1", "--exposure", "0"];
    for (const [name, value] of Object.entries(VIEW)) {
      flags.push(`--${name}`, value);
    }
    flags.push("--rotate", `0,1,0:${turn}`);
    await rendered(`three-${scene}`, `${scene}.glb`, SIZE, flags);
    const query = new URLSearchParams({ asset: `../page/gallery/${scene}.glb`, turn, ...VIEW });
    const picture = join(process.env.RELUME_PICTURES, `three-${scene}.expected.png`);
    const env = { ...process.env, RELUME_CHROMIUM: await program(), NODE_PATH: fileURLToPath(new URL("node_modules", import.meta.url)) };
    const { stdout } = await run("node", [join(folder, "check.mjs"), `${process.env.RELUME_THREE}?${query}`, picture], { env });
    console.log(`${scene}: ${stdout.trim()}`);
  }
}
