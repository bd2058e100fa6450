// Names of keys, whatever caps lock does.

/**
 * A letter in lower case, after 'Shift ' where Shift is held with R, which restarts; signs as the keyboard's layout has
 * them. Caps lock changes the letter of an event, and not whether Shift is held.
 */
export function keyName({ key, shiftKey }) {
  const letter = key.toLowerCase();
  if (key.length > 1 || letter === key.toUpperCase()) return key;
  return (shiftKey && letter === 'r' ? 'Shift ' : '') + letter;
}
