// An invented gallery for the page's test: 12 fixtures, 36 points, 6 meters, and the picture of its plan. The light
// need not be right: the page must only show what the daemon said.
import { deflateSync } from 'node:zlib';

const ROOM = { wide_m: 14, deep_m: 9, high_m: 4.2 };
const round = (value, digits = 3) => Number(value.toFixed(digits));

const works = [
  { name: 'drawing-1', x: 2.2, y: 8.95, normal: [0, -1, 0], goal: 45, limit: 50, rows: 4 },
  { name: 'drawing-2', x: 5.2, y: 8.95, normal: [0, -1, 0], goal: 45, limit: 50, rows: 4 },
  { name: 'watercolour', x: 8.4, y: 8.95, normal: [0, -1, 0], goal: 45, limit: 50, rows: 4 },
  { name: 'textile', x: 11.6, y: 8.95, normal: [0, -1, 0], goal: 48, limit: 50, rows: 4 },
  { name: 'portrait', x: 0.05, y: 4.6, normal: [1, 0, 0], goal: 180, rows: 4 },
  { name: 'landscape', x: 13.95, y: 5.0, normal: [-1, 0, 0], goal: 200, rows: 4 },
];
const pedestals = [
  { name: 'bronze', x: 3.6, y: 4.4, goal: 300 },
  { name: 'bust', x: 7.0, y: 4.7, goal: 250 },
  { name: 'vase', x: 10.4, y: 4.2, goal: 220 },
];
const floors = [
  { name: 'entrance', x: 6.6, y: 1.0, goal: 100 },
  { name: 'bench', x: 10.8, y: 1.7, goal: 120 },
  { name: 'passage', x: 2.6, y: 1.6, goal: 100 },
];

function points() {
  const made = [];
  for (const work of works)
    for (let row = 0; row < work.rows; ++row)
      made.push({ name: `${work.name}-${row + 1}`, position: [work.x, work.y, round(1.05 + 0.3 * row)], normal: work.normal,
        goal: work.goal, limit: work.limit });
  for (const p of pedestals) {
    made.push({ name: `${p.name}-top`, position: [p.x, p.y, 1.6], normal: [0, 0, 1], goal: p.goal });
    made.push({ name: `${p.name}-left`, position: [p.x - 0.3, p.y, 1.4], normal: [-1, 0, 0], goal: p.goal * 0.7 });
    made.push({ name: `${p.name}-right`, position: [p.x + 0.3, p.y, 1.4], normal: [1, 0, 0], goal: p.goal * 0.7 });
  }
  for (const f of floors) made.push({ name: f.name, position: [f.x, f.y, 0], normal: [0, 0, 1], goal: f.goal });
  return made;
}

export const POINTS = points();
export const METERED = ['drawing-1-2', 'watercolour-3', 'textile-2', 'portrait-2', 'landscape-3', 'bronze-top'];
const targets = [...works, ...pedestals, ...floors];
export const FIXTURES = targets.map((target, i) => {
  const upright = target.normal !== undefined;
  const [nx, ny] = target.normal ?? [0.4, target.y > 3 ? -0.8 : 0.8];
  return {
    name: `spot-${i + 1}`,
    bus: i < 8 ? 'dmx' : 'dimmer',
    address: i < 8 ? `1.${2 * i + 1}-${2 * i + 2}` : `unit 10 register ${i - 8}`,
    position: [round(target.x + nx * 2.0), round(target.y + ny * 2.0), 3.6],
    aim: [target.x, target.y, upright ? 1.5 : target.rows ? 1.5 : 1.2],
    level: round(0.28 + 0.055 * ((i * 5) % 12)),
    gain: round(0.82 + 0.02 * ((i * 7) % 11)),
  };
});

export const room = (name) => ({
  name,
  bounds: { min: [0, 0, 0], max: [ROOM.wide_m, ROOM.deep_m, ROOM.high_m] },
  plan: { url: '/api/room.png', min: [-0.2, -0.2], max: [ROOM.wide_m + 0.2, ROOM.deep_m + 0.2] },
});

/** The plan as PNG: floor boards, walls, pedestals, and the pools of light. */
export function roomPng() {
  const scale = 50;
  const width = Math.round((ROOM.wide_m + 0.4) * scale);
  const height = Math.round((ROOM.deep_m + 0.4) * scale);
  const rows = Buffer.alloc(height * (1 + width * 3));
  for (let j = 0; j < height; ++j)
    for (let i = 0; i < width; ++i) {
      const x = (i + 0.5) / scale - 0.2;
      const y = ROOM.deep_m + 0.2 - (j + 0.5) / scale;
      let color = [236, 232, 224];
      if (x > 0 && x < ROOM.wide_m && y > 0 && y < ROOM.deep_m) {
        let light = 0.35;
        for (const f of FIXTURES) {
          const d2 = (x - f.aim[0]) ** 2 + (y - f.aim[1]) ** 2;
          light += 0.5 * f.level * Math.exp(-d2 / 0.9);
        }
        const board = ((Math.floor(y / 0.16) * 7919) % 13) / 130;
        const shade = Math.min(1, light) * (0.86 + board);
        color = [168 * shade, 134 * shade, 100 * shade];
        for (const p of pedestals)
          if (Math.abs(x - p.x) < 0.28 && Math.abs(y - p.y) < 0.28) color = [225, 222, 215];
        if (x > 9.8 && x < 11.8 && y > 1.3 && y < 1.75) color = [84, 66, 52];
      } else if (x > 5.9 && x < 7.3 && y < 0.5) color = [150, 122, 92];
      for (let c = 0; c < 3; ++c) rows[j * (1 + width * 3) + 1 + i * 3 + c] = Math.round(color[c]);
    }
  return png(width, height, rows);
}

/** 8-bit RGB, each row led by its filter byte 0 (ISO/IEC 15948). */
function png(width, height, rows) {
  const table = Array.from({ length: 256 }, (_, n) => {
    for (let k = 0; k < 8; ++k) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
    return n >>> 0;
  });
  const crc = (bytes) => {
    let c = 0xffffffff;
    for (const b of bytes) c = table[(c ^ b) & 0xff] ^ (c >>> 8);
    return (c ^ 0xffffffff) >>> 0;
  };
  const chunk = (type, data) => {
    const body = Buffer.concat([Buffer.from(type, 'latin1'), data]);
    const out = Buffer.alloc(8 + data.length + 4);
    out.writeUInt32BE(data.length, 0);
    body.copy(out, 4);
    out.writeUInt32BE(crc(body), 8 + data.length);
    return out;
  };
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width, 0);
  head.writeUInt32BE(height, 4);
  head.set([8, 2, 0, 0, 0], 8);
  return Buffer.concat([
    Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]),
    chunk('IHDR', head),
    chunk('IDAT', deflateSync(rows)),
    chunk('IEND', Buffer.alloc(0)),
  ]);
}
