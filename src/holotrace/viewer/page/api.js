// What the page asks the server. All addresses are relative: they keep the token in the page's own address.

/** Thrown with the server's sentence. */
export class Refused extends Error {}

async function answer(path, options) {
  let response;
  try {
    response = await fetch(path, options);
  } catch {
    throw new Refused('The server does not answer. Start holotrace view again and open its new address.');
  }
  if (response.ok) return response;
  const text = await response.text();
  let sentence = text.trim();
  try { sentence = JSON.parse(text).error; } catch { /* a plain text */ }
  throw new Refused(sentence || `The server answered ${response.status}.`);
}

export async function json(path) { return (await answer(path)).json(); }
export async function bytes(path) { return (await answer(path)).arrayBuffer(); }

/** A picture: {columns, rows, channels, …, values: Uint8Array}; null if it was dropped as outdated. */
export async function picture(path) {
  const response = await answer(path);
  if (response.status === 204) return null;
  const buffer = await response.arrayBuffer();
  const length = new DataView(buffer).getUint32(0, true);
  const facts = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  facts.values = new Uint8Array(buffer, 4 + length);
  return facts;
}

/** The picture as opaque pixels of a canvas. */
export function image(picture) {
  const { columns, rows, channels, values } = picture;
  const data = new ImageData(columns, rows);
  const out = new Uint32Array(data.data.buffer);
  if (channels === 1)
    for (let i = 0; i < out.length; ++i) out[i] = 0xff000000 | (values[i] * 0x10101);
  else
    for (let i = 0, j = 0; i < out.length; ++i, j += 3)
      out[i] = 0xff000000 | (values[j + 2] << 16) | (values[j + 1] << 8) | values[j];
  return data;
}

export function draw(canvas, picture) {
  if (canvas.width !== picture.columns || canvas.height !== picture.rows) {
    canvas.width = picture.columns;
    canvas.height = picture.rows;
  }
  canvas.getContext('2d').putImageData(image(picture), 0, 0);
}
