// The address: all bits of the scene and of the start of the run, in hexadecimal.

const ADDRESS = /^#1((\.[0-9a-f]{16}){24})$/;

function writtenAddress(tumble) {
  const words = [...tumble.parameterBits, ...tumble.startBits];
  return `#1${words.map((word) => '.' + word.toString(16).padStart(16, '0')).join('')}`;
}

// Reads scene and start. Returns false if the address has none.
function readAddress(tumble, address) {
  if (address.length < 2) return false;
  const found = ADDRESS.exec(address);
  if (!found)
    throw new Refusal(
      'the address of this page names no throw: a part of it is missing or changed',
    );
  const words = found[1]
    .slice(1)
    .split('.')
    .map((word) => BigInt(`0x${word}`));
  const before = [[...tumble.parameterBits], [...tumble.startBits]];
  tumble.parameterBits.set(words.slice(0, PARAMETERS));
  tumble.startBits.set(words.slice(PARAMETERS));
  try {
    tumble.call('check');
    tumble.call('restart');
  } catch (refusal) {
    tumble.parameterBits.set(before[0]);
    tumble.startBits.set(before[1]);
    throw refusal;
  }
  return true;
}

function showAddress(address) {
  try {
    history.replaceState(null, '', address);
  } catch {
    location.hash = address; // where a page from disk has no history of its own
  }
}
