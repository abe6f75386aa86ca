// Runs tests and prints what Rust's test harness prints, which `cargo xtask test` counts.

/** Stops a test whose statement does not hold. */
export function check(holds, why) {
  if (!holds) {
    throw new Error(why);
  }
}

/** Rejects when `promise` takes longer than `seconds`. */
function within(seconds, promise) {
  let timer;
  const late = new Promise((_, reject) => {
    timer = setTimeout(() => reject(new Error(`not done after ${seconds} s`)), seconds * 1000);
  });
  return Promise.race([promise, late]).finally(() => clearTimeout(timer));
}

/** Runs one test; gives how it went, and what it said if it failed. */
async function outcome({ run, seconds }) {
  try {
    await within(seconds ?? 120, run());
    return { word: "ok" };
  } catch (failure) {
    return { word: "FAILED", why: failure.stack ?? String(failure) };
  }
}

/** Runs tests `{ name, run, seconds }` one after another; whether none failed. */
export async function runAll(tests) {
  const start = Date.now();
  const count = { ok: 0, FAILED: 0 };
  const failures = [];
  console.log(`\nrunning ${tests.length} tests`);
  for (const test of tests) {
    const { word, why } = await outcome(test);
    count[word] += 1;
    console.log(`test ${test.name} ... ${word}`);
    if (word === "FAILED") {
      failures.push(`---- ${test.name} ----\n${why}\n`);
    }
  }
  if (failures.length > 0) {
    console.log(`\nfailures:\n\n${failures.join("\n")}`);
  }
  const seconds = ((Date.now() - start) / 1000).toFixed(2);
  console.log(
    `\ntest result: ${count.FAILED > 0 ? "FAILED" : "ok"}. ${count.ok} passed; ${count.FAILED} failed; ` +
      `0 ignored; 0 measured; 0 filtered out; finished in ${seconds}s`,
  );
  return count.FAILED === 0;
}
