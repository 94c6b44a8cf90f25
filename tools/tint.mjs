// Compile WGSL with Tint, and make pipelines of it with Dawn: node tools/tint.mjs WEBGPU FOLDER, where WEBGPU is the folder of
// the package webgpu and FOLDER what `cargo run --example shaders` wrote. A driver is needed that Dawn takes.
// Ends with 1 when something is refused or warned of, and when a spoilt shader is not.
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { createRequire } from "node:module";

const [packageFolder, folder] = process.argv.slice(2);
const require = createRequire(import.meta.url);
const { create, globals } = await import(join(packageFolder, "index.js"));
Object.assign(globalThis, globals);

// Keep the instance: Dawn falls when it is collected.
globalThis.instance = create([]);
const adapter = await globalThis.instance.requestAdapter();
if (!adapter) throw new Error("Dawn takes no adapter");
const device = await adapter.requestDevice();
console.log(`Tint on ${adapter.info.description || adapter.info.device}`);

/** What Tint and the pipeline say of a text; nothing when they take it. */
async function complaints(code, pipelines) {
    device.pushErrorScope("validation");
    const module = device.createShaderModule({ code });
    const said = (await module.getCompilationInfo()).messages.map((m) => `${m.type} ${m.lineNum}: ${m.message}`);
    const scope = await device.popErrorScope();
    if (scope && said.length === 0) said.push(scope.message);
    for (const [name, entryPoint, constants] of said.length ? [] : pipelines) {
        const compute = { module, entryPoint, constants };
        await device.createComputePipelineAsync({ layout: "auto", compute }).catch((e) => said.push(`${name}: ${e.message}`));
    }
    return said;
}

let [failed, made] = [false, 0];
const files = readdirSync(folder);
for (const text of files.filter((file) => file.endsWith(".wgsl"))) {
    const shader = text.slice(0, -5);
    const code = readFileSync(join(folder, text), "utf8");
    const own = files.filter((file) => file.startsWith(`${shader}.`) && file.endsWith(".json"));
    // JSON has no booleans here; Dawn takes numbers for them.
    const pipelines = own.map((file) => [file, file.split(".")[1], JSON.parse(readFileSync(join(folder, file), "utf8"))]);
    made += pipelines.length;
    for (const line of await complaints(code, pipelines)) {
        console.log(`${text}: ${line}`);
        failed = true;
    }
    if ((await complaints(code.replace("var ", "var<wrong> "), [])).length === 0) {
        console.log(`${text}: Tint takes it when it is spoilt`);
        failed = true;
    }
}
console.log(`${made} pipelines`);
process.exit(failed || made === 0 ? 1 : 0);
