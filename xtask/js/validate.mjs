// Validates .glb files with the Khronos validator: `node validate.mjs FILE…`.
//
// Prints one line per file, and every error of those that have one. Exits 1 when any file has an error or cannot be read, 2 without files.
import { readFile } from "node:fs/promises";
import { validateBytes, version } from "gltf-validator";

const ERROR = 0;
const SHOWN = 20;

/** Validates one file; returns the number of errors. */
async function validate(file) {
  // Everything is inside a .glb: a resource outside it is refused by the default loader.
  const bytes = new Uint8Array(await readFile(file));
  const { issues } = await validateBytes(bytes, { uri: file, maxIssues: 0 });
  const { numErrors, numWarnings, numInfos } = issues;
  console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} notes`);
  const errors = issues.messages.filter((message) => message.severity === ERROR);
  for (const { code, message, pointer } of errors.slice(0, SHOWN)) {
    console.log(`  ${code} at ${pointer ?? "the file"}: ${message}`);
  }
  if (errors.length > SHOWN) {
    console.log(`  … and ${errors.length - SHOWN} more`);
  }
  return numErrors;
}

const files = process.argv.slice(2);
if (files.length === 0) {
  console.error("usage: node validate.mjs FILE…");
  process.exit(2);
}
console.log(`glTF validator ${version()}`);
let failed = false;
for (const file of files) {
  try {
    failed = (await validate(file)) > 0 || failed;
  } catch (failure) {
    console.error(`${file}: ${failure.message ?? failure}`);
    failed = true;
  }
}
process.exit(failed ? 1 : 0);
