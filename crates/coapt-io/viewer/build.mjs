// Bundles src/report.js and src/panel.js, each with three.js in it; `--check` fails if that is not what stands there.
//
// What is built is committed: program and Python package are made without Node.

import { readFileSync, writeFileSync } from "node:fs";
import { build } from "esbuild";

const bundle = async (entry, format) => {
  const { outputFiles } = await build({
    entryPoints: [`src/${entry}.js`],
    bundle: true,
    minify: true,
    format,
    target: "es2022",
    // The licence of three.js goes with it.
    legalComments: "inline",
    write: false,
  });
  const text = outputFiles[0].text;
  if (/<\/script/i.test(text)) throw new Error(`${entry}: "</script" would end the page's script`);
  return text;
};

const check = process.argv.includes("--check");
for (const [entry, format, path] of [
  ["report", "iife", "built/report.js"],
  ["panel", "esm", "../../../python/src/coapt/_panel.js"],
]) {
  const text = await bundle(entry, format);
  if (!check) writeFileSync(path, text);
  else if (readFileSync(path, "utf8") !== text) {
    console.error(`${path} is not what src makes: npm run build`);
    process.exit(1);
  }
}
