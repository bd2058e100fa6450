// Keyboard and pointer input. Its effects are functions of `page`, the `actions` of main.js.

import { keyName } from './key_name.js';

/** Arrow keys that are held down while a robot is driven. */
export const pressed = new Set();

/** The list of keys in the page's help, with their effects. */
export const keyHelp = [['Space', 'pause or continue'], ['N', 'one tick'], ['Shift R', 'restart'], ['1 … 4', 'speed 1/4, 1, 4, max'], ['Arrows', 'pan; while driving: drive'], ['+ −', 'zoom'], ['0', 'show all'], ['[ ]', 'previous, next robot'], ['F', 'follow the robot'], ['V', 'three-dimensional or plan view; drags turn it, with Shift or the right button they pan'], ['C', 'over the image of a camera'], ['D', 'drive the robot'], ['/', 'find a robot'], ['L', 'layers'], ['T', 'dark or light'], [', .', 'recording: one second back, forward'], ['Esc', 'close, stop driving, clear the selection']];

// Letters as without caps lock.
const keys = {
  ' ': (page) => page.togglePaused(), n: (page) => page.step(), 'Shift r': (page) => page.reset(), t: (page) => page.toggleTheme(), f: (page) => page.toggleFollowing(), d: (page) => page.toggleDriving(), v: (page) => page.toggleThird(), c: (page) => page.toggleCamera(),
  '+': (page) => page.zoom(1.25), '=': (page) => page.zoom(1.25), '-': (page) => page.zoom(0.8), '0': (page) => page.fitAll(), Home: (page) => page.fitAll(),
  '[': (page) => page.nextRobot(-1), ']': (page) => page.nextRobot(1), l: (page) => page.openPopup('layers'), '?': (page) => page.openPopup('help'),
  '/': (page) => page.search(), Escape: (page) => page.escape(), ',': (page) => page.seekBy(-1), '.': (page) => page.seekBy(1),
  '1': (page) => page.setSpeed(0.25), '2': (page) => page.setSpeed(1), '3': (page) => page.setSpeed(4), '4': (page) => page.setFastest(),
};
const pans = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

export function keyDown(event, page) {
  const typing = event.target.matches('input[type=search], input[type=url], input[type=number], select, #slider');
  const forSigns = event.getModifierState('AltGraph');  // some layouts need AltGr for brackets, which counts as Ctrl+Alt
  if (!forSigns && (event.ctrlKey || event.metaKey || event.altKey)) return;
  if (typing && event.key === 'Escape') return event.target.blur();
  if (typing || (event.key === ' ' && event.target.matches('button, input'))) return;
  if (page.driving && event.key in pans) { pressed.add(event.key); event.preventDefault(); return; }
  if (event.key in pans) {
    page.pan(60 * pans[event.key][0], 60 * pans[event.key][1]);
  } else if (keys[keyName(event)]) {
    keys[keyName(event)](page);
  } else {
    return;
  }
  event.preventDefault();
}

export function listenToKeys(page) {
  document.addEventListener('keydown', (event) => keyDown(event, page));
  document.addEventListener('keyup', (event) => pressed.delete(event.key));
  window.addEventListener('blur', () => pressed.clear());
}

export function listenToPointer(canvas, page) {
  let from = null, moved = false, pinch = 0;
  const fingers = new Map();
  canvas.onpointerdown = (event) => {
    canvas.focus({ preventScroll: true });
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
    from = [event.offsetX, event.offsetY];
    moved = fingers.size > 1;
    page.openPopup('', false);
  };
  canvas.onpointermove = (event) => {
    if (!fingers.has(event.pointerId)) return;
    fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
    if (fingers.size === 2) {
      const [a, b] = [...fingers.values()], apart = Math.hypot(a[0] - b[0], a[1] - b[1]);
      const middle = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
      if (pinch > 0) {
        page.zoom(apart / pinch, ...middle);
        if (!page.following) page.pan(middle[0] - from[0], middle[1] - from[1]);
      }
      pinch = apart;
      from = middle;
      moved = true;
      return;
    }
    const dx = event.offsetX - from[0], dy = event.offsetY - from[1];
    if (!moved && Math.hypot(dx, dy) < 4) return;
    moved = true;
    page.drag(dx, dy, event);
    from = [event.offsetX, event.offsetY];
  };
  canvas.onpointerup = canvas.onpointercancel = (event) => {
    fingers.delete(event.pointerId);
    pinch = 0;
    if (fingers.size > 0) { [from] = fingers.values(); return; }  // the other finger continues from its position
    if (moved || event.type === 'pointercancel') return;
    page.selectAt(event.offsetX, event.offsetY);
  };
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    page.zoom(Math.exp(-Math.max(-300, Math.min(300, event.deltaY)) * 0.0016), event.offsetX, event.offsetY);
  }, { passive: false });
  canvas.ondblclick = (event) => page.zoom(1.8, event.offsetX, event.offsetY);
}
