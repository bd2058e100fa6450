// The world that the page draws: /scene.json and its static parts, drawn once per view.

import { theme, fade, edgeOf } from './theme.js';

export async function loadScene(token) {
  const response = await fetch('scene.json' + (token ? `?token=${encodeURIComponent(token)}` : ''));
  if (!response.ok) throw new Error((await response.text()).trim());
  const scene = await response.json();
  // Browsers store paths as float32: relative to this origin, coordinates are exact far from the world's origin.
  scene.origin = [(scene.extent[0] + scene.extent[2]) / 2, (scene.extent[1] + scene.extent[3]) / 2];
  return scene;
}

function addLine(path, line, [ox, oy], close) {
  for (let i = 0; i < line.length; i += 2) path[i === 0 ? 'moveTo' : 'lineTo'](line[i] - ox, line[i + 1] - oy);
  if (close && line.length > 4 && line[0] === line[line.length - 2] && line[1] === line[line.length - 1]) path.closePath();
}

/** The area that beams with an opening angle reach, as a path in metres around a pose. */
export function sectorPath(x, y, direction, fov, range) {
  const path = new Path2D();
  if (fov < 2 * Math.PI - 1e-3) path.moveTo(x, y);
  path.arc(x, y, range, direction - fov / 2, direction + fov / 2);
  path.closePath();
  return path;
}

export class StaticLayer {
  #canvas = document.createElement('canvas');
  #area = null;
  #groups = [];

  constructor(scene) {
    this.scene = scene;
    const { origin } = scene;
    this.segments = 0;
    for (const { kind, color, closed, lines } of scene.walls) {
      const path = new Path2D();
      for (const line of lines) {
        addLine(path, line, origin, closed);
        this.segments += line.length / 2 - 1;
      }
      this.#groups.push({ kind, closed, path, color });
    }
    const order = ['unseen', 'overhead', 'passable', 'solid'];
    this.#groups.sort((a, b) => order.indexOf(a.kind) - order.indexOf(b.kind));
    this.markings = scene.markings.map(({ line, width, color }) => {
      const path = new Path2D();
      addLine(path, line, origin, false);
      return { path, width, color };
    });
  }

  /** Redraws the layer at the next frame, in other colours. */
  restyle() { this.#area = null; }

  /** Copies the layer onto `context`. Redraws it first if the view has left the drawn area. */
  draw(context, camera, ratio) {
    const area = this.#area;
    const stays = area && area.scale === camera.scale && area.ratio === ratio &&
      Math.abs(camera.x - area.x) * camera.scale <= area.marginX && Math.abs(camera.y - area.y) * camera.scale <= area.marginY &&
      area.width === camera.width && area.height === camera.height;
    if (!stays) this.#render(camera, ratio);
    const { x, y, marginX, marginY } = this.#area;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.#canvas, Math.round(ratio * ((x - camera.x) * camera.scale - marginX)), Math.round(ratio * ((camera.y - y) * camera.scale - marginY)));
  }

  #render(camera, ratio) {
    const marginX = Math.round(camera.width / 4), marginY = Math.round(camera.height / 4);
    this.#area = { x: camera.x, y: camera.y, scale: camera.scale, width: camera.width, height: camera.height, ratio, marginX, marginY };
    const width = camera.width + 2 * marginX, height = camera.height + 2 * marginY;
    this.#canvas.width = Math.round(width * ratio);
    this.#canvas.height = Math.round(height * ratio);
    const c = this.#canvas.getContext('2d');
    c.fillStyle = theme.paper;
    c.fillRect(0, 0, this.#canvas.width, this.#canvas.height);
    const { origin } = this.scene;
    const s = camera.scale * ratio;
    const toMetres = () => c.setTransform(s, 0, 0, -s, ratio * (width / 2 + (origin[0] - camera.x) * camera.scale), ratio * (height / 2 - (origin[1] - camera.y) * camera.scale));
    this.#grid(c, camera, ratio, width, height);
    toMetres();
    const px = 1 / camera.scale;
    this.#roads(c, px);
    this.#holes(c);
    this.#emitters(c, px);
    this.#walls(c, px);
    this.#magnets(c, px);
    this.#lamps(c, px);
  }

  #grid(c, camera, ratio, width, height) {
    const step = camera.roundLength(120);
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.strokeStyle = theme.grid;
    c.lineWidth = 1;
    c.beginPath();
    const left = camera.x - width / 2 / camera.scale, bottom = camera.y - height / 2 / camera.scale;
    for (let k = Math.ceil(left / step); k * step < left + width / camera.scale; ++k) {
      const at = Math.round((k * step - left) * camera.scale) + 0.5;
      c.moveTo(at, 0); c.lineTo(at, height);
    }
    for (let k = Math.ceil(bottom / step); k * step < bottom + height / camera.scale; ++k) {
      const at = Math.round(height - (k * step - bottom) * camera.scale) + 0.5;
      c.moveTo(0, at); c.lineTo(width, at);
    }
    c.stroke();
  }

  /** Paint is often white, so a grey band beneath makes it visible on white. */
  #roads(c, px) {
    c.lineJoin = 'round';
    c.strokeStyle = theme.asphalt;
    for (const { path, width } of this.markings) {
      c.lineWidth = width + Math.max(0.06, 3 * px);
      c.stroke(path);
    }
    for (const { path, width, color } of this.markings) {
      c.strokeStyle = color;
      c.lineWidth = Math.max(width, 1.2 * px);
      c.stroke(path);
    }
  }

  #holes(c) {
    c.fillStyle = fade(theme.hole, 0.85);
    for (const outline of this.scene.holes) {
      const path = new Path2D();
      addLine(path, outline, this.scene.origin, false);
      c.fill(path);
    }
  }

  #emitters(c, px) {
    c.lineWidth = px;
    for (const { kind, pose, range, fov, halo } of this.scene.emitters) {
      const color = kind === 'dock' ? theme.dock : theme.virtualWall;
      const x = pose[0] - this.scene.origin[0], y = pose[1] - this.scene.origin[1];
      const parts = [sectorPath(x, y, pose[2], fov, range)];
      if (halo > 0) parts.push(sectorPath(x, y, 0, 2 * Math.PI, halo));
      for (const path of parts) {
        c.fillStyle = fade(color, 0.12);
        c.strokeStyle = fade(color, 0.6);
        c.fill(path);
        c.stroke(path);
      }
    }
  }

  #walls(c, px) {
    const dashes = { solid: [], passable: [8, 4], overhead: [8, 4], unseen: [1.5, 4] };
    const alpha = { solid: 0.75, passable: 0.3, overhead: 0.15, unseen: 0 };
    for (const { kind, color: own, closed, path } of this.#groups) {
      const color = own || theme.wall;
      if (closed && alpha[kind] > 0) {
        c.fillStyle = fade(color, alpha[kind]);
        c.fill(path);
      }
      c.strokeStyle = kind === 'unseen' ? theme.unseen : edgeOf(color, 0.4);
      c.lineWidth = 1.4 * px;
      c.setLineDash(dashes[kind].map((length) => length * px));
      c.stroke(path);
    }
    c.setLineDash([]);
  }

  #lamps(c, px) {
    c.fillStyle = theme.lightYellow;
    c.strokeStyle = theme.wall;
    c.lineWidth = px;
    for (const [x, y] of this.scene.lamps) {
      c.beginPath();
      c.arc(x - this.scene.origin[0], y - this.scene.origin[1], 4 * px, 0, 2 * Math.PI);
      c.fill();
      c.stroke();
    }
  }

  #magnets(c, px) {
    const radius = Math.max(0.02, Math.min(3, Math.max(1.2, 0.04 / px)) * px);  // rows stay separate from a distance
    for (const [x, y, moment] of this.scene.magnets) {
      c.fillStyle = moment > 0 ? theme.magnetUp : theme.magnetDown;
      c.beginPath();
      // North up: a disc; south up: a square.
      if (moment > 0) c.arc(x - this.scene.origin[0], y - this.scene.origin[1], radius, 0, 2 * Math.PI);
      else c.rect(x - this.scene.origin[0] - radius, y - this.scene.origin[1] - radius, 2 * radius, 2 * radius);
      c.fill();
    }
  }
}
