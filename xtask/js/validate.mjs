// Validates .glb files with the Khronos validator: `node validate.mjs [--input FILE] FILE…`.
//
// Prints one line per file, and the errors of those that have any. Exits 1 when a file has an error or cannot be read, 2 without files.
// Errors that the file after --input has too, at the same place, do not count: what came in broken goes out as it came.
import { readFile } from "node:fs/promises";
import { validateBytes, version } from "gltf-validator";

const ERROR = 0;
const SHOWN = 20;

/** The error-severity messages of one file, and how many warnings and notes it has. */
async function check(file) {
  // Everything is inside a .glb: without a loader, a resource outside it is not looked for. All issues are wanted, not the first few.
  const bytes = new Uint8Array(await readFile(file));
  const { issues } = await validateBytes(bytes, { uri: file, maxIssues: 0 });
  const errors = issues.messages.filter((message) => message.severity === ERROR);
  return { errors, warnings: issues.numWarnings, notes: issues.numInfos + issues.numHints };
}

const key = ({ code, message, pointer }) => [code, pointer, message].join("\n");

/** Validates one file and says so; returns the number of errors that are not in `known`. */
async function validate(file, known) {
  const { errors, warnings, notes } = await check(file);
  const fresh = errors.filter((error) => !known.has(key(error)));
  const old = errors.length - fresh.length;
  const also = old > 0 ? ` (and ${old} of the input)` : "";
  console.log(`${file}: ${fresh.length} errors${also}, ${warnings} warnings, ${notes} notes`);
  for (const { code, message, pointer } of fresh.slice(0, SHOWN)) {
    console.log(`  ${code} at ${pointer ?? "the file"}: ${message}`);
  }
  if (fresh.length > SHOWN) {
    console.log(`  … and ${fresh.length - SHOWN} more`);
  }
  return fresh.length;
}

let files = process.argv.slice(2);
let input = null;
if (files[0] === "--input") {
  input = files[1];
  files = files.slice(2);
}
if (files.length === 0) {
  console.error("usage: node validate.mjs [--input FILE] FILE…");
  process.exit(2);
}
console.log(`glTF validator ${version()}`);
let failed = false;
try {
  const known = new Set(input === null ? [] : (await check(input)).errors.map(key));
  for (const file of files) {
    failed = (await validate(file, known)) > 0 || failed;
  }
} catch (failure) {
  console.error(`${failure.message ?? failure}`);
  failed = true;
}
process.exit(failed ? 1 : 0);
