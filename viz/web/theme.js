// Colours as in viz/theme.h: the palette of Okabe and Ito (2002), distinct for colour-blind readers. States also differ
// in shape. The dark theme uses lighter versions of the light theme's colours.

const light = {
  paper: '#ffffff', ink: '#202020', quiet: '#55606e', grid: 'rgba(90,100,115,.13)', halo: 'rgba(255,255,255,.9)',
  wall: '#64707d', unseen: '#7d7d7d', hole: '#2b2b33', asphalt: '#c3c8ce', bar: '#808a96',
  magnetUp: '#b3261e', magnetDown: '#1565c0', magnetometer: '#6a1b9a', view: '#b35900', map: '#1748d1', mapFree: '#56b4e9',
  virtualWall: '#8e24aa', dock: '#2e7d32', selected: '#0072b2', contact: '#d55e00', lane: '#00835f', gps: '#b0508a', trail: '#0072b2', curve: '#0072b2',
  lightRed: '#e53935', lightYellow: '#fdd835', lightGreen: '#2e9d57', lightOff: '#616161',
};
const dark = {
  paper: '#14181e', ink: '#e8ebef', quiet: '#a7b1bd', grid: 'rgba(160,175,195,.13)', halo: 'rgba(20,24,30,.9)',
  wall: '#76828f', unseen: '#8d8d8d', hole: '#050506', asphalt: '#343b44', bar: '#808a96',
  magnetUp: '#f2766b', magnetDown: '#64a8f0', magnetometer: '#c58be0', view: '#f0953a', map: '#7d9bff', mapFree: '#56b4e9',
  virtualWall: '#cf82e6', dock: '#6fc274', selected: '#56b4e9', contact: '#ff8a3c', lane: '#2fc79a', gps: '#e29ac4', trail: '#56b4e9', curve: '#56b4e9',
  lightRed: '#ef5350', lightYellow: '#fdd835', lightGreen: '#43b86c', lightOff: '#8a8a8a',
};
export const palettes = { light, dark };

/** The colours of the active theme. */
export const theme = { ...light };
export const isDark = () => theme.paper === dark.paper;
export function useTheme(name) { Object.assign(theme, palettes[name]); }

const channels = (color) => { const value = parseInt(color.slice(1), 16); return [value >> 16, (value >> 8) & 255, value & 255]; };
const hex = (rgb) => '#' + rgb.map((c) => Math.round(Math.min(255, Math.max(0, c))).toString(16).padStart(2, '0')).join('');

/** '#rrggbb' as 'rgba(r,g,b,a)'. */
export function fade(color, alpha) { return `rgba(${channels(color)},${alpha})`; }

/** Interpolates from one colour to another; share 0 is the first. */
export function mix(color, other, share) {
  const to = channels(other);
  return hex(channels(color).map((c, i) => c + share * (to[i] - c)));
}

/** Relative luminance and contrast of WCAG 2.2. */
export function luminance(color) {
  const [r, g, b] = channels(color).map((c) => (c <= 10 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}
export function contrast(a, b) {
  const [dim, bright] = [luminance(a), luminance(b)].sort((x, y) => x - y);
  return (bright + 0.05) / (dim + 0.05);
}

/** Moves a colour towards ink until a thin line in it is visible on paper (contrast 3). */
export function onPaper(color) {
  for (let share = 0; share < 1; share += 0.1) {
    const moved = mix(color, theme.ink, share);
    if (contrast(moved, theme.paper) >= 3) return moved;
  }
  return theme.ink;
}

/** Outline colour for an area of that colour. */
export function edgeOf(color, share) { return onPaper(mix(color, isDark() ? '#ffffff' : '#000000', share)); }

/** Black or white, whichever has more contrast with that colour. */
export const headingOn = (color) => (contrast(color, '#ffffff') > contrast(color, '#000000') ? '#ffffff' : '#000000');

const alikeColors = 24;

/** A distinct colour for each of 24 numbers, as `distinct` in viz/color.cpp: hues differ by the golden angle (OKLCH). */
export function distinct(number) {
  const i = number % alikeColors, lightness = [0.55, 0.4, 0.7][i % 3] + (isDark() ? 0.14 : 0), hue = 4 + 2.399963229728653 * i;
  for (let chroma = 0.17; ; chroma -= 0.005) {
    const a = chroma * Math.cos(hue), b = chroma * Math.sin(hue);
    const [l, m, s] = [lightness + 0.3963377774 * a + 0.2158037573 * b, lightness - 0.1055613458 * a - 0.0638541728 * b, lightness - 0.0894841775 * a - 1.291485548 * b].map((v) => v ** 3);
    const rgb = [4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s, -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s, -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s];
    if (chroma > 0.005 && rgb.some((c) => c < 0 || c > 1)) continue;
    return hex(rgb.map((c) => 255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055)));
  }
}

const alike = 3;  // from this number of robots with one colour, each gets a distinct colour

/** The colour of each mover: its model's, or a distinct one if many look alike. @param own false: always its model's */
export function moverColors(movers, own) {
  const count = new Map();
  for (const { color, tag } of movers) if (!tag) count.set(color, (count.get(color) ?? 0) + 1);
  let number = 0;
  return movers.map(({ color, tag }) => (own && !tag && count.get(color) >= alike ? distinct(number++) : color || theme.wall));
}
