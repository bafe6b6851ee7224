// Balls as the files of each format, and zip archives.

import { crc32, deflateRawSync } from "node:zlib";

/** The triangles of a ball, each of three points. */
function trianglesOf({ radius, triangles }) {
  const rings = Math.max(3, Math.round(Math.sqrt(triangles) / 2));
  const point = (ring, turn) => {
    const [up, about] = [(Math.PI * ring) / rings, (Math.PI * turn) / rings];
    return [radius * Math.sin(up) * Math.cos(about), radius * Math.sin(up) * Math.sin(about), radius * Math.cos(up)];
  };
  const found = [];
  for (let ring = 0; ring < rings; ring += 1) {
    for (let turn = 0; turn < 2 * rings; turn += 1) {
      const [a, b, c, d] = [point(ring, turn), point(ring + 1, turn), point(ring + 1, turn + 1), point(ring, turn + 1)];
      found.push([a, b, c], [a, c, d]);
    }
  }
  return found;
}

/** The file of a ball, a buffer or a text. */
export function ball(format, size) {
  const triangles = trianglesOf(size);
  return { stl, obj, dae, glb }[format](triangles);
}

function stl(triangles) {
  const file = Buffer.alloc(84 + 50 * triangles.length);
  file.writeUInt32LE(triangles.length, 80);
  triangles.forEach((points, k) => [0, 0, 0, ...points.flat()].forEach((value, at) => file.writeFloatLE(value, 84 + 50 * k + 4 * at)));
  return file;
}

function obj(triangles) {
  const points = triangles.flat().map((point) => `v ${point.join(" ")}`);
  return [...points, ...triangles.map((_, k) => `f ${3 * k + 1} ${3 * k + 2} ${3 * k + 3}`)].join("\n");
}

function dae(triangles) {
  const values = triangles.flat(2);
  const source = `<source id="p"><float_array id="a" count="${values.length}">${values.join(" ")}</float_array><technique_common>
    <accessor source="#a" count="${values.length / 3}" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>`;
  const corners = Array.from({ length: values.length / 3 }, (_, k) => k).join(" ");
  return `<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit meter="1"/><up_axis>Z_UP</up_axis></asset>
    <library_geometries><geometry id="g"><mesh>${source}<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
    <triangles count="${triangles.length}"><input semantic="VERTEX" source="#v" offset="0"/><p>${corners}</p></triangles></mesh></geometry></library_geometries>
    <library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
    <scene><instance_visual_scene url="#s"/></scene></COLLADA>`;
}

function glb(triangles) {
  const points = Buffer.from(new Float32Array(triangles.flat(2)).buffer);
  const json = JSON.stringify({
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, material: 0 }] }],
    // A picture that is not there: surfaces are drawn without.
    materials: [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }],
    textures: [{ source: 0 }],
    images: [{ uri: "missing.png" }],
    accessors: [{ bufferView: 0, componentType: 5126, count: points.length / 12, type: "VEC3", ...endsOf(triangles.flat()) }],
    bufferViews: [{ buffer: 0, byteLength: points.length }],
    buffers: [{ byteLength: points.length }],
  });
  const text = Buffer.from(json.padEnd(4 * Math.ceil(json.length / 4)));
  const words = (...values) => Buffer.from(new Uint32Array(values).buffer);
  const length = 12 + 8 + text.length + 8 + points.length;
  return Buffer.concat([words(0x46546c67, 2, length, text.length, 0x4e4f534a), text, words(points.length, 0x004e4942), points]);
}

/** The least and the largest coordinates of points. */
function endsOf(points) {
  const each = (least) => [0, 1, 2].map((axis) => points.reduce((best, point) => least(best, point[axis]), points[0][axis]));
  return { min: each(Math.min), max: each(Math.max) };
}

/** A zip archive of files by their paths; every second one is packed. */
export function zipOf(files) {
  const [bodies, entries] = [[], []];
  let start = 0;
  for (const [k, [path, content]] of Object.entries(files).entries()) {
    const [name, whole] = [Buffer.from(path), Buffer.from(content)];
    const method = k % 2 === 0 ? 0 : 8;
    const packed = method === 0 ? whole : deflateRawSync(whole);
    const about = Buffer.alloc(26);
    about.writeUInt16LE(20, 0);
    about.writeUInt16LE(method, 4);
    about.writeUInt32LE(crc32(whole), 10);
    about.writeUInt32LE(packed.length, 14);
    about.writeUInt32LE(whole.length, 18);
    about.writeUInt16LE(name.length, 22);
    const place = Buffer.alloc(14);
    place.writeUInt32LE(start, 10);
    bodies.push(Buffer.from("PK\x03\x04"), about, name, packed);
    entries.push(Buffer.from("PK\x01\x02\x14\0"), about, place, name);
    start += 30 + name.length + packed.length;
  }
  const [body, list] = [Buffer.concat(bodies), Buffer.concat(entries)];
  const end = Buffer.alloc(22);
  end.write("PK\x05\x06");
  [Object.keys(files).length, Object.keys(files).length].forEach((count, k) => end.writeUInt16LE(count, 8 + 2 * k));
  end.writeUInt32LE(list.length, 12);
  end.writeUInt32LE(body.length, 16);
  return Buffer.concat([body, list, end]);
}
