// The library in WebAssembly: its functions, and its blocks of numbers as arrays.
'use strict';

const PARAMETER = {
  body: 0,
  method: 1,
  step: 2,
  stiffness: 3,
  damping: 4,
  friction: 5,
  slip: 6,
  gravity: 7,
  start: 8,
  lean: 9,
  spin: 10,
};
const PARAMETERS = 11;
const STATE = 13;
const RUN = {
  steps: 13,
  energies: 14,
  total: 18,
  largest: 19,
  sum: 20,
  touching: 21,
  turning: 22,
  samples: 25,
  path: 26,
};
const RUN_LENGTH = 26 + 3 * 32;
const FACES = 6;

class Tumble {
  constructor(instance) {
    const calls = instance.exports;
    const memory = calls.memory.buffer; // never grows: the library does not allocate
    this.calls = calls;
    this.parameters = new Float64Array(memory, calls.parameters(), PARAMETERS);
    this.parameterBits = new BigUint64Array(memory, calls.parameters(), PARAMETERS);
    this.startBits = new BigUint64Array(memory, calls.start(), STATE);
    this.runs = [0, 1].map((number) => new Float64Array(memory, calls.run(number), RUN_LENGTH));
    this.runBits = [0, 1].map((number) => new BigUint64Array(memory, calls.run(number), STATE));
    this.counts = new Float64Array(memory, calls.tosses(), FACES + 2);
    this.interval = new Float64Array(memory, calls.interval(), 2);
    this.textBytes = new Uint8Array(memory, calls.text(), 1024);
  }

  text() {
    return new TextDecoder().decode(this.textBytes.slice(0, this.calls.text_length()));
  }

  // Throws the library's own message if a call has no result.
  call(name, ...values) {
    if (this.calls[name](...values) !== 0) throw new Refusal(this.text());
  }

  wilson(count, total) {
    this.calls.wilson(count, total);
    return [...this.interval];
  }
}

// An input that the library refuses, with its reason.
class Refusal extends Error {}

async function loadTumble(bytes) {
  const { instance } = await WebAssembly.instantiate(bytes, {});
  return new Tumble(instance);
}
