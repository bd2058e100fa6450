// Poses in six degrees of freedom, as in base/rigid_transform.h: {R, p} with R_AB row by row and the origin of B in A [m].

export const level = { roll: 0, pitch: 0 };

/** Rz(yaw) Ry(pitch) Rx(roll), then the translation. */
export function transformOf([x, y, yaw, z = 0], { roll, pitch } = level) {
  const sr = Math.sin(roll), cr = Math.cos(roll), sp = Math.sin(pitch), cp = Math.cos(pitch), sy = Math.sin(yaw), cy = Math.cos(yaw);
  return { R: [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, -sp, cp * sr, cp * cr], p: [x, y, z] };
}

/** Returns the axes of B in A. @param q unit quaternion [x, y, z, w] of R_AB */
export function axesOf([x, y, z, w]) {
  return [[1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)], [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)], [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)]];
}
/** Returns the pose with these axes and the origin p. */
export const poseOf = ([x, y, z], p) => ({ R: [0, 1, 2].flatMap((k) => [x[k], y[k], z[k]]), p });

export function transform({ R, p }, [x, y, z]) {
  return [R[0] * x + R[1] * y + R[2] * z + p[0], R[3] * x + R[4] * y + R[5] * z + p[1], R[6] * x + R[7] * y + R[8] * z + p[2]];
}

/** Returns X_AC from X_AB and X_BC. */
export function composed(A, B) {
  const R = [];
  for (let i = 0; i < 9; i += 3) for (let j = 0; j < 3; ++j) R.push(A.R[i] * B.R[j] + A.R[i + 1] * B.R[3 + j] + A.R[i + 2] * B.R[6 + j]);
  return { R, p: transform(A, B.p) };
}

/** Returns X_BA from X_AB. */
export function inverse({ R, p: [x, y, z] }) {
  const back = [R[0], R[3], R[6], R[1], R[4], R[7], R[2], R[5], R[8]];
  return { R: back, p: transform({ R: back, p: [0, 0, 0] }, [-x, -y, -z]) };
}
