// What a PNG shows (ISO/IEC 15948; 8-bit RGB or RGBA without interlace, as browsers write screenshots).
import { inflateSync } from 'node:zlib';

export function pixelsOf(png) {
  const width = png.readUInt32BE(16);
  const height = png.readUInt32BE(20);
  const channels = { 2: 3, 6: 4 }[png[25]];
  if (png[24] !== 8 || !channels || png[28] !== 0) throw new Error('a PNG of another kind');
  const parts = [];
  for (let at = 8; at < png.length; at += 12 + png.readUInt32BE(at))
    if (png.toString('latin1', at + 4, at + 8) === 'IDAT') parts.push(png.subarray(at + 8, at + 8 + png.readUInt32BE(at)));
  const raw = inflateSync(Buffer.concat(parts));
  const row = width * channels;
  const out = Buffer.alloc(row * height);
  for (let y = 0; y < height; ++y) {
    const filter = raw[y * (row + 1)];
    for (let i = 0; i < row; ++i) {
      const left = i >= channels ? out[y * row + i - channels] : 0;
      const up = y ? out[(y - 1) * row + i] : 0;
      const corner = y && i >= channels ? out[(y - 1) * row + i - channels] : 0;
      const [a, b, c] = [left, up, corner].map((v) => Math.abs(left + up - corner - v));
      const paeth = a <= b && a <= c ? left : b <= c ? up : corner;
      out[y * row + i] = raw[y * (row + 1) + 1 + i] + [0, left, up, (left + up) >> 1, paeth][filter];
    }
  }
  return { width, height, at: (x, y) => [...out.subarray((y * width + x) * channels, (y * width + x) * channels + 3)] };
}

/** Of every third pixel: how many colours (to 3 bits a channel), and the share of the commonest. */
export function variety(png) {
  const { width, height, at } = pixelsOf(png);
  const counts = new Map();
  let all = 0;
  for (let y = 0; y < height; y += 3)
    for (let x = 0; x < width; x += 3, ++all) {
      const key = at(x, y).map((v) => v >> 5).join();
      counts.set(key, (counts.get(key) ?? 0) + 1);
    }
  return { colours: counts.size, commonest: Math.max(...counts.values()) / all };
}

/** The share of pixels that differ by more than a little. */
export function changed(before, after) {
  const [a, b] = [pixelsOf(before), pixelsOf(after)];
  if (a.width !== b.width || a.height !== b.height) return 1;
  let different = 0;
  for (let y = 0; y < a.height; y += 2)
    for (let x = 0; x < a.width; x += 2) {
      const q = b.at(x, y);
      if (a.at(x, y).some((v, i) => Math.abs(v - q[i]) > 12)) ++different;
    }
  return (4 * different) / (a.width * a.height);
}
