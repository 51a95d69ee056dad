// Unpacks the compressed parts of the page: the library, and the scripts that use it.
'use strict';

// Eleven digits are nine bytes, the first byte first. Zeros fill up the last nine. The digits of
// base 94 are the characters from the space to "~", without "<", which could begin a tag.
function unpacked(text, length) {
  const bytes = new Uint8Array((text.length / 11) * 9);
  for (let at = 0; at < text.length; at += 11) {
    let number = 0n;
    for (const digit of text.slice(at, at + 11)) {
      const place = digit.charCodeAt(0) - 32;
      number = 94n * number + BigInt(place > 28 ? place - 1 : place);
    }
    for (let place = (at / 11) * 9 + 8; place >= (at / 11) * 9; place -= 1) {
      bytes[place] = Number(number & 255n);
      number >>= 8n;
    }
  }
  return bytes.subarray(0, length);
}

// The bytes of a part of the page.
async function part(id) {
  const { textContent, dataset } = document.getElementById(id);
  const bytes = unpacked(textContent, Number(dataset.length));
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
