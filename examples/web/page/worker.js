// Tosses and the battery of scenes, beside the page, so that it stays responsive.
'use strict';

const AT_ONCE = 5;

onmessage = async ({ data }) => {
  const { instance } = await WebAssembly.instantiate(data.bytes, {});
  const calls = instance.exports;
  const text = () => {
    const bytes = new Uint8Array(calls.memory.buffer, calls.text(), calls.text_length());
    return new TextDecoder().decode(bytes);
  };
  if (data.task === 'bits') {
    const failed = calls.bits() !== 0;
    postMessage({ failed, text: text() });
    return;
  }
  new BigUint64Array(calls.memory.buffer, calls.parameters(), data.parameters.length).set(data.parameters);
  const counts = new Float64Array(calls.memory.buffer, calls.tosses(), data.places);
  for (let first = 0; first < data.tosses; first += AT_ONCE) {
    const end = Math.min(first + AT_ONCE, data.tosses);
    if (calls.toss(data.seed, first, end) !== 0) {
      postMessage({ failed: true, text: text() });
      return;
    }
    postMessage({ counts: [...counts], done: end });
  }
};
