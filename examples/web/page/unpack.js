// Unpacks the compressed parts of the page: the library, and the scripts that use it.
'use strict';

// The digits of Z85 (ZeroMQ's RFC 32), with "_" for "<", which could begin a tag.
const DIGITS =
  '0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ.-:+=^!/*?&_>()[]{}@%$#';

// Five digits are four bytes, the first byte first. Zeros fill up the last four.
function unpacked(text, length) {
  const bytes = new DataView(new ArrayBuffer((text.length / 5) * 4));
  for (let at = 0; at < text.length; at += 5) {
    let word = 0;
    for (const digit of text.slice(at, at + 5)) word = 85 * word + DIGITS.indexOf(digit);
    bytes.setUint32((at / 5) * 4, word);
  }
  return new Uint8Array(bytes.buffer, 0, length);
}

// The bytes of a part of the page.
async function part(id) {
  const { textContent, dataset } = document.getElementById(id);
  const bytes = unpacked(textContent.trim(), Number(dataset.length));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Response(stream).arrayBuffer();
}

function cannotStart(error) {
  const place = document.getElementById('error');
  place.textContent = `The page cannot start: ${error.message}`;
  place.hidden = false;
  throw error;
}

async function start() {
  const script = document.createElement('script');
  script.type = 'module';
  script.textContent = new TextDecoder().decode(await part('scripts'));
  document.body.append(script);
}

start().catch(cannotStart);
