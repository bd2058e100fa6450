// Colours as in viz/theme.h: the palette of Okabe and Ito (2002), distinct for colour-blind readers. States are told
// apart by shape as well.

export const series = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#000000'];

export const theme = {
  paper: '#ffffff', ink: '#202020', quiet: '#55606e', grid: 'rgba(90,100,115,.13)',
  wall: '#64707d', unseen: '#7d7d7d', hole: '#2b2b33', asphalt: '#c3c8ce',
  magnetUp: '#b3261e', magnetDown: '#1565c0', magnetometer: '#6a1b9a', view: '#b35900', map: '#1748d1',
  virtualWall: '#8e24aa', selected: '#0072b2', contact: '#d55e00', lane: '#009e73', gps: '#cc79a7', trail: '#0072b2',
  lightRed: '#e53935', lightYellow: '#fdd835', lightGreen: '#2e9d57', lightOff: '#616161',
};

/** '#rrggbb' as 'rgba(r,g,b,a)'. */
export function fade(color, alpha) {
  const value = parseInt(color.slice(1), 16);
  return `rgba(${value >> 16},${(value >> 8) & 255},${value & 255},${alpha})`;
}

/** A colour that is visible as a thin line on white. */
export function onPaper(color) {
  const value = parseInt(color.slice(1), 16);
  const light = 0.2126 * (value >> 16) + 0.7152 * ((value >> 8) & 255) + 0.0722 * (value & 255);
  if (light < 150) return color;
  const part = (shift) => Math.round((((value >> shift) & 255) * 110) / light).toString(16).padStart(2, '0');
  return `#${part(16)}${part(8)}${part(0)}`;
}

/** A colour mixed with black. */
export function darker(color, share) {
  const value = parseInt(color.slice(1), 16);
  const part = (shift) => Math.round(((value >> shift) & 255) * (1 - share));
  return `rgb(${part(16)},${part(8)},${part(0)})`;
}
