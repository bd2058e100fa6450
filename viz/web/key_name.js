// Key names, independent of caps lock.

/**
 * Returns letters in lower case, with the prefix 'Shift ' for Shift and R, which restarts; signs as in the keyboard's
 * layout. Caps lock changes the letter of an event but not its Shift state.
 */
export function keyName({ key, shiftKey }) {
  const letter = key.toLowerCase();
  if (key.length > 1 || letter === key.toUpperCase()) return key;
  return (shiftKey && letter === 'r' ? 'Shift ' : '') + letter;
}
