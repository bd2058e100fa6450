// Starts a run of the program with a live view, for checks.

const { spawn } = require("child_process");

/** Starts `program` with `args`. `url` is the address of its view; `end()` interrupts it and returns its exit code. */
function start(program, args) {
  const child = spawn(program, args, { stdio: ["ignore", "ignore", "pipe"] });
  let said = "";
  const ended = new Promise((resolve) => child.on("exit", (code, signal) => resolve(signal ?? code)));
  const url = new Promise((resolve, reject) => {
    child.stderr.on("data", (data) => {
      said += data;
      const found = /view on (\S+)/.exec(said);
      if (found) resolve(found[1]);
    });
    ended.then((code) => reject(new Error(`${program} ${args.join(" ")} ended with ${code}: ${said}`)));
  });
  process.on("exit", () => child.kill("SIGKILL"));
  const end = () => {
    child.kill("SIGINT");
    return ended;
  };
  return { url, end };
}

function check(condition, message) {
  if (!condition) throw new Error(message);
}

/** Exits with an error if `main` throws or takes longer than that. */
function run(main, minutes = 2) {
  const guard = setTimeout(() => {
    console.error(`not done after ${minutes} minutes`);
    process.exit(1);
  }, 60_000 * minutes);
  main().then(
    () => clearTimeout(guard),
    (error) => {
      console.error(error);
      process.exit(1);
    },
  );
}

module.exports = { start, check, run };
