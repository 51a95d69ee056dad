// Runs the battery's WebAssembly in Node: node run.mjs FILE
import { readFileSync } from 'node:fs';

let text = '';
const print = (at, length) => {
  text += new TextDecoder().decode(new Uint8Array(instance.exports.memory.buffer, at, length));
};
const { instance } = await WebAssembly.instantiate(readFileSync(process.argv[2]), { env: { print } });
const done = instance.exports.run();
process.stdout.write(text);
process.exit(done ? 0 : 1);
