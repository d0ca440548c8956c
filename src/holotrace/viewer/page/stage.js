// The camera's view: zoom, divider, pointer, and the numbers in its pixels.

import * as api from './api.js';
import { heldPlace } from './live.js';
import { change, clamp, onChange, query, session, state } from './state.js';

const $ = id => document.getElementById(id);
const frame = $('frame'), sheet = $('sheet'), view = $('picture'), draft = $('draft'), render = $('render'), numbers = $('numbers');

let scale = 0, left = 0, top = 0;    // of the sheet; scale 0: the whole view
let pitch = 0;                       // of a pixel of the view [mm]
let points = new Float32Array(0);    // of the scene: x, y, z [m], brightness
let lookingAt = '';                  // query of the shown still

function fitScale() { return Math.min(frame.clientWidth / view.width, frame.clientHeight / view.height); }
function shownScale() { return scale > 0 ? scale : fitScale(); }

export function layOut() {
  const s = shownScale(), width = view.width * s, height = view.height * s;
  if (scale === 0) {
    left = (frame.clientWidth - width) / 2;
    top = (frame.clientHeight - height) / 2;
  } else {
    left = width < frame.clientWidth ? (frame.clientWidth - width) / 2 : clamp(left, frame.clientWidth - width, 0);
    top = height < frame.clientHeight ? (frame.clientHeight - height) / 2 : clamp(top, frame.clientHeight - height, 0);
  }
  sheet.style.transform = `translate(${left}px, ${top}px) scale(${s})`;
  sheet.classList.toggle('large', s >= 2);
  $('zoom-text').textContent = `${Math.round(s * 100)} %`;
  $('zoom-fit').setAttribute('aria-pressed', String(scale === 0));
  const split = Number($('split').value) / 100;
  const isSplit = !render.hidden;
  render.style.clipPath = `inset(0 0 0 ${split * 100}%)`;
  $('divider').hidden = $('view-tag').hidden = $('render-tag').hidden = !isSplit || split >= 1;
  $('divider').style.left = `${left + split * width - 1}px`;
  drawNumbers();
}

function zoomBy(factor, x = frame.clientWidth / 2, y = frame.clientHeight / 2) {
  const before = shownScale(), after = clamp(before * factor, fitScale(), 96);
  left = x - ((x - left) * after) / before;
  top = y - ((y - top) * after) / before;
  scale = after <= fitScale() * 1.001 ? 0 : after;
  layOut();
}

function pixelAt(event) {
  const box = frame.getBoundingClientRect(), s = shownScale();
  return [Math.floor((event.clientX - box.left - left) / s), Math.floor((event.clientY - box.top - top) / s)];
}

const isInside = ([x, y]) => x >= 0 && y >= 0 && x < view.width && y < view.height;

// The place of a pixel in the plane in focus [mm].
function placeOf([x, y]) {
  return [(x - (view.width - 1) / 2) * pitch, ((view.height - 1) / 2 - y) * pitch];
}

// How much longer a way at the depth z [mm] is than the same way in the plane in focus, seen from the eye or the panel's middle.
function depthRatio(z) {
  const eye = state.pupil > 0 ? state.eye[2] : 0;
  const plane = session.items[0]?.image === 'real' ? state.distance : -state.distance;
  const ratio = Math.abs((eye - z) / (eye - plane));
  return Number.isFinite(ratio) && ratio > 0 ? ratio : 1;
}

// The depth [mm] of the scene's point nearest to the ray from the eye through that place; the nearer one of neighbours.
function depthAt([x, y]) {
  const sign = session.items[0]?.image === 'real' ? 1 : -1;
  const eye = state.pupil > 0 && sign < 0 ? state.eye : [0, 0, 0], plane = -state.distance;
  let best = null, least = Infinity;
  const reach = 14 * pitch;  // [mm] in the plane in focus
  for (let i = 0; i < points.length; i += 4) {
    const z = points[i + 2] * 1e3, t = (eye[2] - plane) / (eye[2] - z);
    if (eye[2] > 0 && t < 0) continue;  // behind the eye
    const dx = eye[0] + (points[i] * 1e3 - eye[0]) * t - x, dy = eye[1] + (points[i + 1] * 1e3 - eye[1]) * t - y;
    const away = Math.hypot(dx, dy);
    if (away > reach) continue;
    const beyond = t < 0 ? 1e6 : 0;  // without an eye: on the other side of the panel, where nothing is nearly sharp
    const rank = away / reach + (-z / (Math.abs(state.distance) || 1)) * 2 + beyond;
    if (rank < least) { least = rank; best = -z; }
  }
  return best;
}

/** Focuses on the scene at a pixel. @return whether there is a point */
export function focusAt(pixel) {
  const depth = depthAt(placeOf(pixel));
  if (depth === null) return false;
  change({ distance: Number(depth.toFixed(2)) });
  return true;
}

const pixelValues = { x: 0, y: 0, columns: 0, rows: 0, channels: 1, lines: null, query: '' };

async function fetchNumbers() {
  const s = shownScale();
  if (s < 40 || !lookingAt) return;
  const x = clamp(Math.floor(-left / s), 0, view.width - 1), y = clamp(Math.floor(-top / s), 0, view.height - 1);
  const columns = Math.min(view.width - x, Math.ceil(frame.clientWidth / s) + 1, 64);
  const rows = Math.min(view.height - y, Math.ceil(frame.clientHeight / s) + 1, 64);
  const asked = lookingAt;
  if (pixelValues.lines && pixelValues.query === asked && pixelValues.x === x && pixelValues.y === y) return;
  const got = await api.json(`values?${asked}&column=${x}&row=${y}&columns=${columns}&rows=${rows}`).catch(() => null);
  if (!got || asked !== lookingAt) return;
  Object.assign(pixelValues, { x, y, columns, rows, channels: got.channels, lines: got.rows, query: asked, white: got.white });
  drawNumbers();
}

let numbersTimer = 0;
function drawNumbers() {
  const s = shownScale(), ratio = devicePixelRatio;
  numbers.width = frame.clientWidth * ratio;
  numbers.height = frame.clientHeight * ratio;
  if (s < 40) return;
  clearTimeout(numbersTimer);
  numbersTimer = setTimeout(fetchNumbers, 150);
  if (!pixelValues.lines || pixelValues.query !== lookingAt) return;
  const paint = numbers.getContext('2d');
  paint.scale(ratio, ratio);
  paint.font = `${Math.min(13, s / 5)}px system-ui, sans-serif`;
  paint.textAlign = 'center';
  paint.textBaseline = 'middle';
  if (!render.hidden) {  // they are those of the view, not of the render over it
    paint.beginPath();
    paint.rect(0, 0, left + (Number($('split').value) / 100) * view.width * s, frame.clientHeight);
    paint.clip();
  }
  const { x, y, columns, rows, channels, lines, white } = pixelValues;
  for (let j = 0; j < rows; ++j)
    for (let i = 0; i < columns; ++i) {
      const values = lines[j].slice(i * channels, (i + 1) * channels);
      const mean = values.reduce((a, b) => a + b, 0) / channels;
      paint.fillStyle = mean > 0.2 * white ? '#000' : '#fff';
      values.forEach((value, c) => paint.fillText(value.toPrecision(3), left + (x + i + 0.5) * s,
        top + (y + j + 0.5 + (c - (channels - 1) / 2) * 0.24) * s));
    }
}

let readTimer = 0;
function readOut(event) {
  const pixel = pixelAt(event);
  clearTimeout(readTimer);
  if (!isInside(pixel) || !lookingAt) { $('readout').textContent = ''; return; }
  const [x, y] = placeOf(pixel);
  const place = `x ${x.toFixed(2)} mm, y ${y.toFixed(2)} mm`;
  $('readout').textContent = place;
  const asked = lookingAt;
  readTimer = setTimeout(async () => {
    const got = await api.json(`values?${asked}&column=${pixel[0]}&row=${pixel[1]}&columns=1&rows=1`).catch(() => null);
    if (got && asked === lookingAt && !press)
      $('readout').textContent = `${place}: ${got.rows[0].map(v => v.toPrecision(3)).join(', ')} W/m²`;
  }, 250);
}

/** Whether pixels are so small on the screen that every second one shows as much. */
export function isSmall() { return shownScale() * devicePixelRatio < 0.75; }

/** Shows a picture of the server. @param still the query of a still view; '' for a draft */
export function show(picture, still) {
  const { step } = picture, columns = picture.columns * step, rows = picture.rows * step;
  const isNewSize = Math.abs(view.width - columns) >= step || Math.abs(view.height - rows) >= step;
  draft.hidden = step === 1;
  if (step > 1) {  // a coarse draft lies over the view
    if (isNewSize) Object.assign(view, { width: columns, height: rows });
    api.draw(draft, picture);
    Object.assign(draft.style, { width: `${view.width}px`, height: `${view.height}px` });
  } else {
    api.draw(view, picture);
  }
  pitch = (picture.pitch_m * 1e3) / step;
  view.dataset.still = still;
  lookingAt = still;
  if (isNewSize) layOut(); else if (still) drawNumbers();
}

/** Shows the render beside the view; null hides it. */
export function showRender(picture) {
  const has = picture !== null;
  if (has) api.draw(render, picture);
  if (render.hidden === has || has) { render.hidden = !has; $('split-label').hidden = !has; layOut(); }
}

export function setPoints(floats) { points = floats; }

const pointers = new Map();
let press = null;  // the pointer that went down: {x, y, left, top, eye, isMoved}
let pinch = 0;

frame.addEventListener('wheel', event => {
  event.preventDefault();
  const box = frame.getBoundingClientRect();
  if (event.ctrlKey || event.shiftKey) {
    zoomBy(Math.exp(-(event.deltaY || event.deltaX) * 0.003), event.clientX - box.left, event.clientY - box.top);
    return;
  }
  const range = $('distance'), step = (Number(range.max) - Number(range.min)) / 200;
  const turns = clamp(event.deltaY / 100, -3, 3);
  change({ distance: clamp(Number((state.distance - turns * step).toFixed(3)), -1e5, 1e5) });
}, { passive: false });

frame.addEventListener('pointerdown', event => {
  frame.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, event);
  press = { x: event.clientX, y: event.clientY, left, top, eye: [...state.eye], held: heldPlace(), isMoved: pointers.size > 1 };
  pinch = 0;
});

frame.addEventListener('pointermove', event => {
  if (pointers.has(event.pointerId)) pointers.set(event.pointerId, event);
  if (!press) { readOut(event); return; }
  if (pointers.size === 2) {  // two fingers
    const [a, b] = [...pointers.values()], box = frame.getBoundingClientRect();
    const apart = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
    if (pinch > 0) zoomBy(apart / pinch, (a.clientX + b.clientX) / 2 - box.left, (a.clientY + b.clientY) / 2 - box.top);
    pinch = apart;
    return;
  }
  const dx = event.clientX - press.x, dy = event.clientY - press.y;
  if (Math.hypot(dx, dy) > 4) press.isMoved = true;
  if (!press.isMoved) return;
  if (press.held && !event.shiftKey) {
    const [x, y, z] = press.held.at, step = (pitch / shownScale()) * depthRatio(z);
    press.held.move([x + dx * step, y - dy * step, z]);
  } else if (state.pupil > 0 && (!event.shiftKey || press.held)) {
    const step = 20 / frame.clientWidth;  // the width of the view is 20 mm of the eye's way
    change({ eye: [press.eye[0] + dx * step, press.eye[1] - dy * step, press.eye[2]].map(v => Number(v.toFixed(2))) });
  } else if (scale > 0) {
    left = press.left + dx;
    top = press.top + dy;
    layOut();
  } else if (state.pupil === 0) {
    clearTimeout(readTimer);
    $('readout').textContent = 'A pupil of 0 takes all light, so there is no eye to move: press Eye, or set a pupil.';
  }
});

function release(event) {
  pointers.delete(event.pointerId);
  if (press && !press.isMoved && event.type === 'pointerup' && pointers.size === 0) {
    const pixel = pixelAt(event);
    if (isInside(pixel) && !focusAt(pixel) && points.length === 0)
      $('readout').textContent = 'the depth is not known here: no sources.ply and no points.ply beside the holograms';
  }
  if (pointers.size === 0) press = null;
}
frame.addEventListener('pointerup', release);
frame.addEventListener('pointercancel', release);
frame.addEventListener('pointerleave', () => { clearTimeout(readTimer); $('readout').textContent = ''; });

frame.addEventListener('keydown', event => {
  const range = $('distance'), step = (Number(range.max) - Number(range.min)) / 100;
  const move = dx => change({ eye: [Number((state.eye[0] + dx).toFixed(2)), state.eye[1], state.eye[2]] });
  const keys = {
    ArrowUp: () => change({ distance: Number((state.distance + step).toFixed(3)) }),
    ArrowDown: () => change({ distance: Number((state.distance - step).toFixed(3)) }),
    ArrowLeft: () => move(-0.25), ArrowRight: () => move(0.25),
    '+': () => zoomBy(1.25), '-': () => zoomBy(0.8), 0: () => { scale = 0; layOut(); },
    Enter: () => focusAt([view.width >> 1, view.height >> 1]),
  };
  if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  keys[event.key]();
});

$('zoom-in').addEventListener('click', () => zoomBy(1.5));
$('zoom-out').addEventListener('click', () => zoomBy(1 / 1.5));
$('zoom-fit').addEventListener('click', () => { scale = 0; layOut(); });
$('split').addEventListener('input', layOut);
new ResizeObserver(layOut).observe(frame);
onChange(() => { lookingAt = ''; });
